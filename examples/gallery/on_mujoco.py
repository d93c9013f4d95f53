"""MuJoCo: one step of each of its integrators on a mass that slides along a line, with a force of ours or a spring."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets

SLIDER = """
<mujoco>
  <option gravity="0 0 0" integrator="{integrator}"><flag contact="disable" constraint="disable"/></option>
  <worldbody>
    <body>
      <joint name="x" type="slide" axis="1 0 0" stiffness="{stiffness}" damping="{damping}"/>
      <geom size="0.1" mass="1"/>
    </body>
  </worldbody>
</mujoco>
"""


@cache
def _slider(integrator, stiffness=0.0, damping=0.0):
    import mujoco

    model = mujoco.MjModel.from_xml_string(SLIDER.format(integrator=integrator, stiffness=stiffness, damping=damping))
    return model, mujoco.MjData(model)


def _moved(model, data, q, v, h, applied=0.0):
    import mujoco

    mujoco.mj_resetData(model, data)
    model.opt.timestep, data.qfrc_applied[0] = h, applied
    data.qpos[0], data.qvel[0] = q, v
    mujoco.mj_step(model, data)
    return float(data.qpos[0]), float(data.qvel[0])


def _forced(integrator):
    """A force of ours, given by the hook that MuJoCo calls for passive forces at every stage."""

    def step(force, q, v, h):
        import mujoco

        slider = _slider(integrator)  # before the hook is set: a model in the making has no state to read

        def push(model, data):
            data.qfrc_passive[0] += force(float(data.qpos[0]))

        mujoco.set_mjcb_passive(push)
        try:
            return _moved(*slider, q, v, h)
        finally:
            mujoco.set_mjcb_passive(None)

    return step


def _spring(integrator, damping=0.0):
    """A spring of MuJoCo's own, of stiffness 1, damped or not."""

    def step(q, v, h):
        return _moved(*_slider(integrator, 1.0, damping), q, v, h)

    return step


def applied_force(force, q, v, h):
    """The usual use from Python: the force is read once, before the step, whatever the integrator; here RK4."""
    return _moved(*_slider("RK4"), q, v, h, force(q))


TARGETS = targets(
    __name__,
    "mujoco",
    force={
        "euler": (_forced("Euler"), "semi-implicit Euler", 1, "symplectic_euler"),
        "implicit": (_forced("implicit"), "implicit in velocity", 1, "symplectic_euler"),
        "implicitfast": (_forced("implicitfast"), "implicit in velocity, fast", 1, "symplectic_euler"),
        "rk4": (_forced("RK4"), "4th-order Runge-Kutta", 4, "rk4"),
        "applied_force": ("4th-order Runge-Kutta", 4, "rk4"),
    },
    map={
        "spring_euler": (_spring("Euler"), "semi-implicit Euler", 1, "symplectic_euler"),
        "spring_implicit": (_spring("implicit"), "implicit in velocity", 1, "symplectic_euler"),
        "spring_implicitfast": (_spring("implicitfast"), "implicit in velocity, fast", 1, "symplectic_euler"),
        "spring_rk4": (_spring("RK4"), "4th-order Runge-Kutta", 4, "rk4"),
        "damped_euler": (_spring("Euler", damping=0.5), "semi-implicit Euler, implicit in damping", 1),
        "damped_implicit": (_spring("implicit", damping=0.5), "implicit in velocity", 1),
        "damped_implicitfast": (_spring("implicitfast", damping=0.5), "implicit in velocity, fast", 1),
    },
)
