"""Which steps a method can take on a problem: verdicts as proved beside what runs show, and refusals with reasons."""

import json
import math
import re
from fractions import Fraction

import pytest
from flint import arb, fmpq

import driftproof
from driftproof.methods.multistep import Multistep
from driftproof.methods.schemes import RungeKutta
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.reports import user_problem
from driftproof.reports.stability import behaviour
from driftproof.reports.stability_tables import stability_text
from driftproof.symbolic.linear.systems import SystemFacts
from tests.looping import exactly


@pytest.fixture
def stability(answer):
    """stability(problem, methods, *step sizes): what the JSON says of each method."""
    ask = lambda problem, keys, *h: ("stability", problem, "--methods", keys, *(w for x in h for w in ("--h", x)))
    return lambda *words: json.loads(answer(*ask(*words), "--format", "json"))["methods"]


def test_limits_proved_and_seen_stand_side_by_side(answer):
    out = answer("stability", "stiff_oscillator", "--methods", "rk4,symplectic_euler,radau_iia2", "--h", "1/400")
    assert "h <= sqrt(2)/500 = 0.0028284271..." in out
    assert "h < 1/500 = 0.002" in out
    assert re.search(r"\nradau_iia2 +every h > 0 +up to \S+, the largest tried ", out)
    assert re.search(r"\nrk4 .* up to 0\.002828427\d+ ", out)


def test_a_run_on_another_branch_is_told_and_one_that_follows_or_has_one_root_is_not():
    """Backward Euler by h = 3 ends at 0, by 3/10 at 1; y' = y is as far past the singular matrix, but it is linear."""
    well = {"rates": ["y0 - y0^3"], "start": ["1/10"], "end": 30}
    found = driftproof.stability(well, "backward_euler,bdf2", [3, "3/10"])
    told = [run.get("another_branch") for entry in found["methods"] for run in entry["runs"]]
    assert told == ["another branch from t = 3 on", None, None, None]
    assert str(found).count("another branch") == 2
    assert "another branch" not in str(driftproof.stability(well | {"rates": ["y0"]}, "backward_euler", 3))


@pytest.mark.parametrize(
    ("rate", "said"),
    [
        (
            "-2*pi*y0",
            r"\nrk4 +h <= 0\.4432932385\.\.\. +up to 0\.4432932386 [^~]*\nProved with pi = 3\.141592653589793, the",
        ),
        ("-sqrt(2)*y0", r"\nrk4 +1 +16384\nback.*\n\nLinear, but nothing is proved: that takes solutions"),
        ("-1000000000000*y0", r"\nbackward_euler +every h > 0 +up to 1\.\d+, the largest tried"),  # up to t and more
    ],
)
def test_a_proof_says_of_which_numbers_it_is_and_a_linear_problem_why_it_has_none(rate, said):
    """2.785293563405/(2 pi) = 0.443293238...; what is looked at goes to the end of the problem, t = 1."""
    found = str(driftproof.stability({"rates": [rate], "start": [1], "end": 1}, "rk4,backward_euler", 1))
    assert re.search(said, found)


def test_a_search_that_took_long_is_not_made_again(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    logistic = {"rates": ["y0 - y0^2"], "start": ["1/2"], "end": 4}
    first = str(driftproof.stability(logistic, "rk4"))
    assert [*tmp_path.iterdir()] == []
    monkeypatch.setattr(user_problem, "LONG", 0.0)
    driftproof.stability(logistic, "rk4")
    monkeypatch.setattr("driftproof.reports.stability.fewest_steps", lambda *_: 1000)
    assert str(driftproof.stability(logistic, "rk4")) == first
    found = driftproof.stability(logistic | {"end": 5}, "rk4")
    assert found["methods"][0]["fewest_steps"] == 1000, "twin: another problem"


def test_so_many_steps_are_run_and_no_more():
    said = "1000001 steps to t = 1000001 are too many; at most 1000000 are run"
    with pytest.raises(ValueError, match=said):
        driftproof.stability({"rates": ["-y0"], "start": [1], "end": 1000001}, "rk4", 1)
    idle = {"rates": ["0*y0"], "start": [1], "end": 1000000}
    assert driftproof.stability(idle, "forward_euler", 1)["methods"][0]["runs"][0]["steps"] == 10**6


def test_powers_of_ten_are_not_cut_off(answer):
    out = answer("stability", "dahlquist_1e6", "--methods", "rk4,forward_euler", "--h", "1/4")
    assert "h <= 2.7852935634...e-6" in out
    assert "h <= 1/500000 = 2e-6" in out


def test_a_factor_close_to_one_says_on_which_side_it_is(answer):
    """|R|^2 is 1 - 10^-12/72 + ... for RK4 at 1/100, and (27/50)^2 + (101/120)^2 for Dormand and Prince's at 1."""
    keys = "rk4,dormand_prince54,velocity_verlet"
    out = answer("stability", "harmonic_oscillator", "--methods", keys, "--h", "1/100", "--h", "1")
    rows = {tuple(line.split()[:3]): line for line in out.splitlines()}
    assert "yes       1 - 6.9e-15" in rows["rk4", "0.01", "1000"]
    assert "no        1 + 1.4e-6" in rows["dormand_prince54", "1", "10"]
    assert "yes       1.00000" in rows["velocity_verlet", "1", "10"]


def test_the_part_that_grows_is_named_where_the_factor_is_that_of_another():
    """Forward Euler at 1/50: R = 0 at -50, and |1 + i/500|, 1 + 2e-6, at the slow pair; RK4 damps both."""
    both = {"rates": ["-50*y0", "-y2/10", "y1/10"], "start": [1, 1, 0], "end": 10}
    shown = str(driftproof.stability(both, "forward_euler,rk4", "1/50"))
    assert re.search(r"forward_euler +0\.02 +500 +no +2\.08167e-17, but 1 \+ 2\.0e-6 for ± 0\.1i +error", shown)
    assert re.search(r"rk4 +0\.02 +500 +yes +0\.375000 +error", shown)
    assert shown.endswith("growth per step for the eigenvalue of largest modulus, -50")


def test_the_limit_seen_is_the_first_h_that_fails_and_what_is_bounded_above_it_is_told(answer, tmp_path):
    """Two springs of frequencies 1 and √3; for RK4 there is no h above the limit."""
    (tmp_path / "springs.toml").write_text(
        'rates = ["y2", "y3", "-2*y0+y1", "y0-2*y1"]\nstart = [1, 0, 0, 0]\nend = 20'
    )
    out = answer("stability", str(tmp_path / "springs.toml"), "--methods", "pefrl,rk4")
    assert re.search(r"\npefrl +h < 1.7259595000... +up to 1.725959500, again from 2.024 to 2.989 +none\n", out)
    assert re.search(r"\nrk4 +h <= 2\*sqrt\(6\)/3 = 1.6329931618... +up to 1.632993162 +oo\n", out)


@pytest.mark.slow
def test_a_factor_that_no_ball_rounds_ends_no_report(monkeypatch, answer, tmp_path):
    """R = (1 - w²)/2 at -1 ± wi is short: 3/8 - 1 is half a unit of two digits; and what is not decided is one cell."""
    (tmp_path / "spiral.toml").write_text('rates = ["y1", "-5/4*y0 - 2*y1"]\nstart = [1, 0]\nend = 10')
    asked = ("stability", str(tmp_path / "spiral.toml"), "--methods", "heun2,rk4", "--h", "1,1/2")
    out = answer(*asked)
    assert "yes       0.375000  error 0.000169" in out
    known = SystemFacts.stiffest_factor
    tie = lambda text: lambda: arb(text) + (arb(2).sqrt() ** 2 - 2)  # no precision makes the ball a point
    monkeypatch.setattr(SystemFacts, "stiffest_factor", lambda found, h: tie(fmpq(910001, 2000000)))
    assert "yes       0.4550005  error 0.000169" in answer(*asked)
    monkeypatch.setattr(SystemFacts, "stiffest_factor", lambda found, h: tie(0) if h == 1 else known(found, h))
    out = answer(*asked)
    assert "heun2   1       10  yes       not decided  error 0.000169" in out
    assert re.search(r"heun2 +0.5 +20 +yes +0\.60676\d +error", out)


@pytest.mark.slow
def test_a_run_that_ends_well_by_luck_does_not_follow(stability):
    """Backward Euler's one step ends close enough; what 512 steps meet at the jump, Newton's method does not solve."""
    (entry,) = stability("van_der_pol_1e3", "backward_euler", "2")
    assert not entry["runs"][0]["lost"]
    assert entry["fewest_steps"] is None


def test_a_run_that_has_come_to_rest_does_not_follow_a_pendulum(stability):
    damped, right = stability("pendulum", "backward_euler,rk4", "20")
    assert not damped["runs"][0]["lost"]  # no error is larger than the solution
    assert damped["looked_up_to"] // 4 < damped["fewest_steps"] > 512  # found by compiled runs
    assert right["fewest_steps"] < 64


def test_a_step_that_is_not_solved_is_named_in_a_few_words(answer):
    out = answer("stability", "robertson", "--methods", "radau_iia2", "--h", "1000000000")
    assert "ends at step 1: not solved after 128 iterations" in out
    assert "residual" not in out


def test_verdict_is_of_the_double_that_is_run(stability):
    (entry,) = stability("dahlquist_1e3", "forward_euler", "1/500")
    (run,) = entry["runs"]
    assert Fraction(float(run["h"])) > Fraction(1, 500)  # the double nearest to 1/500 is above it
    assert run["bounded"] is False
    assert entry["attained"] is True


def test_every_method_does_what_is_proved(stability):
    """Where the powers are bounded the run ends within the solution's size or its transient; else it leaves it."""
    keys = "forward_euler,rk4,backward_euler,implicit_midpoint,radau_iia2,sdirk2,gauss2"
    verdicts = set()
    for entry in stability("dahlquist_1e3", keys):
        assert [run["steps"] for run in entry["runs"]] == [10, 100, 1000]
        for run in entry["runs"]:
            verdicts.add(run["bounded"])
            assert run["lost"] is not run["bounded"], (entry["method"], run["h"])
    assert verdicts == {True, False}


def test_a_non_finite_run_is_never_silent(stability):
    (entry,) = stability("prothero_robinson", "rk4", "1/10")
    (run,) = entry["runs"]
    assert run["failed_after"] == 17
    assert run["error"] is None
    assert run["lost"]


def test_a_method_that_does_not_apply_says_why(answer):
    out = answer("stability", "dahlquist_1", "--methods", "rk4,symplectic_euler,stormer2,ars222")
    assert "symplectic_euler does not apply: " in out
    assert "stormer2 does not apply: stormer2 is for y'' = F(y)" in out
    assert "ars222 does not apply: ars222 is an IMEX method" in out


def test_steps_that_end_before_growth_shows_are_told_by_the_fastest_decay_and_a_longer_run_is_lost():
    """Nearly on the slow curve y0 = y1 + sin(y1)/200, what is left of the decay at the rate 200 grows unseen."""
    rod = {"rates": ["-200*(y0 - y1) + sin(y1)", "1 - y1"], "start": ["1.0042", "1"], "end": "1/4"}
    rk4, implicit = (entry for entry in driftproof.stability(rod, ["rk4", "backward_euler"])["methods"])
    assert "decay" not in implicit
    assert rk4["fewest_steps"] < rk4["decay"]["stable_from"] == math.ceil(50 / 2.785293563405282)
    assert (rk4["decay"]["rate"], rk4["decay"]["t"]) == ("200.0", "0.0")
    text = str(driftproof.stability(rod, ["rk4", "backward_euler"]))
    assert "at t = 0.00, is that of y' = -200 y, which is stable from N = 18 on with rk4;" in text
    longer = driftproof.stability(rod | {"end": "2"}, ["rk4"])["methods"][0]
    assert longer["fewest_steps"] / 8 > rk4["fewest_steps"]
    stiff = rod | {"rates": ["-2e7*(y0 - y1) + sin(y1)", "1 - y1"]}
    text = str(driftproof.stability(stiff, ["rk4", "backward_euler"]))
    assert "-2.00e7 y, which is stable from N = 1795143 on with rk4;\nthat many were not tried\n" in text
    pages = [driftproof.report(each, methods=["rk4"]).html for each in (rod, stiff)]
    assert f"from {rk4['fewest_steps']} steps on, stable from 18 on" in pages[0]
    assert "not with 1048576 steps, stable from 1795143 on" in pages[1]


def test_an_order_that_an_own_table_claims_and_lacks_is_told(tmp_path):
    table = tmp_path / "mine.toml"
    rows = 'family = "runge_kutta"\nA = [[0, 0], ["1/2", 0]]\nb = [{}]\nclaimed_order = 2\n'
    for weights, told in (("0, 1", False), ("1, 0", True)):
        table.write_text(rows.format(weights))
        text = str(driftproof.stability("dahlquist_1", [str(table), "rk4"]))
        assert ("\n\nmine: claimed order 2, has 1" in text) is told


def test_methods_of_several_states_and_with_a_jacobian_have_limits_factors_and_starts(answer, stability):
    out = answer(
        "stability", "dahlquist_1e3", "--methods", "adams_bashforth2,bdf2,adams_moulton2,rodas4", "--h", "1/500"
    )
    for line in (
        r"adams_bashforth2  h <= 1/1000 = 0.001 +up to 0.001000000000 +oo",
        r"bdf2 +every h > 0 +up to \S+, the largest tried +0",
        r"adams_moulton2 +h <= 3/500 = 0.006 +up to 0.006000000000 +1.71652",
        r"adams_bashforth2 +0.002 +500 +no +2.41421 +error \S+, larger than the solution: lost",
        r"bdf2, rodas4: decays for every h > 0; components much faster than h vanish",
        r"first values of bdf2: steps of radau_iia2",
    ):
        assert re.search(rf"^{line}", out, re.M), line
    spring = {"rates": ["y1", "-100*y0"], "start": [1, 0], "end": 2}
    out = str(driftproof.stability(spring, "bdf3,bdf6", "1/2"))
    assert re.search(r"\nbdf3 +no small h +up to 7\.16\S+e-5, again from 0\.1936 +0\n", out)
    assert re.search(r"\nbdf6 .* up to 0\.08431381\d+, again from 1\.757 +0\n", out)
    assert "error 3.72 of radau_iia4, its start" in out  # in four steps, none of which is of six values
    far = Multistep("far", "", 0, "", rho=(2, -3, 1), sigma=(-1, 0, 0))
    assert "far: is not zero-stable" in str(driftproof.stability("dahlquist_1e3", far))
    trapezoid = Multistep("trapezoid", "", 2, "", rho=(-1, 1), sigma=(Fraction(1, 2), Fraction(1, 2)))
    assert behaviour(trapezoid, PROBLEMS["dahlquist_1e3"]) == "a_stable"
    assert [entry.get("started") for entry in stability("kaps", "bdf3,rodas4")] == ["radau_iia3", None]
    assert [entry["fewest_steps"] for entry in stability("kaps", "bdf3,rodas4")] == [3, 1]


# HIRES takes as long as all the others together: eight implicit equations a step, in up to 512 steps. Its answer is of
# the same kind as Robertson's, another nonlinear stiff problem; the long tier asks for it.
EVERY = [pytest.param(key, marks=pytest.mark.long if key == "hires" else ()) for key in PROBLEMS]


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("key", EVERY)
def test_every_problem_is_answered(answer, key):
    assert PROBLEMS[key].title in answer(
        "stability", key, "--methods", "backward_euler", "--h", str(PROBLEMS[key].t / 8)
    )


def test_errors_stand_beside_the_size_of_the_solution(answer):
    """On q'' = -10^6 q from (1, 0) the velocity is up to 1000; at t = 10 it is 305.6, of which nothing is left."""
    out = answer("stability", "stiff_oscillator", "--methods", "backward_euler", "--h", "1/100")
    (size,) = re.findall(r"whose largest norm is (\d+)$", out, re.MULTILINE)
    assert 900 < int(size) <= 1000
    assert "error 306\n" in out


@pytest.mark.slow
def test_the_size_of_a_solution_is_not_that_at_times_a_whole_period_of_its_force_apart():
    """y = sin 2πt is 0 at the reference's times; rk4 in 1000 steps was lost. The solution 0 has no size."""
    forced = {"rates": "-3*(y - sin(2*pi*t)) + 2*pi*cos(2*pi*t)", "start": 0, "end": 20}
    found = driftproof.stability(forced, "rk4", "1/50")
    assert abs(float(found["size"]) - 1) < 1e-4
    assert "lost" not in str(found)
    assert "lost" in str(driftproof.stability(forced, "rk4", 2))
    assert "which is 0 throughout: no error is small" in str(driftproof.stability({**forced, "rates": "-y"}, "rk4"))


def test_how_many_steps_follow_the_solution_stands_in_the_text_or_that_none_do():
    found = driftproof.stability("pendulum", "rk4", 2).data
    (entry,) = found["methods"]
    for fewest, shown in exactly(2, ((entry["fewest_steps"], str(entry["fewest_steps"])), (None, "none"))):
        entry["fewest_steps"] = fewest
        assert re.search(rf"^rk4 +{shown} +16384$", stability_text(found), re.MULTILINE)


def test_what_is_not_decided_has_its_reason_and_no_verdict():
    """R = 1 at every h, on x''' = -x'' - 5x' - x, whose real eigenvalue alone is decided."""
    idle = RungeKutta("idle", "Idle", 0, "x", ((Fraction(0),),), (Fraction(0),), (Fraction(0),))
    found = driftproof.stability({"rates": ["y1", "y2", "-y0 - 5*y1 - y2"], "start": [1, 0, 0], "end": 1}, [idle], h=1)
    assert "bits do not tell whether" in found["methods"][0]["runs"][0]["bounded"]
    lines = [line.split() for line in str(found).splitlines() if line.startswith("idle ")]
    assert [" ".join(line[1:5]) for line in lines] == ["not decided: R(hλ)R(hμ) =", "1 1 not decided"]


def test_a_state_too_far_from_the_solution_for_floats_is_lost_and_no_crash():
    found = driftproof.stability("dahlquist_1e3", "rk4").data
    found["methods"][0]["runs"][0] |= {"failed_after": None, "error": None, "lost": True}
    assert "finite at t, but its error overflows binary64: lost" in stability_text(found)
    rest = {"rates": ["-100*y0", "0"], "start": [1, 1], "end": 1}
    assert "0.909091   error below 5.0e-20\n" in str(driftproof.stability(rest, "backward_euler"))


def test_a_switch_at_a_known_time_is_told_below_the_runs():
    switched = {"rates": ["heaviside(1/3 - t) - y0"], "start": [0], "end": 1}
    shown = str(driftproof.stability(switched, "backward_euler", h="1/10"))
    assert "\nf has kinks or jumps at t = 0.333333: a method keeps its order only if its steps end there" in shown
