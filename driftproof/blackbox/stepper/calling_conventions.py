"""Calling conventions, recognised by the names of a stepper's parameters: a map, a force, a right-hand side, ..."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from math import prod
from typing import Any

from driftproof.support.plain_text import unknown

MAP, FORCE, FIELD, ROSENBROCK, IMEX = "map", "force", "field", "rosenbrock", "imex"
MAGNETIC, ROTATION = "magnetic", "rotation"
# Kinds whose steps are not those of y' = f(t, y) alone; each kind has probes of its own.
FAMILY_KINDS = (ROSENBROCK, IMEX, MAGNETIC, ROTATION)
# The signature of each kind, as it is shown to users.
SIGNATURES = {
    MAP: "step(q, v, h) -> (q1, v1), or step(state, h) with state = [q, v]: the system is built in",
    FORCE: "step(force, q, v, h) -> (q1, v1): q' = v, v' = force(q), or force(q, v, t)",
    FIELD: "step(f, t, y, h) -> y1: y' = f(t, y)",
    ROSENBROCK: "step(f, jac, t, y, h) -> y1: y' = f(t, y) with its Jacobian jac(t, y); also with dfdt(t, y)",
    IMEX: "step(f_explicit, f_implicit, t, y, h) -> y1: y' = f_explicit(t, y) + f_implicit(t, y)",
    MAGNETIC: "step(x, v, E, B, h) -> (x1, v1), or step(v, E, B, h) -> v1: x' = v, v' = E + v x B",
    ROTATION: "step(q, omega, h) -> q1: a quaternion, q' = q omega/2 or omega q/2",
}
FUNCTION, POSITION, VELOCITY, STATE, TIME, STEP = "function", "position", "velocity", "state", "time", "step"
# The times at which a run's states are wanted, two for one step; and the slope that a step is handed and hands on: the
# force at q, or f(t, y).
GRID, CARRIED = "grid", "carried"
# Any other argument that a force is called with.
BESIDES = "besides"
# Further functions: the Jacobian of the right-hand side, its derivative by t; or the implicit part.
JACOBIAN, TIME_SLOPE, IMPLICIT = "jacobian", "time_slope", "implicit"
# Fields at the position, as vectors or as functions of it; a quaternion, and the angular velocity.
ELECTRIC, MAGNETIC_FIELD, QUATERNION, ANGULAR = "electric", "magnetic_field", "quaternion", "angular"
# The roles of the arguments, in any order. The time may be added to all but those with a grid.
VARIANTS = (
    (MAP, (POSITION, VELOCITY, STEP)),
    (MAP, (STATE, STEP)),
    (FORCE, (FUNCTION, POSITION, VELOCITY, STEP)),
    (FIELD, (FUNCTION, STATE, STEP)),
    (FORCE, (FUNCTION, POSITION, VELOCITY, CARRIED, STEP)),
    (FORCE, (CARRIED, FUNCTION, POSITION, VELOCITY, STEP)),
    (MAP, (POSITION, VELOCITY, CARRIED, STEP)),
    (FIELD, (FUNCTION, STATE, CARRIED, STEP)),
    (FIELD, (CARRIED, FUNCTION, STATE, STEP)),
    (FIELD, (FUNCTION, STATE, GRID)),
    (ROSENBROCK, (FUNCTION, JACOBIAN, STATE, STEP)),
    (ROSENBROCK, (FUNCTION, JACOBIAN, TIME_SLOPE, STATE, STEP)),
    (IMEX, (FUNCTION, IMPLICIT, STATE, STEP)),
    (MAGNETIC, (POSITION, VELOCITY, ELECTRIC, MAGNETIC_FIELD, STEP)),
    (MAGNETIC, (POSITION, VELOCITY, MAGNETIC_FIELD, STEP)),
    (MAGNETIC, (VELOCITY, ELECTRIC, MAGNETIC_FIELD, STEP)),
    (MAGNETIC, (VELOCITY, MAGNETIC_FIELD, STEP)),
    (ROTATION, (QUATERNION, ANGULAR, STEP)),
)
# The order of the arguments if their names do not tell: that of a kind's first variant, with a time before its state.
STANDARD_ORDER = {
    kind: tuple(chain.from_iterable((TIME, role) if role == STATE else (role,) for role in roles))
    for kind, roles in reversed(VARIANTS)
}
_FUNCTIONS = (
    *("f", "fn", "fun", "func", "function", "rhs", "field", "vector_field", "force", "forces", "acc", "accel"),
    *("acceleration", "a", "deriv", "derivs", "derivative", "derivatives", "dydt", "dxdt", "dydx", "ode", "system"),
    *("dynamics", "terms", "odefun", "fcn", "eom"),
    *("f_explicit", "f_exp", "f_ex", "fex", "fe", "f_e", "explicit", "f_nonstiff", "nonstiff", "f1", "f_slow"),
)
# Names for the gradient of a potential; the force is minus its value.
_GRADIENTS = (
    *("grad", "gradient", "grad_u", "grad_v", "gradu", "gradv", "grad_potential", "potential_gradient", "dpotential"),
    *("dvdq", "dvdx", "dudq", "dudx", "du_dx", "dv_dx", "dv_dq", "du_dq", "dv", "du", "nabla_u", "nabla_v"),
)
_POSITIONS = ("q", "x", "r", "y", "pos", "position", "positions", "theta", "angle", "q0", "x0", "r0", "y0")
_VELOCITIES = (
    *("v", "vel", "velocity", "velocities", "p", "momentum", "omega", "qdot", "xdot", "q_dot", "x_dot"),
    *("dq", "dx", "theta_dot", "v0", "p0", "vx", "vy"),
)
_STATES = (
    *("y", "z", "s", "u", "x", "w", "state", "states", "body", "particle", "y0", "z0", "x0", "u0", "yn", "yi"),
    *("y_0", "u_0", "x_0", "carry", "y_n", "y_k", "xyz", "current_state"),
)
# "compute" and the like at the start of a function's name, or "fn" at its end, do not change what it computes.
VERBS = re.compile(r"^(get|compute|calc|calculate|eval|update)_?|_(fn|func|fun|function)$")
# The names under which steppers in the wild take each argument.
ROLES: dict[str, tuple[str, ...]] = {
    FUNCTION: (*_FUNCTIONS, *_GRADIENTS),
    POSITION: _POSITIONS,
    VELOCITY: _VELOCITIES,
    STATE: _STATES,
    TIME: ("t", "time", "t0", "tn", "ti", "t_n", "t_k", "current_time"),
    STEP: (  # the likeliest first: h and eps beside a dt are no step sizes
        *("dt", "timestep", "time_step", "step_size", "stepsize", "delta_t", "deltat", "deltatime", "delta_time", "δt"),
        *("frame_time", "frametime", "elapsed", "h", "step", "tau", "delta", "eps", "epsilon"),
    ),
    GRID: ("t", "ts", "times", "grid", "t_grid", "tgrid", "time_grid", "t_eval", "tlist"),
    JACOBIAN: ("jac", "jacobian", "j", "dfdy", "df_dy", "dfdx", "df_dx", "fy", "df", "fprime", "jac_f"),
    TIME_SLOPE: ("dfdt", "df_dt", "ft", "f_t", "dt_f"),
    IMPLICIT: (
        *("f_implicit", "f_imp", "f_im", "fim", "fi", "f_i", "implicit", "f_stiff", "stiff", "f2", "f_fast"),
        *("g", "linear", "l"),
    ),
    ELECTRIC: ("e", "e_field", "efield", "electric", "electric_field", "field_e", "get_e", "evec"),
    MAGNETIC_FIELD: ("b", "b_field", "bfield", "magnetic", "magnetic_field", "field_b", "get_b", "bvec"),
    QUATERNION: ("q", "quat", "quaternion", "q0", "orientation", "attitude", "rotation", "qk", "q_n"),
    ANGULAR: (
        *("omega", "w", "gyro", "gyr", "angular_velocity", "ang_vel", "angvel", "rate", "rates", "body_rates"),
        *("omega_body", "wb", "av"),
    ),
    CARRIED: (
        *("a", "acc", "accel", "acceleration", "a0", "an", "f0", "force0", "k1", "k0", "fsal", "dydt0", "dydx", "dydt"),
        *("f", "force", "forces", "accelerations"),
    ),
}
# Names that a velocity times the mass has: it is one, if a mass is among the arguments and the position moves by p/m.
MOMENTA = ("p", "momentum", "momenta", "p0")
# Further parameters of a built-in oscillator, set to what makes it q'' = -q.
STIFFNESSES = ("k", "stiffness")
UNIT_PARAMETERS = ("m", "mass", *STIFFNESSES, "omega", "omega0", "w", "w0")
# Names for the number of steps of a run.
COUNTS = ("n", "steps", "n_steps", "nsteps", "num_steps", "number_of_steps", "nt", "n_iter", "iterations", "l")
# Names for tolerances: relative to the state, and absolute.
TOLERANCE_NAMES = ("rtol", "reltol", "rel_tol"), ("atol", "abstol", "abs_tol")
# Names for what a solver takes: the span of a run or both of its ends, and the state at its start.
SPANS = ("t_span", "tspan", "span", "interval", "t_interval", "t_range", "trange")
RUN_ENDS = (
    ("t0", "t_0", "t_start", "tstart", "t_begin", "t_initial", "t_init", "ti", "start", "a"),
    (
        *("t1", "t_1", "tf", "t_end", "tend", "t_final", "tfinal", "t_stop", "tstop", "t_max", "tmax", "t_bound", "b"),
        *("x_end", "xn", "xf", "x_stop", "xstop"),
    ),
)
STARTS = (
    *("y0", "u0", "x0", "z0", "y_0", "u_0", "x_0", "ya", "alpha", "state0", "y_init", "yinit"),
    *("initial", "initial_state", "ic"),
)
# Of these capitals, two name the matrices of a linear system, as in step(P, A, Q, dt), if one is of the first three.
_MATRICES = "AMKBCDFGHPQR"
# A first speed and an angle are a launch, and no state.
_ANGLES, _SPEEDS = ("angle", "theta", "alpha"), ("v0", "speed", "u0")
# The p of step(p, h) is a particle, not a momentum.
_PARTICLE = MAP, STATE, "p"
# Names for a list of objects, each with its position, velocity and mass.
BODY_LISTS = ("bodies", "particles", "planets", "stars", "atoms", "objects", "points")
# A mass other than 1 shows whether the force is divided by it; for a power of two the quotient is exact.
MASSES, MASS = ("m", "mass", "masses"), 2.0
INVERSE_MASSES = ("inv_mass", "inverse_mass", "invmass", "minv", "m_inv")
# Likewise a charge, or a charge over the mass: the fields that are passed are divided by it.
CHARGES, _CHARGE = ("q", "charge", "qm", "q_m", "q_over_m", "qom", "charge_to_mass", "z"), 8.0
# What further arguments of each kind are given, with the words for them.
_EXTRAS: dict[str, dict[float, Sequence[str]]] = {
    MAP: {1.0: UNIT_PARAMETERS},
    FORCE: {MASS: MASSES, 1 / MASS: INVERSE_MASSES},
    MAGNETIC: {MASS: MASSES, _CHARGE: CHARGES},
}


@dataclass(frozen=True)
class CallingConvention:
    """A stepper's calling convention: its kind, and the roles of its arguments in the order in which it takes them.

    `extra` are further arguments, passed by name: the parameters of its oscillator, all 1; a mass, 2; a charge, 8; the
    number of steps, 1. `names` are those of all other arguments, if these are passed by name. The function that the
    stepper calls returns `factor` times the acceleration: the mass, -1 for the gradient of a potential, the mass
    over the charge; a slope that is handed on is `carried` times it. A `run` returns the states of `steps` steps, or is
    a generator of states. `asks` are the roles of the arguments that its force gets. With `velocity_first`, the stepper
    takes (v, q) and returns (v1, q1). `timed` says how many numbers stand before the state in an answer of several
    parts, if that is known; one is the time. `places` are those of position and velocity in one of more than two, and
    `handed` is that of the slope that is handed on, if one is. Each interval of a run is longer than the one before by
    twice `uneven` of the first. In place of a velocity it is given and returned `momentum` times it.
    """

    kind: str
    order: tuple[str, ...]
    extra: Mapping[str, float] = field(default_factory=dict)
    names: tuple[str, ...] = ()
    factor: float = 1.0
    carried: float = 1.0
    run: bool = False
    steps: int = 1
    asks: tuple[str, ...] = ()
    velocity_first: bool = False
    timed: int | None = None
    places: tuple[int, ...] = ()
    handed: int | None = -1
    uneven: float = 0.0
    momentum: float = 1.0

    def named(self, step: Callable[..., Any]) -> list[tuple[str, str]]:
        """The role and the name of each argument that is no extra."""
        names = (name for name in names_with_step(step) or () if name not in self.extra)
        return [*zip(self.order, self.names or names, strict=False)]

    def of_steps(self, steps: int) -> CallingConvention:
        """The same convention for a run of `steps` steps."""
        counts = {name: steps for name in self.extra if word_of(name) in COUNTS}
        return replace(self, extra={**self.extra, **counts}, steps=steps)

    def times(self, t: Any, h: Any) -> list[Any]:
        """The times of a run of its steps from t, whose first has the size h unless they are uneven."""
        return [t + h * n * (1 + self.uneven * n) for n in range(self.steps + 1)]

    def scaled(self, words: Sequence[str], by: float) -> CallingConvention | None:
        """The same convention with another mass, or another sign of the charge, called by these words; None if none is.

        The force, or the fields, become `by` times what they were; an acceleration stays the same.
        """
        changed = {name: by * x for name, x in self.extra.items() if word_of(name) in words}
        factor = self.factor if abs(self.factor) == 1 else by * self.factor
        return replace(self, extra={**self.extra, **changed}, factor=factor) if changed else None


def conventions_of(step: Callable[..., Any], kind: str | None = None) -> list[CallingConvention]:
    """All conventions that the parameter names allow, the most usual first; with `kind`, only those of that kind.

    In x, v, a, dt, the a may be a force or a slope that is handed on. Raises ValueError, listing what is allowed, if
    the names fit no convention, and for an unknown kind.
    """
    if kind is not None and kind not in SIGNATURES:
        raise ValueError(unknown("calling convention", kind, SIGNATURES))
    names = required_names(step)
    for tried in (names_with_step(step), names):  # a time or a step size that has a default is given
        if tried is not None:
            fitting = [_fitted(tried, *variant) for variant in VARIANTS if kind in (None, variant[0])]
            if found := [_by_name(each, step, tried) for each in fitting if each is not None]:
                return found
    if kind is not None and (names is None or len(names) == len(STANDARD_ORDER[kind])):
        return [CallingConvention(kind, STANDARD_ORDER[kind])]
    choices = "; ".join(f"{kind}: {words}" for kind, words in SIGNATURES.items())
    shown = signature_text(step)
    raise ValueError(f"{shown} is not one of these: {choices}. Name the calling convention, or write a wrapper")


def signature_text(step: Callable[..., Any]) -> str:
    """The name of a stepper with the names of its parameters that have no default."""
    names = required_names(step)
    shown = "?" if names is None else ", ".join(names)
    return f"{getattr(step, '__qualname__', type(step).__name__)}({shown})"


def reading_of(read: Mapping[str, Iterable[str]], step: Callable[..., Any]) -> str:
    """How the arguments of a step are read, as far as they are named: the state: m, p; the step size: dt; ...

    >>> reading_of({"the state": ["N"], "the time": [], "the step size": ["h"]}, lambda N, h, k: N)
    'the state: N; the step size: h; set to 1: k'
    """
    held = {name for names in read.values() for name in names}
    read = {**read, "set to 1": [name for name in required_names(step) or () if name not in held]}
    return "; ".join(f"{what}: {', '.join(names)}" for what, names in read.items() if [*names])


def required_names(step: Callable[..., Any]) -> list[str] | None:
    """The names of the parameters that have no default; None if they are unknown, or nothing but *args is known."""
    named = [p for p in (parameters_of(step) or {}).values() if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)]
    if not named and parameters_of(step) != {}:
        return None
    return [p.name for p in named if p.default is p.empty]


def names_with_step(step: Callable[..., Any]) -> list[str] | None:
    """The required names, and those of a step size and of a time with a default, unless there are others.

    Beside a quaternion, the name of an angular velocity whose default is a function is one, too.

    >>> names_with_step(lambda q, v, omega=1.0, dt=0.01: None)
    ['q', 'v', 'dt']
    """
    if (names := required_names(step)) is None:
        return None
    for role in (TIME, STEP):
        if not any(role_of(each, (role,)) for each in names):
            names += [each for each in parameters_of(step) or () if each not in names and role_of(each, (role,))][:1]
    if any(role_of(each, (QUATERNION,)) for each in names):  # of a quaternion, a function of t is as good as a system
        given = [p for p in (parameters_of(step) or {}).values() if callable(p.default) and p.default is not p.empty]
        names += [p.name for p in given if role_of(p.name, (ANGULAR,))]
    return names


def stand_in(made: Any, step: Callable[..., Any], taken: Iterable[str | inspect.Parameter]) -> None:
    """Give something callable these parameters, or such names, and the name of the step that it stands for."""
    kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
    parameters = (inspect.Parameter(each, kind) if isinstance(each, str) else each for each in taken)
    made.__signature__ = inspect.Signature([*parameters])
    made.__qualname__, made.__module__ = getattr(step, "__qualname__", type(step).__name__), step.__module__


def has_gradient(names: Sequence[str]) -> bool:
    """True if one of the names is that of a gradient, so that the force is minus its value."""
    return not {VERBS.sub("", word_of(name)) for name in names}.isdisjoint(_GRADIENTS)


def parameters_of(step: Callable[..., Any]) -> Mapping[str, inspect.Parameter] | None:
    """The parameters by name, of a torch module's forward and of a compiled function's source; None if unknown."""
    try:
        return inspect.signature(getattr(step, "forward", getattr(step, "py_func", step))).parameters
    except (TypeError, ValueError):
        return None


def _by_name(found: CallingConvention, step: Callable[..., Any], names: Sequence[str]) -> CallingConvention:
    """The convention with the names of its arguments, if they cannot be passed by position."""
    parameters = parameters_of(step) or {}
    by_place = [*parameters][: len(names)] == [*names]
    if found.extra or not by_place or any(parameters[x].kind is inspect.Parameter.KEYWORD_ONLY for x in names):
        return replace(found, names=tuple(name for name in names if name not in found.extra))
    return found


def _fitted(names: Sequence[str], kind: str, roles: Sequence[str]) -> CallingConvention | None:
    """The convention, if names and roles match one to one and all other names are known extras; otherwise None."""
    open_roles, called, extra = [*roles, *([] if GRID in roles else [TIME])], dict[str, str](), dict[str, float]()
    own = {*map(word_of, names)}
    if {*MASSES} & own and any(is_called(FUNCTION, word) and VERBS.search(word) for word in own):
        return None  # get_acc(x, m) may be asked with an array of masses: `plain_forms`
    meant, sized = _meant(names, kind, roles)
    no_roles = (*matrices(names), *launch(names))
    for name in names:
        word = meant.get(word_of(name), word_of(name))
        if name == "T" and any(map(str.islower, names)):  # the time at which a run ends
            return None
        fits = (role for role in open_roles if is_called(role, word) or (kind, role, word) == _PARTICLE)
        role = next((role for role in fits if name not in no_roles and (role != STEP or name == sized)), None)
        value = _extra(kind, word, names)
        if role is not None and not (kind == MAGNETIC and value):  # of whose names q is a charge
            open_roles.remove(role)
            called[role] = word_of(name)
        elif value:
            extra[name] = value
        else:
            return None
    if not set(open_roles) <= {TIME}:
        return None
    factor = -1.0 if has_gradient([called.get(FUNCTION, "")]) else 1.0
    if kind == MAGNETIC:
        factor *= prod(1 / value if value == _CHARGE else value for value in extra.values())
    elif kind == FORCE and {MASS, 1 / MASS} & {*extra.values()} and not is_acceleration(called[FUNCTION]):
        factor *= MASS
    carried = 1.0 if is_acceleration(called.get(CARRIED, "")) else factor
    run = GRID in roles or any(word_of(name) in COUNTS for name in extra)
    return CallingConvention(kind, tuple(called), extra, (), factor, carried, run)


def _meant(names: Sequence[str], kind: str, roles: Sequence[str]) -> tuple[dict[str, str], str]:
    """The words that stand for others in a signature, and the name of its step size.

    In f(x, y), as books write it, x is the time, and dx the step size unless there is another one.
    """
    own, sized = {*map(word_of, names)}, size_name(names)
    booked = {FUNCTION, STATE} <= {*roles} and own & {"y", "yi"} and not own & {*ROLES[TIME]}
    meant = {"x": "t", "xi": "t", "dx": "dx" if sized else "dt"} if booked else {}
    return meant | ({"q": "y"} if kind == FIELD else {}), sized or "dx" * bool(booked)


def _extra(kind: str, word: str, names: Sequence[str]) -> float | None:
    """What a further argument is given: a parameter, a mass, a charge, or a count of steps; None if it is unknown."""
    known = next((x for x, words in _EXTRAS.get(kind, {}).items() if word in words), None)
    counted = word in COUNTS and (word != "l" or has_gradient(names))  # of a sampler; of a pendulum, it is a length
    return known or (1 if counted else None)


def size_name(names: Iterable[str]) -> str:
    """The likeliest name of a step size among these; "" if none is one."""
    words = ROLES[STEP]
    return min(
        (each for each in names if is_called(STEP, word_of(each))), key=lambda x: words.index(word_of(x)), default=""
    )


def matrices(names: Iterable[str]) -> list[str]:
    """The names of matrices among these, which are neither functions nor states: A, B, Q and R, or M, C, K and F."""
    found = [each for each in names if each in [*_MATRICES]]
    return found if len(found) > 1 and {*found} & {*_MATRICES[:3]} else []


def launch(names: Iterable[str]) -> list[str]:
    """The speed and the angle of a launch among these names; nothing if one of them is lacking."""
    found = [[each for each in names if word_of(each) in words] for words in (_ANGLES, _SPEEDS)]
    return [*found[0], *found[1]] if all(found) else []


def role_of(name: str, roles: Iterable[str]) -> str | None:
    """The first of these roles that a name is in use for; None if it is in use for none of them."""
    return next((role for role in roles if is_called(role, word_of(name))), None)


def is_called(role: str, word: str) -> bool:
    """True if a word is in use for a role; a function may have a verb before it, as get_acceleration."""
    return word in ROLES[role] or (role == FUNCTION and VERBS.sub("", word) in ROLES[role])


def is_acceleration(name: str) -> bool:
    """True if the name of a function, or of a slope that is handed on, says that it is no force: a, get_acc."""
    return VERBS.sub("", word_of(name)).startswith("a")


def word_of(name: str) -> str:
    """The name of a parameter without capitals and outer underscores; Ts, a sampling time, is a step size."""
    return "dt" if name in ("Ts", "T_s") else name.lower().strip("_")
