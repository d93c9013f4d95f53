"""A class with a method for a run is one function of all that it takes; one with tolerances is a whole solver."""

from driftproof.blackbox.stepper.class_runs import class_run_wrapper, run_of_class
from tests.blackbox.stepper.styles import namespace

CLASSES = """
class Adaptive:
    def __init__(self, f, t0, y0, tf, rtol=1e-6):
        self.f, self.t, self.y, self.tf = f, t0, y0, tf
    def step(self):
        pass
    def solve(self):
        return [self.t, self.tf], [self.y, self.y]

class Ball:
    def __init__(self, x):
        self.x, self.vx = x, 0.0
    def update(self, dt):
        self.x += self.vx * dt
"""


def test_a_solver_with_tolerances_is_run_whole_and_an_object_without_a_run_is_not():
    names = namespace(CLASSES)
    whole = "identify_solver(Adaptive), on the command line --solver, for a whole solver"
    assert class_run_wrapper(names["Adaptive"]) == whole
    assert run_of_class(names["Adaptive"])(abs, 0.0, 1.0, tf=2.0, rtol=1e-3) == ([0.0, 2.0], [1.0, 1.0])
    assert run_of_class(names["Ball"]) is None
    assert class_run_wrapper(names["Ball"]) == ""
