"""The three lines that hold it to its name; they fail, and say what it is."""

from springs import velocity_verlet

from driftproof import assert_verified


def test_the_step_is_velocity_verlet():
    """To roundoff."""
    assert_verified(velocity_verlet, method="velocity_verlet")
