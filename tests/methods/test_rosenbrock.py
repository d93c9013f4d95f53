"""Rosenbrock methods as data: what is refused, and files of your own."""

from fractions import Fraction as Q

import pytest

from driftproof import facts, read_method
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.methods.schemes import MethodError
from tests.looping import exactly

ROS2 = """family = "rosenbrock"
alpha = [[0, 0], [1, 0]]
gamma = [["1 - r/2", 0], ["r - 2", "1 - r/2"]]
b = ["1/2", "1/2"]
b_embedded = [1, 0]
embedded_order = 1
[roots]
r = "sqrt(2)"
"""


def test_a_file_is_read_and_refused_in_one_line(write, refusal):
    mine, known = read_method(write(ROS2)), FURTHER_METHODS["ros2"]
    assert isinstance(mine, Rosenbrock)
    assert (mine.alpha, mine.gamma, mine.b, mine.b_embedded) == (known.alpha, known.gamma, known.b, known.b_embedded)
    assert (known.linear_twin().key, known.linear_twin().title) == (known.key, known.title)
    gamma = mine.gamma[0][0]
    assert known.linear_twin().a == ((gamma, 0), (1 - 2 * gamma, gamma))
    assert facts(mine, only=["order", "w_order", "l_stable"]).data == {"order": 2, "w_order": 2, "l_stable": True}
    for old, new, words in exactly(4, [
        ("[1, 0]]", "[1, 1]]", "alpha has a nonzero entry on or above"),
        ('r/2", 0]', 'r/2", 1]', "gamma has a nonzero entry above its"), ("alpha", "A", "a rosenbrock has no key 'A'"),
        ('["r - 2", "1 - r/2"]', "[0]", "gamma is not square"),
    ]):  # fmt: skip
        assert words in refusal(ROS2.replace(old, new))


def test_half_of_a_pair_and_other_lengths_are_refused_and_residuals_are_named():
    with pytest.raises(MethodError, match="b_embedded and embedded_order must be given together"):
        Rosenbrock("m", "m", 1, "", ((0,),), ((1,),), (1,), embedded_order=1)
    with pytest.raises(MethodError, match="gamma has 1 entries, b has 2"):
        Rosenbrock("m", "m", 1, "", ((0, 0), (0, 0)), ((1,),), (1, 0))
    assert Rosenbrock("m", "m", 1, "", ((0,),), ((1,),), (Q(2),)).inconsistencies() == {"sum(b) - 1": 1}
