"""A question in the words of people asks what the plain one asks; a word that may mean two things is answered so."""

import re

import pytest

from driftproof.symbolic.facts import FACTS
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.questions.problems import PROBLEM_READOUTS
from driftproof.texts.questions.runs import RUN_READOUTS
from driftproof.texts.questions.wording import AMBIGUOUS_FACTS, FACT_WORDS, READOUT_WORDS
from tests.looping import some
from tests.texts.questions.refusals import require_refusal

DECAY = "run heun2 rates=(-y0) from 1 h=1/10 t=1 : state_error"
SAME = {
    "largest stable step of Euler on T'=-25(T-20)": "2/25",
    "stability limit of RK4 for x'' = -4 x": "imaginary_limit rk4 / 2",
    "maximal step of backward Euler on y'=-y, y(0)=1": "real_limit backward_euler",
    "error of Heun with h=0.1 at t=1 on y'=-y, y(0)=1": DECAY,
    "Heun's method y'=-y, y(0)=1, h=0.1, t=1 : error": DECAY,
    "run Heun y' = -y y(0) = 1 dt=0.1 T=1 : global error": DECAY,
    "run heun2 rates=(-y) from 1 h=0.1 10 steps : error": DECAY,
    "run heun2 rates=(-y) from 1 h=0.1 t=1 : y": "run heun2 rates=(-y0) from 1 h=1/10 t=1 : y0",
    "run heun2 x'=-x, x(0)=1, h=1/10, t=1 : x": "run heun2 rates=(-y0) from 1 h=1/10 t=1 : y0",
    "run heun2 y'=-y, y(0)=1, h=1/10, t=1 : exact.y": "exact rates=(-y0) from 1 t=1 : y0",
    "exact y'=-2*y, y(0)=1, t=1 : y": "exact rates=(-2*y0) from 1 t=1 : y0",
    "RK4 x'=v, v'=-sin(x), v(0)=1/2, x(0)=2, h=1/4, t=1 : v": "run rk4 rates=(y1, -sin(y0)) from 2,1/2 h=1/4 t=1 : y1",
    "local error of Euler h=0.1": "step forward_euler h=1/10 : state_error",
    "energy after 1000 steps of forward Euler with h=0.01": "run forward_euler h=1/100 N=1000 : energy",
    "phase error of velocity Verlet h=1/10 t=10": "run velocity_verlet h=1/10 t=10 : phase_error",
    "steps of Dormand-Prince to t=10 with h=0.01": "run dormand_prince54 h=1/100 t=10 : steps",
    "run velocity Verlet n=10 dt=1/4 : position": "run velocity_verlet N=10 h=1/4 : q",
    "amplification factor of RK4 at z=-2": "stability_function rk4 z=-2",
    "R(z) of RK4": "stability_function rk4",
    "R(oo) of Radau IIA 3": "limit_at_infinity radau_iia2",
    "What is the order of RK4?": "order rk4", "RK4 error constant": "error_constant rk4",
    "is Crank-Nicolson A-stable?": "a_stable trapezoid", "Crank-Nicolson A-stable": "a_stable trapezoid",
    "position Verlet h=0.1 t=1 : v": "run position_verlet h=0.1 t=1 : v",
    "RK4 steps=10 t=1 : q": "run rk4 N=10 t=1 : q", "real stability interval of RK4": "real_limit rk4",
    "SSP coefficient of SSPRK3": "ssp_coefficient ssprk33",
    "order of the error estimate of Dormand-Prince": "estimate dormand_prince54 : order",
    "angle of BDF3": "sector bdf3 : degrees", "error constant of BDF2": "-1/3", "W order of ROS2": "2",
    "zero-stable BDF6": "zero_stable bdf6",
    "phase error per step of RK4 h=1/10": "step rk4 h=1/10 : phase_error",
    "function evaluations per step of RK4": "4",
    "a21 of RK4 + a_4_3 of RK4 + b2 of RK4 + c4 of RK4": "1/2 + 1 + 1/3 + 1",
    "bhat1 of Dormand-Prince": "5179/57600", "a12 of gauss2": "1/4 - sqrt(3)/6", "stages RK4-order RK4": "0",
    "stability function of Crank-Nicolson": "stability_function trapezoid",
    "real limit RK4": "real_limit rk4",
    "imaginary_limit velocity Verlet": "imaginary_limit velocity_verlet",
    "order of Bogacki-Shampine": "order bogacki_shampine32",
    "order RK4-3/8": "order rk4 - 3/8", "step RK4 3/8 h=1/2 : q": "step rk38 h=1/2 : q",
    "step Euler-Cromer h=1/2 : q": "step symplectic_euler h=1/2 : q",
    "ratio(order of RK4, order of Heun)": "ratio(order rk4, order heun2)",
    "order sdirk_order_2 at 1/4": "order sdirk_order_2 at (1/4)",
    "order of convergence of RK4": "order rk4",
    "run Heun dy/dt=-y, y(0)=1, h=0.1, t=1 : error": DECAY,
    "run Heun y'(t)=-y, y(0)=1, h=0.1, t=1 : error": DECAY,
    "relative error of Heun on y'=-y, y(0)=1, h=0.1, t=1": f"({DECAY}) / exp(-1)",
    "run heun2 lambda=-1 h=1/10 t=1 : relative_error": f"({DECAY}) / exp(-1)",
    "L*I' = V - R I, I(0)=0, L=1/2, R=2, V=10 with rk4 h=0.1 t=1 : I": "run rk4 y'=20-4y y(0)=0 h=0.1 t=1 : y",
    "2*x''=-8x, x(0)=1, x'(0)=0 with rk4 h=0.1 t=1 : x": "run rk4 x'=v v'=-4x x(0)=1 v(0)=0 h=0.1 t=1 : x",
    "I(1) of the exact solution of I'=-I, I(0)=1": "exact y'=-y y(0)=1 t=1 : y",
    "largest energy error of Euler y'=-y, y(0)=1, energy=y^2, h=1, t=2":
    "run forward_euler rates=(-y0) from 1 energy=y0^2 h=1 t=2 : largest_energy_change",
    "relative error of RK4 h=1/4 t=10 from 3,4": "(run rk4 h=1/4 t=10 from 3,4 : state_error) / 5",
    "2*π": "2*pi",
    "1 - 10 steps of RK4 with h=0.1 : q": "1 - run rk4 h=1/10 t=1 : q",
    "run Heun y'=lambda y, lambda=-2, y(0)=3, h=1/4, t=1 : y": "3 * run heun2 lambda=-2 h=1/4 t=1 : y",
    "run rk4 rates=(lambda*y1, λy0) λ=1/2 from 1,0 h=1 t=1 : y1": "run rk4 rates=(y1/2, y0/2) from 1,0 h=1 t=1 : y1",
    "exact y'=λy λ=-2 y(0)=1 t=1": "exact rates=(-2*y0) from 1 t=1 : y0",
    "run rk4 λ=-2 h=1/4 t=1 : y": "run rk4 lambda=-2 h=1/4 t=1 : y",
    "log(2)": "ln(2)", "e^-0.5": "e ** (-1/2)",
    "how many stages does Dormand-Prince have?": "stages dormand_prince54",
    "y(1) of Heun for y'=-y, y(0)=1, h=0.1": "run heun2 rates=(-y0) from 1 h=1/10 t=1 : y0",
    "run heun2 y'=y-exp(1) y(0)=1 h=1/10 t=1 : y": "run heun2 rates=(y0-exp(1)) from 1 h=1/10 t=1 : y0",
    "q(10) of RK4 h=1/4": "run rk4 h=1/4 t=10 : q",
    "what is the value of y at t=1 with Heun y'=-y y(0)=1 h=0.1?": "run heun2 rates=(-y0) from 1 h=1/10 t=1 : y0",
    "k2.v of RK4 h=1/2": "step rk4 h=1/2 : k2.v",
    "exact solution of y'=-2*y, y(0)=1 at t=1": "exact rates=(-2*y0) from 1 t=1 : y0",
    "convergence rate of RK4": "order rk4",
    "how large is the error of Heun for y'=-y, y(0)=1, h=0.1 at t=1?": DECAY,
    "slope k2.v of RK4 h=1/2": "step rk4 h=1/2 : k2.v",
    "number of function evaluations of RK4 h=1/4 t=1": "16",
    "does radau_iia2 have stiff decay?": "l_stable radau_iia2",
    "global error of RK4 with step 0.1 at t=1": "run rk4 h=1/10 t=1 : state_error",
    "error of RK4, step size = 0.1, at t=1": "run rk4 h=1/10 t=1 : state_error",
    "error of RK4 with time step h=0.1 over N=10 steps": "run rk4 h=1/10 t=1 : state_error",
    "compute the error of the Heun method on dy/dt = -y, y(0) = 1, 10 steps, to t=1": DECAY,
    "approximate y(1) using Heun with h=0.1, for y'=-y, y(0)=1": "run heun2 rates=(-y0) from 1 h=1/10 t=1 : y0",
    "solution of y'=-2*y, y(0)=1 at t=1": "exact rates=(-2*y0) from 1 t=1 : y0",
    "amplification factor of Heun for h lambda = -3": "stability_function heun2 z=-3",
    "how many function evaluations does RK4 need per step?": "4",
    "error of RK4 h=1/2 per step": "step rk4 h=1/2 : state_error",
    "is velocity Verlet time reversible": "symmetric velocity_verlet",
    "what is sqrt(2)": "sqrt(2)",
    "velocity after one step of velocity Verlet from (3, 4) with h=1/2": "run velocity_verlet h=1/2 N=1 from 3,4 : v",
    "evaluations of f for RK4 in ten steps with h=0.01": "40",
    "principal error norm of RK4": "sqrt(principal_error rk4 : squared_norm)",
    "stability interval of RK4 on the imaginary axis": "imaginary_limit rk4", "solve_ivp RK45 order": "5",
    "sin(3*pi/2)^2": "sin(1*pi/2)",
    "run rk4 y'=sin t - cos 2t, y(0)=1, h=1, t=1 : y": "run rk4 rates=(sin(t)-cos(2*t)) from 1 h=1 t=1 : y0",
    "Euler method y'=y, y(0)=1, h=0.1, y(1)": "(11/10)**10", "RK4 h=1/4, q(10)": "run rk4 h=1/4 t=10 : q",
    "ratio(q of RK4 h=1 t=1, q(2) of RK4 h=1)": "ratio(run rk4 h=1 t=1 : q, run rk4 h=1 t=2 : q)",
    "error of Heun for y'=-2y, y(0)=1, h=0.1, t=1": "run heun2 rates=(-2*y0) from 1 h=1/10 t=1 : state_error",
    "run rk4 y' = -2 y y(0)=1 h=0.1 t=1 : y": "run rk4 rates=(-2*y0) from 1 h=1/10 t=1 : y0",
    "run rk4 y'=y(1-y), y(0)=0.1, h=1/2, t=1 : y": "run rk4 rates=(y0*(1-y0)) from 1/10 h=1/2 t=1 : y0",
    "run rk4 y'=2y^2(1-y)/3 y(0)=1/2 h=1/2 t 1 : y": "run rk4 rates=(2*y0^2*(1-y0)/3) from 1/2 h=1/2 t=1 : y0",
    "run rk4 dy/dt=2sin(t)y + t y, y(0)=1, h=1/2, t=1 : y": "run rk4 rates=(2*sin(t)*y0+t*y0) from 1 h=1/2 t=1 : y0",
    "run rk4 x'=2v, v'=-3x, x(0)=2, v(0)=0, h=1, t=1 : x": "run rk4 rates=(2*y1,-3*y0) from 2,0 h=1 t=1 : y0",
    "run rk4 y'=-2 y(0)=1 h=1/2 t=1 : y": "run rk4 rates=(-2) from 1 h=1/2 t=1 : y0",
    "velocity-Verlet order": "order velocity_verlet",
    "run rk4 h=1/4, problem=pendulum, t=1 : y0": "run rk4 problem=pendulum h=1/4 t=1 : y0",
    "one RK4 step with h=0.5 : q": "step rk4 h=1/2 : q", "the first RK4 step, h=0.5 : q": "step rk4 h=1/2 : q",
    "one step of RK4 with h=0.5 : q": "step rk4 h=1/2 : q", "first step of RK4, h=0.5 : v": "step rk4 h=1/2 : v",
    "RK4 step 0.5 t=1 : q": "run rk4 h=1/2 t=1 : q",
    "an Euler step with h=1/2 for y'=-y, y(0)=1 : y": "1/2", "one-step error of RK4 h=1/2": "local error of rk4 h=1/2",
    "three steps of RK4 with h=0.1 : q": "run rk4 h=1/10 N=3 : q", "RK4, h=0.1, t=10 : q": "run rk4 h=1/10 t=10 : q",
    "RK4 with step size 0.1 up to t = 10 : q": "run rk4 h=1/10 t=10 : q",
    "x'=v, v'=-x, x(0)=1, v(0)=0 with RK4, h=0.1, t=1 : x": "run rk4 h=1/10 t=1 : q",
    "Euler y'=y y(0)=1 h=0.25 : y(1)": "(5/4)**4",
}  # fmt: skip


@pytest.mark.parametrize("question", SAME)
def test_question_in_other_words_has_the_same_answer(question):
    found, plain = value(question), value(SAME[question])
    assert (found.exact_text, found.unit) == (plain.exact_text, plain.unit)
    if found.is_number:
        assert found.digits(20) == plain.digits(20)


REFUSED = [
    ("stability limit of RK4", 1, "may mean real_limit RK4 (largest hλ on y' = -λy) or imaginary_limit RK4"),
    ("largest stable step of RK4 on y'=-sin(y)", 34, "the largest stable step is known of y' = -cy and x'' = -cx"),
    ("stability interval of RK4 on y'=-y", 1, "stability_interval may mean real_limit RK4"),
    ("observed order of RK4 from h=0.2 to h=0.1", 1, "ratio(run RK4 h=0.2 t=1 : error, run RK4 h=0.1 t=1 : error)"),
    ("observed order of RK4 at t=5 on y'=-y, y(0)=1", 1, "(run RK4 y'=-y, y(0)=1, h=1/10, t=5 : error, run RK4 y'=-y"),
    ("largest energy change of RK4 on y'=-y, y(0)=1, h=1, t=1", 1, "slope.y, k1.y, k2.y, k3.y, k4.y; add what it is"),
    ("error of Heun with h=0.1 at t=1 on y'=-y", 1, "y(0) = ... is missing, as in y'=-y, y(0)=1"),
    ("run rk4 y(0)=1 h=1 t=1 : y", 1, "y' = ... is missing"),
    ("run rk4 y'=-y y'=-y y(0)=1 h=1 t=1 : y", 15, "'y' is given twice"),
    ("run rk4 rates=(-y) y(0)=1 h=1 t=1 : y", 1, "y' = ... is missing"),
    ("y(1) of Heun y'=-y y(0)=1 h=1 : error", 33, "'error' is given twice"),
    ("run rk4 rates=(-y) y'=-y y(0)=1 h=1 t=1 : y", 20, "'y' is given twice"),
    ("run rk4 y'=-k*y y(0)=1 h=1 t=1 : y", 12, "rate y, '-k*y': 'k' is not allowed; write + - * / with t, y"),
    ("run rk4 y'=-y y(0)=1 energy=k h=1 t=1 : y", 12, "energy, 'k': 'k' is not allowed; write + - * / with t, y"),
    ("run leapfrog h=0.1 t=1 : q", 5, "'leapfrog' may mean velocity_verlet"),
    ("run rk4 y'''=-y y(0)=1 h=1 t=1 : y", 10, "an equation has at most two primes; write y''' = y as"),
    ("run rk4 y''=-y y(0)=1 h=1 t=1 : y", 1, "y'(0) = ... is missing"),
    ("run rk4 x''=-x, x(0)=1, x'(0)=0, h=1, t=1 : y", 45, "'y' is not a readout of run"),
    *((f"run rk4 y'=-y y(0)=1 {k}=2 h=1 t=1 : {k}", 22, f"'{k}' is not a setting; use h, t") for k in "ky"),
    ("run rk4 y'=-1/2y y(0)=1 h=1 t=1 : y", 16, "after / or ^ write a product with its sign: 2*y"),
    ("run rk4 y'=2ty y(0)=1 h=1 t=1 : y", 13, "'ty' is not an unknown or a function; write a product as t*y or t y"),
    ("run rk4 y'=erf(y) y(0)=1 h=1 t=1 : y", 12, "the functions are sin, cos, exp, log, sqrt"),
    ("run rk4 y'=-y y(1)=1 h=1 t=1 : y", 17, "time starts at 0: write the initial value as y(0) = ..."),
    ("relative error of RK4 h=1/4 t=10 from 0,0", 1, "the exact state is the origin"),
    ("order rk4 rk4", 11, "as in run heun2 y'=-y y(0)=1 h=0.1 t=1 : error"),
    ("phase error per step of velocity Verlet h=0.1", 1, "may mean dispersion velocity_verlet (leading phase error of"),
    ("phase error of Verlet per step with h=0.1", 1, "(of the step from (1, 0), whose orbit is no circle): say which"),
    ("energy of RK4 after 1000 cycles", 21, "a period is not a whole number of steps"),
    ("run rk4 h=1 t=1 from (1,0 : q", 27, "the bracket of a start is not closed"),
    ("invariant symplectic_euler z=1", 28, "invariant does not take z here"),
    ("run rk4 h=1 t=1 z=2 : q", 17, "run does not take z here"),
    ("order of gauss4 for stiff problems", 21, "for the order on stiff problems, ask for stage_order"),
    ("b[2] of RK4", 2, "coefficients are b2 and a21, counted from 1"),
    ("R(2i) of RK4", 3, "z must be real; |R(iy)|^2 is energy_multiplier METHOD h=y"),
    ("bhat1 of RK4", 1, "rk4 has no bhat1"),
    ("c5 of RK4", 1, "rk4 has no c5"),
    ("b1 of velocity Verlet", 1, "velocity_verlet has no tableau of numbers"),
    ("phase lag of bdf2", 1, "bdf2 is a linear multistep method, and has no dispersion; choose from method, title"),
    ("exact rk4 y'=-y y(0)=1 t=1 : y", 7, "exact takes no method"),
    ("exact problem=pendulum at 2 t=1 : y0", 27, "exact takes no method"),
    ("energy drift of RK4 per period", 21, "a period is not a whole number of steps"),
    ("error of RK4 on the pendulum with h=0.1", 21, "to name a problem, write problem=pendulum"),
    ("BDF2 started with backward Euler : y", 6, "what starts a multistep method is said as in started=rk4"),
    ("error of RK4 on the string with h=0.1", 21, "unexpected 'string'; a colon and a readout may follow"),
    ("RK4", 1, "RK4 is a method; ask for one of its values, as in order rk4, or run rk4 h=0.1 t=1 : q"),
    ("rk4(h=0.1)", 1, "rk4 is a method, not a function; ask for example: order rk4"),
    ("steps of RK4 t=10 error=1e-3", 19, "how many steps reach an error is what driftproof work-precision tells"),
    ("k2 of RK4 for y'=y, y(0)=1, h=0.1", 1, "'k2' is not a readout of step; the readouts are y, exact.y"),
    ("rounding error of RK4 with h=0.1", 1, "the command driftproof roundoff RK4 --h 1/4"),
    ("f(1) + 1", 1, "'f' is not a function; the functions are abs"),
    ("z(1) of Heun for y'=-y, y(0)=1, h=0.1", 1, "'z' is not a readout of run; the readouts are y"),
    ("total energie of RK4", 1, "'total energie' is not a known fact or readout"),
    ("phase- error of RK4 h=1 t=1", 1, "'phase' is not the id of a published value"),
    ("rk4 y'=y y(0)=1 h=1 y(1) rk4", 23, "time starts at 0"),
]


@pytest.mark.parametrize(("question", "column", "reason"), REFUSED)
def test_what_is_said_of_a_question_that_lacks_something(question, column, reason):
    require_refusal(question, column, reason)


LACKING = {
    "largest error of Heun h=0.1 t=2": " on q'=v, v'=-q, q(0)=1, v(0)=0, energy=(q^2+v^2)/2",
    "one step of RK4": " h=1/2 : q", "RK4 with h = 0.1": " N=10 : q", "RK4 with h = 0.1 at t = 1?": " : q",
    "10 steps of Euler": " h=0.1 : q", "run rk4": " h=0.1 t=1 : q", "run rk4 : v": " h=0.1 t=1 : v",
    "a step of Heun with h=0.1 on y'=-y, y(0)=1": " : y", "local error of Heun": " h=1/2", "exact t=1": " : q",
    "RK4 y'=-y, y(0)=1": " h=0.1 t=1 : error", "y' = 2, y(0)=1": " with rk4 h=0.1 t=1 : error",
    "run rk4 problem=pendulum h=0.1 t=1": " : y0", "run rk4 lambda=-2 h=0.1": " N=10 : error",
    "RK4 error of y'=-y, y(0)=1": " h=0.1 t=1", "exact solution": " t=10 : q", "phase error of RK4 t=1": " N=10",
    "error of ab2 with h=0.1 at t=1 on y'=-y, y(0)=1": " started=rk4",
}  # fmt: skip


@pytest.mark.parametrize("question", LACKING)
def test_a_question_that_lacks_something_is_shown_with_it_ready_to_be_asked(question):
    with pytest.raises(QuestionError) as caught:
        value(question)
    asked = f"{question.rstrip('?').partition(' :')[0]}{LACKING[question]}"
    assert caught.value.reason.endswith(f"; ask for example: {asked}")
    assert value(asked).is_number


def test_a_part_of_a_longer_question_that_lacks_something_is_not_completed():
    with pytest.raises(QuestionError, match=r"needs a readout after a colon; the readouts are [a-z, _.0-9]*$"):
        value("order of 'BDF 2' + RK4 h=1 t=1")


def test_what_an_expression_may_mean_is_shown_with_the_method_of_the_question():
    for name in some(AMBIGUOUS_FACTS, 50):
        for asked, method in {"RK4": "RK4", "'my m.toml' with t=1": "'my m.toml'", "gravity": "METHOD"}.items():
            with pytest.raises(QuestionError) as caught:
                value(f"{name.replace('_', ' ')} of {asked}")
            meant = AMBIGUOUS_FACTS[name].replace("METHOD", method)
            assert caught.value.reason == f"{name} may mean {meant}: say which"


def test_what_an_expression_may_mean_is_a_question_that_is_answered():
    settings = r"(?: y'=-y, y\(0\)=1,)?(?: [hzt]=[-0-9/]+,?(?= ))*(?: : \w+)?"
    pasted = re.compile(rf"(?<!driftproof )\b[a-z]\w+ METHOD{settings}")
    meant = {name for meaning in AMBIGUOUS_FACTS.values() for name in pasted.findall(meaning)}
    for example in some(sorted(meant), 8):
        method = "symplectic Euler" if example.startswith("invariant") else "RK4"
        found = value(example.replace("METHOD", method))
        assert found.is_number or found.exact_text


def test_other_words_lead_to_names_that_there_are_and_hide_none():
    readouts = {*RUN_READOUTS, *PROBLEM_READOUTS}
    assert [name for name in some(READOUT_WORDS.values()) if name not in readouts] == []
    known = {*FACTS, "exact", "step", "run"}
    assert [name for name in some(FACT_WORDS.values()) if name.partition(":")[0] not in known] == []
    assert [name for name in some([*FACT_WORDS, *AMBIGUOUS_FACTS, *READOUT_WORDS]) if name in FACTS] == []
