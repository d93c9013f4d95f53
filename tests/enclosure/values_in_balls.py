"""What a right-hand side is in balls at one place, for tests of the functions that it may call."""

from flint import arb

from driftproof.enclosure.arithmetic.evaluations import Evaluation
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.fields.fields import enclosable, enclosed_rates

STATE = (0.625, 1.5, -0.25)


def in_balls(f):
    """f(3/4, STATE), each component as a ball."""
    evaluation = Evaluation()
    state = [Enclosed(evaluation, arb(x)) for x in STATE]
    return [arb(x.value) for x in enclosed_rates(enclosable(f), Enclosed(evaluation, arb(0.75)), state)]
