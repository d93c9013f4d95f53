"""Three calling conventions, told by the names of a stepper's parameters: its map alone, a force, a right-hand side."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

MAP, FORCE, FIELD = "map", "force", "field"
# What a stepper of each is, as a reader writes it down.
SIGNATURES = {
    MAP: "step(q, v, h) -> (q1, v1), or step(state, h) with state = [q, v]: the system is built in",
    FORCE: "step(force, q, v, h) -> (q1, v1): q' = v, v' = force(q)",
    FIELD: "step(f, t, y, h) -> y1: y' = f(t, y)",
}
FUNCTION, POSITION, VELOCITY, STATE, TIME, STEP = "function", "position", "velocity", "state", "time", "step"
# The roles of the arguments, one by one; the time may be missing, and may be asked for anywhere.
VARIANTS = (
    (MAP, (POSITION, VELOCITY, STEP)),
    (MAP, (STATE, STEP)),
    (FORCE, (FUNCTION, POSITION, VELOCITY, STEP)),
    (FIELD, (FUNCTION, STATE, STEP)),
)
# The order in which a stepper takes its arguments if their names do not tell.
STANDARD_ORDER = {
    MAP: (POSITION, VELOCITY, STEP),
    FORCE: (FUNCTION, POSITION, VELOCITY, STEP),
    FIELD: (FUNCTION, TIME, STATE, STEP),
}
_FUNCTIONS = (
    *("f", "fun", "func", "function", "rhs", "field", "vector_field", "force", "forces", "acc", "accel"),
    *("acceleration", "a", "deriv", "derivs", "derivative", "derivatives", "dydt", "dxdt", "ode", "system"),
    *("dynamics", "get_force", "get_acceleration"),
)
_POSITIONS = ("q", "x", "r", "y", "pos", "position", "positions", "theta", "angle", "q0", "x0", "r0", "y0")
_VELOCITIES = (
    *("v", "vel", "velocity", "velocities", "p", "momentum", "omega", "qdot", "xdot", "q_dot", "x_dot"),
    *("dq", "dx", "theta_dot", "v0", "p0"),
)
_STATES = ("y", "z", "s", "u", "x", "w", "state", "y0", "z0", "x0", "u0", "yn", "yi")
# The names under which steppers in the wild take each argument.
ROLES: dict[str, tuple[str, ...]] = {
    FUNCTION: _FUNCTIONS,
    POSITION: _POSITIONS,
    VELOCITY: _VELOCITIES,
    STATE: _STATES,
    TIME: ("t", "time", "t0", "tn", "ti"),
    STEP: ("h", "dt", "step", "step_size", "stepsize", "timestep", "time_step", "delta_t", "tau", "delta"),
}
# Further parameters of a built-in oscillator, set to what makes it q'' = -q.
UNIT_PARAMETERS = ("m", "mass", "k", "stiffness", "omega", "omega0", "w", "w0")


@dataclass(frozen=True)
class CallingConvention:
    """How a stepper is called, and the roles of its arguments in the order in which it takes them.

    `extra` are arguments besides, passed by name: the parameters of its oscillator, all 1. `names` are those of all
    others, where they are passed by name, too.
    """

    kind: str
    order: tuple[str, ...]
    extra: Mapping[str, float] = field(default_factory=dict)
    names: tuple[str, ...] = ()


def convention_of(step: Callable[..., Any], kind: str | None = None) -> CallingConvention:
    """The calling convention of a stepper, from the names of its parameters; with `kind`, that one.

    Raises ValueError, saying what is allowed, if the names do not tell, or for an unknown kind.
    """
    if kind is not None and kind not in SIGNATURES:
        raise ValueError(f"unknown calling convention {kind!r}; choose from {', '.join(SIGNATURES)}")
    names = _required_names(step)
    if names is not None:
        fitting = (_fitted(names, *variant) for variant in VARIANTS if kind in (None, variant[0]))
        found = next((each for each in fitting if each is not None), None)
        if found is not None:
            return _by_name(found, step, names)
    if kind is not None and (names is None or len(names) == len(STANDARD_ORDER[kind])):
        return CallingConvention(kind, STANDARD_ORDER[kind])
    name = getattr(step, "__qualname__", type(step).__name__)
    shown = "(?)" if names is None else f"({', '.join(names)})"
    choices = "; ".join(f"{kind}: {words}" for kind, words in SIGNATURES.items())
    raise ValueError(
        f"{name}{shown} is not one of these: {choices}. Bind other arguments, or name the calling convention"
    )


def _required_names(step: Callable[..., Any]) -> list[str] | None:
    """The parameters that have no default; None where they cannot be told."""
    try:
        parameters = inspect.signature(step).parameters.values()
    except (TypeError, ValueError):
        return None
    if any(p.kind is p.VAR_POSITIONAL for p in parameters):
        return None
    return [p.name for p in parameters if p.default is p.empty and p.kind is not p.VAR_KEYWORD]


def _by_name(found: CallingConvention, step: Callable[..., Any], names: Sequence[str]) -> CallingConvention:
    """The convention with the names of its arguments, where an order does not tell which is which."""
    parameters = inspect.signature(step).parameters
    if found.extra or any(parameters[name].kind is inspect.Parameter.KEYWORD_ONLY for name in names):
        return replace(found, names=tuple(name for name in names if name not in found.extra))
    return found


def _fitted(names: Sequence[str], kind: str, roles: Sequence[str]) -> CallingConvention | None:
    """The convention, if each name has one of the roles, each role one name, and the rest belong to an oscillator."""
    open_roles, order, extra = [*roles, TIME], [], {}
    for name in names:
        word = name.lower().strip("_")
        role = next((role for role in open_roles if word in ROLES[role]), None)
        if role is not None:
            open_roles.remove(role)
            order.append(role)
        elif kind == MAP and word in UNIT_PARAMETERS:
            extra[name] = 1.0
        else:
            return None
    return CallingConvention(kind, tuple(order), extra) if set(open_roles) <= {TIME} else None
