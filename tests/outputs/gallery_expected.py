"""What each target of the gallery is, found without a verdict of driftproof: read in its source, tried with numbers."""

from dataclasses import dataclass

from driftproof.methods.catalogue import METHODS


@dataclass(frozen=True)
class Expected:
    """A key of the catalogue, or words; the order that one step shows; and what of the package's claim is not so.

    The order is that of y' = f(t, y), or of y' = f(y) where the step takes no time; called by `force` of
    q'' = F(q), called by `map` on the oscillator; None where the step is of another equation. `loose` is how
    far an iterated step stays from its equations.
    """

    what: str
    order: int | None
    untrue: str = ""
    loose: float = 0.0


def _same(package, loose=0.0, **whats):
    """Targets that are the catalogue's method to roundoff, or so loosely, with its order, as their packages say."""
    return {
        f"{package} {step}": Expected(what, METHODS[what].claimed_order, loose=loose) for step, what in whats.items()
    }


FIELDS = {
    **_same("scipy", rk23="bogacki_shampine32", rk45="dormand_prince54", dop853="dop853"),
    **_same("scipy", ode_dopri5="dormand_prince54", ode_dop853="dop853"),
    **_same("extensisq", ts5="tsitouras54", bs5="bogacki_shampine54", ck5="cash_karp54", ckdisc="cash_karp54"),
    **_same("extensisq", me4="merson45"),
    "extensisq cfmr7osc": Expected("Calvo, Franco, Montijano and Rández, nine stages", 7),
    "extensisq pr7": Expected("Prince, ten stages", 7),
    "extensisq pr8": Expected("Prince, thirteen stages", 8),
    "extensisq pr9": Expected("Prince, seventeen stages", 9),
    **_same("torchdiffeq", euler="forward_euler", midpoint="midpoint2", heun2="heun2", heun3="heun3", rk4="rk38"),
    **_same("torchdiffeq", adaptive_heun="heun2", bosh3="bogacki_shampine32", dopri5="dormand_prince54"),
    **_same("torchdiffeq", dopri8="prince_dormand87"),
    "torchdiffeq fehlberg2": Expected("the second-order weights of Fehlberg's 1(2) pair", 2),
    **_same("torchode", euler="forward_euler", heun="heun2", dopri5="dormand_prince54", tsit5="tsitouras54"),
    **_same("torchdyn", euler="forward_euler", midpoint="midpoint2", dopri5="dormand_prince54", tsit5="tsitouras54"),
    "torchdyn rk4": Expected("rk4 with the times t, t, t + h/2, t + h/2", 1, "order 4 only if f does not depend on t"),
    "torchdyn leapfrog": Expected("midpoint2", 2, "'symplectic': the explicit midpoint method is not"),
    **_same("torchsde", euler="forward_euler", milstein="forward_euler", midpoint="midpoint2", heun="heun2"),
    **_same("torchsde", euler_heun="forward_euler", reversible_heun="heun2", log_ode="midpoint2"),
    "torchsde srk_additive": Expected("two stages, the second at 3/4", 2),
    "torchsde srk": Expected("ssprk33", 3),
    **_same("sdeint", ito_euler="forward_euler", ito_sri2="heun2", strat_heun="heun2", strat_srs2="heun2"),
    **_same("sdeint", strat_kp2is="forward_euler"),
    **_same("neuromancer", euler="forward_euler", euler_trap="heun2", rk2="midpoint2", rk4="rk4", luther="luther6"),
    "neuromancer rk4_trap": Expected("the trapezoidal rule with rk4 as its predictor", 2),
    "neuromancer fehlberg": Expected("the fifth-order weights of Fehlberg's 4(5) pair", 5),
    **_same("diffrax", euler="forward_euler", heun="heun2", midpoint="midpoint2", ralston="ralston2"),
    **_same("diffrax", bosh3="bogacki_shampine32", tsit5="tsitouras54", dopri5="dormand_prince54"),
    **_same("diffrax", dopri8="prince_dormand87", reversible_heun="heun2"),
    "diffrax leapfrog_midpoint": Expected("forward_euler", 1, "a first step alone, which the documentation says"),
    **_same("brainpy", euler="forward_euler", midpoint="midpoint2", heun2="heun2", ralston2="ralston2"),
    **_same("brainpy", rk2="ralston2", rk3="kutta3", heun3="heun3", ralston3="ralston3", ssprk3="ssprk33"),
    **_same("brainpy", rk4="rk4", rk4_38rule="rk38", rkdp="dormand_prince54", bs="bogacki_shampine32"),
    "brainpy ralston4": Expected("ralston4 with coefficients of eight digits", 4, "order 4 down to errors of 1e-8 h"),
    "brainpy rkf12": Expected("the second-order weights of Fehlberg's 1(2) pair", 2, "'method order = 1'"),
    "brainpy rkf45": Expected("the fifth-order weights of Fehlberg's 4(5) pair", 5, "'a method of order O(h^4)'"),
    "brainpy ck": Expected("cash_karp54", 5, "'method order = 4'"),
    "brainpy heun_euler": Expected("heun2", 2, "'method order = 1'"),
    **_same("desolver", euler="forward_euler", midpoint="midpoint2", heun="heun2", ralston="ralston2"),
    **_same("desolver", heun_euler="heun2", rk4="rk4", rk5="cash_karp54", rk45ck="cash_karp54"),
    **_same("desolver", dopri45="dormand_prince54"),
    "desolver euler_trap": Expected("the trapezoidal rule, corrected three times from Euler's prediction", 2),
    "desolver rk8713m": Expected("the seventh-order weights of Prince and Dormand's 8(7)13M", 7, "'order 8'"),
    "desolver rk108": Expected("Feagin, seventeen stages", 10),
    "desolver rk1412": Expected("Feagin, thirty-five stages", 14),
    "desolver symplectic_euler": Expected("velocity_verlet", 1, "symplectic Euler, order 1; on q'' = F(q) order 2"),
    "desolver bab_s9o7h": Expected("Nielsen's BAB'S9O7H", 1, "order 7 on the oscillator only; on q'' = F(q) order 4"),
    "desolver aba_s5o6h": Expected("Nielsen's ABAS5O6H", 1, "order 6 on the oscillator only; on q'' = F(q) order 4"),
    **_same("desolver", 1e-14, gauss4="gauss2", gauss6="gauss3", backward_euler="backward_euler"),
    **_same("desolver", 1e-14, implicit_midpoint="implicit_midpoint", crank_nicolson="trapezoid"),
    **_same("desolver", 1e-14, lobatto_iiia2="trapezoid", lobatto_iiia4="lobatto_iiia3"),
    **_same("desolver", 1e-14, lobatto_iiib2="lobatto_iiib2", lobatto_iiib4="lobatto_iiib3"),
    **_same("desolver", 1e-14, lobatto_iiic2="lobatto_iiic2", lobatto_iiic4="lobatto_iiic3", radau_ia3="radau_ia2"),
    **_same("desolver", 1e-14, radau_ia5="radau_ia3", radau_iia5="radau_iia3"),
    "desolver radau_iia3": Expected("Radau IIA with 1/3 for 1/4 in its last row", 1, "'order 3'"),
    **_same("odespy", rk45="dormand_prince54", rkf78="fehlberg78", rkck="cash_karp54"),
    "odespy rk78": Expected("the seventh-order weights of Prince and Dormand's 8(7)13M", 7, "'RK8(7)13M'"),
    "odespy rkf45": Expected("the fifth-order weights of Fehlberg's 4(5) pair", 5, "'a 4th-order formula'"),
    "odespy rkv": Expected("Verner's most robust 6(5)", 6),
    **_same("ode-explorer", forward_euler="forward_euler", heun="heun2", rk4="rk4", dopri45_5="dormand_prince54"),
    "ode-explorer backward_euler": Expected("backward_euler", 1, "'order=2'", loose=1e-8),
    "ode-explorer dopri45_4": Expected("no method: its last stage is y1, not f(y1)", 0, "'one accurate of order 4'"),
    **_same("nodepy", fe="forward_euler", heun22="heun2", mid22="midpoint2", mte22="ralston2", ssp33="ssprk33"),
    **_same("nodepy", heun33="heun3", ssp43="ssprk43", ssp104="ssprk104", rk44="rk4", burk65="butcher5"),
    **_same("nodepy", merson43="merson45", zonneveld43="zonneveld43", tsit5="tsitouras54", ck5="cash_karp54"),
    **_same("nodepy", dp5="dormand_prince54", bs3="bogacki_shampine32", bs5="bogacki_shampine54"),
    **_same("nodepy", pd8="prince_dormand87"),
    "nodepy ssp22star": Expected("two stages, order 2", 2),
    "nodepy nssp32": Expected("three stages, order 2", 2), "nodepy nssp33": Expected("three stages, order 3", 3),
    "nodepy ssp53": Expected("Ruuth and Spiteri, weights of fourteen digits that add up to 1 + 3e-10", 3, "order 3"),
    "nodepy ssp54": Expected("Ruuth and Spiteri, five stages", 4),
    "nodepy ssp63": Expected("six stages", 3), "nodepy ssp75": Expected("seven stages", 5),
    "nodepy ssp85": Expected("eight stages", 5), "nodepy ssp95": Expected("nine stages", 5),
    "nodepy lambert65": Expected("Lambert's method with 1/8, 1/8 for 3/16, 1/16", 2, "order 5, by its name"),
    "nodepy fehlberg43": Expected("Fehlberg 4(3), fourth-order weights", 4),
    "nodepy fehlberg45": Expected("the fifth-order weights of Fehlberg's 4(5) pair", 5),
    "nodepy hh5": Expected("Higham and Hall", 5), "nodepy hh5s": Expected("Higham and Hall, S", 5),
    "nodepy ss3": Expected("Sharp and Smart's second-order weights", 2, "'RK3(2)': b and bhat stand exchanged"),
    "nodepy cmr6": Expected("Calvo, Montijano and Rández", 6),
    **_same("pathsim", euf="forward_euler", ssprk22="heun2", ssprk33="ssprk33", ssprk34="ssprk43", rk4="rk4"),
    **_same("pathsim", rkbs32="bogacki_shampine32", rkck54="cash_karp54", rkdp54="dormand_prince54"),
    **_same("pathsim", rkf78="fehlberg78"),
    "pathsim rkf21": Expected("the second-order weights of Fehlberg's 1(2) pair", 2),
    "pathsim rkf45": Expected("the fifth-order weights of Fehlberg's 4(5) pair", 5),
    "pathsim rkv65": Expected("Verner's most robust 6(5)", 6),
    "pathsim rkdp87": Expected("prince_dormand87", 8, "'DOP853', which is another method"),
    **_same("pathsim", 1e-13, eub="backward_euler"),
    "pathsim dirk2": Expected("qin_zhang2", 2, "'L-stable': R tends to 1, as symplectic ones have to", loose=1e-13),
    "pathsim dirk3": Expected("four stages, stiffly accurate", 3),
    "pathsim esdirk32": Expected("four stages", 3, "'L-stable': R tends to -1/3"),
    "pathsim esdirk4": Expected("six stages", 4),
    "pathsim esdirk43": Expected("six stages, the stability function of esdirk43", 4),
    "pathsim esdirk54": Expected("seven stages", 5), "pathsim esdirk85": Expected("sixteen stages", 8),
    "gala rk5": Expected("cash_karp54 with every time one step late", 1, "'Dormand-Prince coefficients', 'order 5'"),
    **_same("gymnasium", acrobot_rk4="rk4"), **_same("casadi", simple_rk4="rk4", rk="rk4"),
    **_same("casadi", 1e-12, legendre1="implicit_midpoint", legendre2="gauss2", legendre3="gauss3"),
    **_same("casadi", 1e-12, radau1="backward_euler", radau2="radau_iia2", radau3="radau_iia3"),
    **_same("drake", explicit_euler="forward_euler", runge_kutta2="heun2", runge_kutta3="kutta3"),
    **_same("drake", runge_kutta5="dormand_prince54", bogacki_shampine3="bogacki_shampine32"),
    "drake implicit_euler": Expected("two half steps of backward Euler, solved loosely", 1, "one step"),
    **_same("drake", 1e-13, radau1="backward_euler", radau3="radau_iia2"),
    **_same("qutip", euler="forward_euler", rk4="rk4", tsit5="tsitouras54"),
    "qutip vern7": Expected("Verner's most efficient 7", 7),
    "qutip vern9": Expected("Verner's most efficient 9", 9),
}  # fmt: skip

FORCES = {
    "extensisq fi4n": Expected("Fine's Nyström method of five stages", 4),
    "extensisq fi5n": Expected("Fine's Nyström method of six stages", 5),
    "extensisq mu5nmb": Expected("Murua's Nyström method of nine stages", 5),
    "extensisq mr6nn": Expected("El-Mikkawy and Rahmo's Nyström method of six stages", 6),
    **_same("ode-explorer", euler_a="symplectic_euler_position_first", euler_b="symplectic_euler"),
    **_same("neuromancer", leapfrog="velocity_verlet", yoshida4="forest_ruth"),
    **_same("diffrax", semi_implicit_euler="symplectic_euler_position_first"),
    **_same("blackjax", velocity_verlet="velocity_verlet"),
    "blackjax mclachlan": Expected("McLachlan's two stages, kick first", 2),
    "blackjax yoshida": Expected("Blanes, Casas and Sanz-Serna, three stages", 2, "Yoshida's, which has order 4"),
    "blackjax omelyan": Expected("Omelyan, Mryglod and Folk, kick first, five drifts", 4),
    "blackjax implicit_midpoint": Expected("implicit_midpoint", 2, "solved to 1e-6 only", loose=1e-6),
    **_same("numpyro", velocity_verlet="velocity_verlet"),
    **_same("pyro-ppl", velocity_verlet="velocity_verlet"),
    **_same("jax-md", nve="velocity_verlet", langevin="velocity_verlet"),
    **_same("mici", leapfrog="velocity_verlet"),
    "mici implicit_leapfrog": Expected("velocity_verlet over 2 h", 0, "a step of h: each half step is a whole one"),
    "mici implicit_midpoint": Expected("implicit_midpoint", 2, "solved to 1e-9 only", loose=1e-8),
    "mici bcss2": Expected("Blanes, Casas and Sanz-Serna, two stages", 2),
    "mici bcss3": Expected("Blanes, Casas and Sanz-Serna, three stages", 2),
    "mici bcss4": Expected("Blanes, Casas and Sanz-Serna, four stages", 2),
    **_same("ase", velocity_verlet="velocity_verlet", langevin="velocity_verlet", langevin_baoab="velocity_verlet"),
    **_same("lammps", nve="velocity_verlet"),
    "openmm verlet": Expected("symplectic_euler", 1, "order 2, for velocities half a step late, which the manual says"),
    "openmm langevin": Expected("symplectic_euler", 1, "order 2, for velocities half a step late"),
    "openmm langevin_middle": Expected("symplectic_euler", 1, "order 2, for velocities half a step late"),
    **_same("rebound", leapfrog="position_verlet", leapfrog4="forest_ruth"),
    "rebound leapfrog6": Expected("nine kicks", 6), "rebound leapfrog8": Expected("seventeen kicks", 8),
    "rebound janus2": Expected("position_verlet on a grid of 1e-16", 2),
    "rebound janus4": Expected("suzuki4_position_first on a grid of 1e-16", 4),
    "rebound janus6": Expected("nine kicks, on a grid of 1e-16", 6),
    "rebound janus8": Expected("fifteen kicks, on a grid of 1e-16", 8),
    "rebound janus10": Expected("thirty-three kicks, on a grid of 1e-16", 10),
    **_same("gala", leapfrog="velocity_verlet", ruth4="forest_ruth"),
    **_same("galpy", leapfrog="position_verlet"),
    **_same("gymnasium", cartpole_euler="forward_euler", cartpole_semi_implicit="symplectic_euler"),
    "gymnasium pendulum": Expected("symplectic_euler, |v| kept below 8", 1),
    **_same(
        "mujoco", euler="symplectic_euler", implicit="symplectic_euler", implicitfast="symplectic_euler", rk4="rk4"
    ),
    "mujoco applied_force": Expected("uniform acceleration over the step", 1, "order 4: the force stands still"),
    **_same("pymunk", applied_force="forward_euler", velocity_function="symplectic_euler_position_first"),
    "pybullet plain": Expected("symplectic_euler with the drag 0.04 (1 + |v|) v", None, "'linear damping'"),
    **_same("pybullet", undamped="symplectic_euler"), **_same("Box2D", applied_force="symplectic_euler"),
    "panda3d linear_euler": Expected("uniform acceleration over the step", 1, "'linear Euler'"),
    **_same("highway-env", vehicle="forward_euler"),
    **_same("drake", semi_explicit_euler="symplectic_euler"),
    "drake velocity_implicit_euler": Expected("two half steps of backward Euler, solved loosely", 1, "one step"),
}  # fmt: skip

MAPS = {
    **_same("mujoco", spring_euler="symplectic_euler", spring_implicit="symplectic_euler", spring_rk4="rk4"),
    **_same("mujoco", spring_implicitfast="symplectic_euler"),
    "mujoco damped_euler": Expected("symplectic Euler, drag 1/2 implicit", None, "order 1, of damped motion"),
    "mujoco damped_implicit": Expected("symplectic Euler, drag 1/2 implicit", None, "order 1, of damped motion"),
    "mujoco damped_implicitfast": Expected("symplectic Euler, drag 1/2 implicit", None, "order 1, of damped motion"),
    **_same("mujoco-mjx", spring_euler="symplectic_euler", spring_implicitfast="symplectic_euler", spring_rk4="rk4"),
    **_same("brax", generalized="symplectic_euler"),
    **_same("pymunk", spring="symplectic_euler_position_first"),
    **_same("galpy", leapfrog_c="position_verlet", rk4_c="rk4", symplec4_c="forest_ruth"),
    **_same("galpy", symplec6_c="yoshida6_position_first"),
    "galpy rk6_c": Expected("the stability function of luther6 and butcher6", 6),
}

EXPECTED = FIELDS | FORCES | MAPS
