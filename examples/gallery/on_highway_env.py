"""highway-env: one step of its bicycle model, straight ahead, its acceleration read before the step."""

from __future__ import annotations

from driftproof.blackbox.stepper.states.objects import stepper_of
from examples.gallery.entry import targets


def _car():
    from highway_env.vehicle.kinematics import Vehicle

    return Vehicle(None, [0.0, 0.0])


vehicle = stepper_of(
    _car, velocity="speed", push=lambda car, a: car.act({"acceleration": a, "steering": 0.0}), anew=True
)

TARGETS = targets(__name__, "highway-env", force={"vehicle": ("(nothing)", None)})
