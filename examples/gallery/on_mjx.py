"""MuJoCo MJX: one step of each of its integrators on a mass on a spring of stiffness 1."""

from __future__ import annotations

from examples.gallery.entry import targets
from examples.gallery.on_mujoco import SLIDER
from examples.gallery.through_jax import map_step


def _spring(integrator):
    def make():
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

        return step

    return map_step(make)


TARGETS = targets(
    __name__,
    "mujoco-mjx",
    map={
        "spring_euler": (_spring("Euler"), "semi-implicit Euler", 1, "symplectic_euler"),
        "spring_implicitfast": (_spring("implicitfast"), "implicit in velocity, fast", 1, "symplectic_euler"),
        "spring_rk4": (_spring("RK4"), "4th-order Runge-Kutta", 4, "rk4"),
    },
)
