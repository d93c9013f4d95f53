"""Whole solvers of other people's packages, solve(f, t_span, y0, ...): a function for each package makes its methods.

`examples.gallery.whole_solvers:scipy.RK45` names one, for `driftproof identify --solver`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from examples.gallery.through_jax import Callback, jax64

_MOST_STEPS = 5000


@dataclass(frozen=True)
class Package:
    """The solvers of a package, as attributes: `make(method)` is one; `methods` have the order that is claimed."""

    name: str
    make: Callable[[str], Callable[..., Any]]
    methods: dict[str, int | None]

    def __getattr__(self, method: str) -> Callable[..., Any]:
        """One of them. Raises AttributeError."""
        if method.startswith("_") or method not in self.methods:
            raise AttributeError(method)
        return self.make(method)


def _orders(text: str) -> dict[str, int | None]:
    """The methods of "A 5, B -, ...", each with its order, - where none is claimed, as where it varies."""
    pairs = (word.split() for word in text.split(","))
    return {name: None if order == "-" else int(order) for name, order in pairs}


def _of_solve_ivp(package: str) -> Callable[[str], Callable[..., Any]]:
    """The classes of a package that SciPy's solve_ivp takes."""

    def make(method: str) -> Callable[..., Any]:
        def solve(f, t_span, y0, rtol, atol):
            from importlib import import_module

            from scipy.integrate import solve_ivp

            solver = getattr(import_module(package), method)
            return solve_ivp(f, t_span, y0, solver, rtol=rtol, atol=atol)

        return solve

    return make


def _compiled(method: str) -> Callable[..., Any]:
    """The Fortran codes behind scipy.integrate.ode, one step at a time: "vode_bdf" is VODE with its BDF."""
    code, _, formulas = method.partition("_")

    def solve(f, t_span, y0, rtol, atol):
        from scipy.integrate import ode

        settings = {"method": formulas} if formulas else {}
        times, states = [], []
        solver = ode(f).set_integrator(code, rtol=rtol, atol=atol, nsteps=_MOST_STEPS, **settings)
        if code.startswith("dop"):
            solver.set_solout(lambda t, y: (times.append(t), states.append(y.copy()))[0])
            solver.set_initial_value(y0, t_span[0]).integrate(t_span[1])
            return {"t": times, "y": states, "success": solver.successful(), "message": f"{code} reports failure"}
        solver.set_initial_value(y0, t_span[0])
        times, states = [t_span[0]], [y0]
        onward = 1.0 if t_span[1] > t_span[0] else -1.0
        while solver.successful() and onward * (t_span[1] - solver.t) > 0:
            solver.integrate(t_span[1], step=True)
            if onward * (solver.t - t_span[1]) > 0:  # beyond the end, which is then interpolated
                solver.integrate(t_span[1])
            times.append(solver.t)
            states.append(solver.y.copy())
        return {"t": times, "y": states, "success": solver.successful(), "message": f"{code} reports failure"}

    return solve


@cache
def _through_diffrax(method: str, size: int) -> tuple[Callback, Callable[..., Any]]:
    """A run in compiled code, for states of so many numbers, and what its right-hand side calls back."""
    jax64()
    import diffrax
    import jax

    callback = Callback()
    term = diffrax.ODETerm(lambda t, y, args: callback(t, y))

    @jax.jit
    def run(start, end, y0, rtol, atol):
        found = diffrax.diffeqsolve(
            term, getattr(diffrax, method)(), start, end, None, y0, max_steps=4096, throw=False,
            saveat=diffrax.SaveAt(t0=True, steps=True),
            stepsize_controller=diffrax.PIDController(rtol=rtol, atol=atol),
        )  # fmt: skip
        return found.ts, found.ys, found.stats["num_accepted_steps"], found.result == diffrax.RESULTS.successful

    return callback, run


def _diffrax(method: str) -> Callable[..., Any]:
    def solve(f, t_span, y0, rtol, atol):
        import numpy as np

        callback, run = _through_diffrax(method, len(y0))
        callback.function = f
        times, states, steps, good = run(*map(float, t_span), np.asarray(y0, dtype=float), rtol, atol)
        return {
            "t": np.array(times)[: int(steps) + 1], "y": np.array(states)[: int(steps) + 1],
            "success": bool(good), "message": "diffrax reports failure",
        }  # fmt: skip

    return solve


def _torchdiffeq(method: str) -> Callable[..., Any]:
    """One of its adaptive methods: where it steps, its callback tells."""

    def solve(f, t_span, y0, rtol, atol):
        import torch
        from torchdiffeq import odeint

        class Field(torch.nn.Module):
            def __init__(self):
                super().__init__()
                self.times, self.states = [], []

            def forward(self, t, y):
                return torch.tensor(f(t.item(), y.numpy()))

            def callback_accept_step(self, t0, y0, dt):
                self.times.append(t0.item())
                self.states.append(y0.numpy())
                self.end = (t0 + dt).item()

        field = Field()
        grid = torch.tensor(t_span, dtype=torch.float64)
        options = {"dtype": torch.float64, "step_t": grid[1:]}  # a step ends at the end, which else is interpolated
        end = odeint(field, torch.tensor(y0), grid, rtol=rtol, atol=atol, method=method, options=options)[-1]
        return [*field.times, t_span[1]], [*field.states, end.numpy()]

    return solve


def _torchdiffeq_fixed(method: str) -> Callable[..., Any]:
    """One of its methods of fixed steps, on a grid of n of them."""

    def solve(f, t_span, y0, n):
        import torch
        from torchdiffeq import odeint

        grid = torch.tensor([t_span[0] + k * ((t_span[1] - t_span[0]) / n) for k in range(n + 1)], dtype=torch.float64)
        field = lambda t, y: torch.tensor(f(t.item(), y.numpy()))
        return grid.numpy(), odeint(field, torch.tensor(y0), grid, method=method).numpy()

    return solve


def _desolver(method: str) -> Callable[..., Any]:
    def solve(f, t_span, y0, rtol, atol):
        import desolver

        system = desolver.OdeSystem(
            lambda t, y: f(float(t), y), y0=y0, t=t_span, dt=(t_span[1] - t_span[0]) / 128, rtol=rtol, atol=atol
        )
        system.method = desolver.available_methods(False)[method]
        system.integrate()
        return system.t, system.y

    return solve


def _of_pathsim(method: str, f, t_span, y0, dt, tolerances, **settings: Any) -> Any:
    """A run by one of its classes; implicit ones iterate to well below the tolerance, with differences of f in y."""
    import numpy as np
    from pathsim import solvers

    def jacobian(y, t):
        return np.array([(f(t, y + e) - f(t, y - e)) / 2 for e in np.eye(len(y))]).T

    solver, slopes = getattr(solvers, method)(y0, **tolerances), [lambda y, t: f(t, y)]
    if isinstance(solver, solvers.ImplicitSolver):
        slopes.append(jacobian)
        settings |= {"tolerance_fpi": 1e-13, "max_iterations": 200}
    return solver.integrate(*slopes, time_start=t_span[0], time_end=t_span[1], dt=dt, **settings)


def _pathsim(method: str) -> Callable[..., Any]:
    def solve(f, t_span, y0, rtol, atol):
        length = t_span[1] - t_span[0]
        tolerances = {"tolerance_lte_abs": atol, "tolerance_lte_rel": rtol}
        return _of_pathsim(method, f, t_span, y0, length / 128, tolerances, dt_min=1e-14, dt_max=length)

    return solve


def _pathsim_fixed(method: str) -> Callable[..., Any]:
    return lambda f, t_span, y0, dt: _of_pathsim(method, f, t_span, y0, dt, {}, adaptive=False)


@cache
def _nodepy_methods() -> dict[str, Any]:
    from nodepy import rk

    return {name.replace("-", "_"): method for name, method in rk.loadRKM().items()}


def _nodepy(method: str) -> Callable[..., Any]:
    """A pair with its own loop, which takes one tolerance and a first step."""

    def solve(f, t_span, y0, tol):
        from nodepy import ivp

        problem = ivp.IVP(f=f, u0=y0, t0=t_span[0], T=t_span[1])
        first = (t_span[1] - t_span[0]) / 128
        return _nodepy_methods()[method](problem, t0=t_span[0], dt=first, errtol=tol, max_steps=_MOST_STEPS)

    return solve


def _nodepy_fixed(method: str) -> Callable[..., Any]:
    def solve(f, t_span, y0, n):
        from nodepy import ivp

        return _nodepy_methods()[method](ivp.IVP(f=f, u0=y0, t0=t_span[0], T=t_span[1]), t0=t_span[0], N=int(n))

    return solve


scipy = Package("scipy", _of_solve_ivp("scipy.integrate"), _orders("RK23 3, RK45 5, DOP853 8, Radau 5, BDF -, LSODA -"))
scipy_ode = Package("scipy", _compiled, _orders("dopri5 5, dop853 8, vode_adams -, vode_bdf -"))
extensisq = Package(
    "extensisq",
    _of_solve_ivp("extensisq"),
    _orders(
        "BS5 5, CFMR7osc 7, CK5 5, CKdisc -, Ts5 5, Me4 4, Pr7 7, Pr8 8, Pr9 9, SSV2stab 2, SWAG -, TRBDF2 2, TRX2 2,"
        "Kv3I 3, KC3I 3, KC4I 4, KC4Ia 4, HS2I 2, HS2Ia 2"
    ),
)
diffrax = Package(
    "diffrax",
    _diffrax,
    _orders("Heun 2, Midpoint 2, Ralston 2, Bosh3 3, Tsit5 5, Dopri5 5, Dopri8 8, ReversibleHeun 2"),
)
torchdiffeq = Package("torchdiffeq", _torchdiffeq, _orders("dopri8 8, dopri5 5, bosh3 3, fehlberg2 2, adaptive_heun 2"))
torchdiffeq_fixed = Package(
    "torchdiffeq",
    _torchdiffeq_fixed,
    _orders("euler 1, midpoint 2, heun2 2, heun3 3, rk4 4, explicit_adams 4, implicit_adams 4"),
)
desolver = Package(
    "desolver",
    _desolver,
    _orders(
        "RK1412Solver 14, RK108Solver 10, RK8713MSolver 8, RK45CKSolver 5, RK5Solver 5, RK4Solver 4, MidpointSolver 2,"
        "HeunsSolver 2, RalstonsSolver 2, EulerSolver 1, EulerTrapSolver 2, HeunEulerSolver 2, DOPRI45 5,"
        "GaussLegendre4 4, GaussLegendre6 6, BackwardEuler 1, ImplicitMidpoint 2, LobattoIIIA2 2, LobattoIIIA4 4,"
        "LobattoIIIB2 2, LobattoIIIB4 4, LobattoIIIC2 2, LobattoIIIC4 4, CrankNicolson 2, RadauIA3 3, RadauIA5 5,"
        "RadauIIA3 3, RadauIIA5 5, RadauIIA19 19"
    ),
)
pathsim = Package(
    "pathsim",
    _pathsim,
    _orders(
        "RKF21 2, RKBS32 3, RKF45 4, RKCK54 5, RKDP54 5, RKV65 6, RKF78 7, RKDP87 8, ESDIRK32 3, ESDIRK43 4,"
        "ESDIRK54 5, ESDIRK85 8, GEAR21 2, GEAR32 3, GEAR43 4, GEAR54 5, GEAR52A -"
    ),
)
pathsim_fixed = Package(
    "pathsim",
    _pathsim_fixed,
    _orders(
        "EUF 1, EUB 1, SSPRK22 2, SSPRK33 3, SSPRK34 3, RK4 4, DIRK2 2, DIRK3 3, ESDIRK4 4, BDF2 2, BDF3 3, BDF4 4,"
        "BDF5 5, BDF6 6"
    ),
)
nodepy = Package(
    "nodepy",
    _nodepy,
    _orders(
        "Merson43 4, Zonneveld43 4, Fehlberg43 4, Fehlberg45 5, Tsit5 5, CK5 5, HH5 5, HH5S 5, DP5 5, BS3 3, BS5 5,"
        "SS3 3, CMR6 6, PD8 8"
    ),
)
nodepy_fixed = Package("nodepy", _nodepy_fixed, _orders("FE 1, Heun22 2, Mid22 2, SSP33 3, SSP104 4, RK44 4, BuRK65 5"))

PACKAGES = {name: each for name, each in globals().items() if isinstance(each, Package)}
