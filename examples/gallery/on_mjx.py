"""MuJoCo MJX: one step of each of its integrators on a mass on a spring of stiffness 1."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.on_mujoco import SLIDER
from examples.gallery.through_jax import jax64


def _spring(integrator):
    compiled = []

    def make():
        jax = jax64()
        import mujoco
        from mujoco import mjx

        model = mjx.put_model(
            mujoco.MjModel.from_xml_string(SLIDER.format(integrator=integrator, stiffness=1.0, damping=0.0))
        )
        start = mjx.make_data(model)

        def step(q, v, h):
            data = start.replace(qpos=start.qpos.at[0].set(q), qvel=start.qvel.at[0].set(v))
            stepped = mjx.step(model.tree_replace({"opt.timestep": h}), data)
            return stepped.qpos[0], stepped.qvel[0]

        return jax.jit(step)

    def step(q, v, h):
        if not compiled:
            compiled.append(make())
        q1, v1 = compiled[0](float(q), float(v), float(h))
        return float(q1), float(v1)

    return step


spring_euler, spring_implicitfast, spring_rk4 = map(_spring, ("Euler", "implicitfast", "RK4"))

TARGETS = targets(
    __name__,
    "mujoco-mjx",
    "map",
    {
        "spring_euler": ("semi-implicit Euler", 1, "symplectic_euler"),
        "spring_implicitfast": ("implicit in velocity, fast", 1, "symplectic_euler"),
        "spring_rk4": ("4th-order Runge-Kutta", 4, "rk4"),
    },
)
