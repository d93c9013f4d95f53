"""highway-env: one step of its bicycle model, straight ahead."""

from __future__ import annotations

from examples.gallery.entry import targets


def vehicle(force, q, v, h):
    """A car whose heading and steering are 0, its acceleration read before the step."""
    from highway_env.vehicle.kinematics import Vehicle

    car = Vehicle(None, [q, 0.0], speed=v)
    car.act({"acceleration": force(q), "steering": 0.0})
    car.step(h)
    return float(car.position[0]), float(car.speed)


TARGETS = targets(__name__, "highway-env", "force", {"vehicle": ("(nothing)", None)})
