"""What a study tells: who is cheapest, who is dominated, what was lost or left out; the same bytes in JSON and CSV."""

import re
from dataclasses import replace
from fractions import Fraction
from math import atan, inf
from types import SimpleNamespace

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.problems.catalogue import problem_named
from driftproof.numeric.reference_errors import Size
from driftproof.numeric.work_precision.curves import Curve, Point, curve_of
from driftproof.numeric.work_precision.timing import Timing, seconds_text
from driftproof.numeric.work_precision.verdicts import Priced, dominators
from driftproof.reports import user_problem
from driftproof.reports.work_precision import report, study_files
from driftproof.reports.work_precision.study import Measured, measure, timing_name
from driftproof.symbolic.claimed_orders import stated_orders
from tests.reports.studies import study, unheard


def test_a_problem_without_a_title_is_named_once():
    asked = study("rk4", problem="dahlquist_1")
    asked = replace(asked, problem=replace(asked.problem, title=asked.problem.key))
    assert report.study_text(asked, measure(asked, None, unheard)).startswith("dahlquist_1\n\n")


def test_tables_say_who_is_cheapest_who_is_dominated_and_what_does_not_apply():
    asked = study("rk4", "velocity_verlet", "ark324", problem="dahlquist_1")
    shown = report.study_text(asked, measure(asked, None, unheard))
    assert "before (so velocity_verlet: code that keeps it makes one less in each step);\nJacobian" in shown
    assert shown.partition(" (dahlquist_1)\n")[1]
    assert "  none         does not apply: " in shown
    assert "  none         does not apply: ark324 is an IMEX method" in shown
    assert "Least work for an error at the end of at most 1e-6, each cost by itself (* the least)" in shown
    assert "no times (compiled) for rk4: numba is not installed" in shown
    assert [len(re.findall(f"(?m)^{line}", shown)) for line in ("-:", "Evaluations ", "lost")] == [1, 1, 0]
    assert re.search(r"^rk4 +4 +4\.\d\d \(", shown, re.MULTILINE)


def test_errors_as_large_as_the_solution_are_lost_and_decide_nothing():
    def curve(key, *errors):
        points = [Point(str(8 << i), 8 << i, {"state": Size(e, e)}, scale=1.0) for i, e in enumerate(errors)]
        return Curve(key, key, 1, points)

    measured = Measured({"a": curve("a", 1e9, 0.1), "b": curve("b", 1e8, 0.01), "c": curve("c", 1.0)})
    shown = report.study_text(study("rk4"), measured)
    assert re.search(r"(?m)^Dominated: .*\n\nmethod +evaluations\s+a +by b$", shown)
    assert "\nlost: no run has an error below the size of the solution.\n" in shown
    cost = {"evaluations": report.priced(measured, "evaluations")}
    assert cost["evaluations"] == {"a": [Priced(0.1, 16)], "b": [Priced(0.01, 16)], "c": []}
    assert dominators(cost["evaluations"]) == {"a": ["b"]}
    met = [row[1] for row in report.goal_rows(measured, [*cost], 1e-3)[1:]]
    assert met == ["not met: 0.1", "not met: 0.01", "not met: lost"]


def three_curves():
    """One whose end is luckier than its way, one that is as good all the way, and one that was not run further."""

    def curve(key, *points, doubt=0.0):
        sizes = lambda e: {name: Size(*e) for name in (("state", "energy") if key == "steady" else ("state",))}
        made = [Point(str(n), n, sizes(e), doubt=doubt, scale=1.0, steps=n) for n, *e in points]
        return Curve(key, key, 1, made)

    lucky, steady = curve("lucky", (8, 1e-2, 1e-1), (16, 1e-4, 1e-2)), curve("steady", (20, 1e-4, 1e-4))
    floor = curve("floor", (8, 1e-3, 1e-3), (16, 1e-3, 1e-3), doubt=2e-3)
    return Measured({each.key: each for each in (lucky, steady, floor)})


def test_the_least_work_by_the_largest_error_stands_below_that_by_the_error_at_the_end():
    asked = replace(study("rk4"), wanted=[2.5e-4])
    shown = report.study_text(asked, three_curves())
    first = "For an error of at most 2.5e-4 at the end, lucky with h = 5/8, N = 16: 16 evaluations; "
    there, way = "largest error on the way 0.010; looked at 1 time\n", "steady with h = 1/2, N = 20: 20 evaluations"
    way += "; largest error of the energy on the way 0.00010; looked at 1 time"
    assert shown.startswith(f"{first}{there}For an error of at most 2.5e-4 on the way, {way}\n\n")
    both = report.study_text(replace(asked, wanted=[2e-2]), three_curves())
    floor = "floor with h = 5/4, N = 8: 8 evaluations; looked at 1 time"
    assert both.startswith(f"For an error of at most 2e-2 at the end and on the way, {floor}\n\n")
    goals = report.study_text(replace(asked, wanted=()), three_curves())
    assert "By the largest error on the way:" not in shown
    assert goals.count("By the largest error on the way: none of these runs") == 2
    assert shown.count("Least work for an error at the end of at most") == 1
    (found,) = study_files.errors_json(asked, three_curves())["least_work"]
    assert (found["goal"], found["final"]["curve"], found["largest"]["curve"]) == ("0.00025", "lucky", "steady")
    timed = three_curves()
    for key, setting, seconds in (("lucky", "16", 3e-6), ("steady", "20", 2e-6), ("floor", "16", 1e-6)):
        timed.timings[timing_name(key, "python", setting)] = Timing(samples=[seconds])
    end, quickest, way, again = report.study_text(asked, timed).splitlines()[:4]
    assert (f"{end}\n", way[:38]) == (f"{first}{there}", "For an error of at most 2.5e-4 on the ")
    steady = "In the least time (Python), steady with h = 1/2, N = 20: 2.00 µs; largest error on the way 0.00010; "
    assert quickest.startswith(steady), "that of this run, not of the one above"
    assert again == "In the least time (Python), the same run: 2.00 µs"
    timed.timings[timing_name("lucky", "compiled", "16")] = Timing(samples=[1e-6])
    assert "\nIn the least time (compiled), the same run: 1.00 µs\nFor" in report.study_text(asked, timed)
    none = report.study_text(replace(asked, wanted=[1e-9]), three_curves())
    assert none.startswith("For an error of at most 1e-9 at the end and on the way, none of these runs\n\n")


def test_a_run_is_recommended_only_if_all_finer_ones_are_as_good_but_for_rounding():
    """Radau's steps of a period of the force were right by chance; half the step had an error 24 times as large."""

    def found(*errors, doubt=0.0):
        sizes = [{"state": Size(e, e)} if e < inf else {} for e in errors]
        points = [Point(str(n), n, size, doubt, 1.0, steps=n) for n, size in enumerate(sizes, 1)]
        measured = Measured({"a": Curve("a", "a", 1, points)})
        rows, best = report.goal_rows(measured, ["evaluations"], 1e-3), report.least_work(measured, 1e-3, "final")
        return rows[1][1], best and best[1].steps

    assert found(1e-3, 2e-2, 1e-3, 1e-4) == ("3 *", 3)
    assert found(1e-3, 1e-3, 1e-3, 1e-4) == ("1 *", 1)
    unlike = ("met with N = 1, but not in finer runs", None)
    assert found(1e-3, 2e-2) == unlike
    assert found(1e-3, 3.2e-2, doubt=1e-3) == ("1 *", 1), (
        "what is no more than 32 times as large is said to be rounding"
    )
    assert found(1e-3, 3.3e-2, doubt=1e-3) == found(1e-3, inf, 1e-3, 2e-2) == unlike
    assert found(1e-3, inf, 1e-3, inf) == ("3 *", 3), "the last may be too long, one between is not as good"


def test_a_run_that_is_good_by_chance_and_an_order_that_is_not_settled_are_explained():
    def shown(*errors, **problem):
        sizes = [{"state": Size(e, e)} for e in errors]
        points = [Point(str(8 << i), 8 << i, size, 0.0, 1.0, steps=8 << i) for i, size in enumerate(sizes)]
        return report.study_text(study("rk4", **problem), Measured({"a": Curve("a", "a", 1, points)}))

    found = shown(1e-1, 1e-4, 2e-2, 1e-2)
    assert "met with N = 16, but not in finer runs" in found
    assert (
        "\nA coarser run that meets what finer ones miss may do so by chance, as where its error changes sign:" in found
    )
    assert "\na: order not settled: its last slopes lie a whole order or more apart" in found
    settled = shown(8e-1, 4e-1, 2e-1, 1e-1)
    assert "by chance" not in settled
    assert "order not settled" not in settled


def test_what_was_not_tried_is_not_said_to_be_not_met():
    measured = three_curves()
    met = [row[1] for row in report.goal_rows(measured, ["evaluations"], 1e-6)[1:]]
    assert met == ["not reached by N = 16: 1.0e-4", "not reached by N = 20: 1.0e-4", "not met: 0.001"]
    failed = [Point("8", None, remark="overflows", steps=8), Point("16", None, remark="not run: too long", steps=16)]
    overflows = Measured({key: Curve(key, key, 1, failed[i:]) for i, key in enumerate("ab")})
    assert [row[1] for row in report.goal_rows(overflows, ["evaluations"], 1e-6)[1:]] == [
        "not reached by N = 8: none",
        "-",
    ]
    shown = report.study_text(study("rk4"), measured)
    assert "Longer runs than those are not made: 1048576 steps, of implicit methods 1024, at most" in shown
    assert "Longer runs" not in report.study_text(replace(study("rk4"), wanted=[2e-4]), measured)


ERRORS = {0.0: "0", 0.001: "0.001", 99.4: "99", 100.0: "1.0e2", 0.00099: "9.9e-4", 1e-12: "1.0e-12"}
SECONDS = {1.0: "1.00 s", 0.999: "999 ms", 1e-3: "1.00 ms", 2e-6: "2.00 µs", 1e-6: "1.00 µs", 5e-8: "50.0 ns"}


def test_errors_have_two_digits_and_seconds_three_in_their_unit():
    found = [Curve("a", "A", 1, [Point("8", 8, {"state": Size(error, error)})]) for error in ERRORS]
    rows = report.order_rows(Measured({str(i): curve for i, curve in enumerate([*found, Curve("b", "B", 0, [])])}))
    assert [row[3] for row in rows] == ["least error", *ERRORS.values(), "none"]
    (row,) = report.order_rows(Measured({"a": found[5]}), digits=("0.1", "2.5e-9"))[1:]
    assert row[3] == "below 0.051"
    stated = stated_orders(replace(METHODS[key], claimed_order=claim) for key, claim in (("kutta3", 4), ("rk4", 0)))
    own = {key: Curve(key, "Mine", 0, []) for key in ("kutta3", "kutta3 controlled", "rk4", "scipy RK45")}
    orders = [row[1] for row in report.order_rows(Measured(own), stated=stated)]
    assert orders == ["order", "3, not 4 as claimed", "3, not 4 as claimed", "4", ""]
    assert {seconds: seconds_text(seconds) for seconds in SECONDS} == SECONDS


def test_the_least_cost_for_a_goal_has_a_star_and_one_that_is_not_known_is_over_the_limit():
    points = [Point(str(n), n, {"state": Size(e, e)}, steps=n) for n, e in ((8, 1e-2), (16, 1e-5))]
    timings = {"a | python | 8": Timing(1, [3e-3]), "b | python | 8": Timing(1, [2e-3])}
    measured = Measured({key: Curve(key, key, 1, points) for key in "abc"}, timings, {"a | python": 1, "b | python": 1})
    found = [[row[1] for row in report.goal_rows(measured, ["python"], goal)[1:]] for goal in (1e-2, 1e-3, 1e-5)]
    over = ["over the limit", "over the limit", "-"]
    assert found == [["3.00 ms", "2.00 ms *", "-"], over, over]
    assert [report.goal_rows(measured, ["evaluations"], goal)[1][1] for goal in (1e-3, 1e-6)] == [
        "16 *",
        "not reached by N = 16: 1.0e-5",
    ]
    timings = {"a | python | 16": Timing(1, [1e-3]), "b | python | 8": Timing(1, [2e-3])}
    of_others = report.goal_rows(replace(measured, timings=timings), ["evaluations", "python"], 1e-2)[1:]
    assert of_others == [["a", "8 *", "1.00 ms * (N = 16)"], ["b", "8 *", "2.00 ms"], ["c", "8 *", "-"]]


def test_neighbouring_points_of_one_remark_are_told_by_the_first_and_the_last():
    remarks = ["not finite", "not finite", "", "not finite", "", "not solved"]
    points = [Point(str(8 << i), None, {}, remark=remark, steps=8 << i) for i, remark in enumerate(remarks)]
    shown = report.study_text(study("rk4"), Measured({"rk4": Curve("rk4", "", 4, points)}))
    assert "rk4 at N = 8 to 16, 64: not finite" in shown
    assert "rk4 at N = 256: not solved" in shown


def test_every_cell_of_a_row_stands_below_its_name_and_the_head_says_how_exact_the_reference_is():
    """An ensemble's call integrates 512 states; the quartiles of 1, 2 and 4 ms are 1.5 and 3."""
    point, none = Point("8", 8, {"state": Size(0.1, 0.2, 3)}, 1e-9, steps=8), Point("16", None, remark="over", steps=16)
    timings = {"a | python | 8": Timing(1, [4e-3, 1e-3, 2e-3]), "a | ensemble | 8": Timing(1, [1.024])}
    found = Measured({"a": Curve("a", "A", 1, [point, none])}, timings, {}, {"a | compiled": "why"})
    sizes = ",".join(f"{x}_{which}" for x in ("state", "energy", "phase") for which in ("final", "largest", "looks"))
    costs = [f"{kind}_{what}" for kind in ("python", "ensemble") for what in ("minimum", "median", "spread")]
    assert study_files.csv_text(found).splitlines() == [
        f"curve,setting,evaluations,{sizes},doubt,remark,{','.join(costs)}",
        "a,8,8,0.1,0.2,3,,,,,,,1e-09,,0.001,0.002,0.75,0.002,0.002,",
        "a,16,,,,,,,,,,,0.0,over,,,,,,",
    ]
    head, remarks = (report.study_text(study("rk4"), found).split("\n\n")[i] for i in (1, -1))
    assert head.splitlines() == [
        "Reference exact: (cos t, -sin t), in ball arithmetic",
        "Half a unit of its last digits: 7.1e-21",
        "Rounding of the exact state, u |y(t)|: 1.1e-16; that of a run may be larger",
    ]
    assert remarks.startswith("a at N = 16: over\nno times (compiled) for a: why\nTimes are the least")
    assert "half of the spreads are below 75 %" in remarks


def test_timing_of_no_sample_is_an_infinite_cost_and_a_kind_never_called_none():
    point = Point("8", 8, {"state": Size(0.1, 0.1)}, steps=8)
    marked = {"a | python | 8": Timing(remark="too long")}
    measured = Measured({"a": Curve("a", "A", 1, [point])}, marked, {"a | python": 1.0})
    assert report.priced(measured, "python") == {"a": [Priced(0.1, inf)]}
    assert report.priced(measured, "compiled") == {"a": []}


def test_an_order_below_the_claim_is_order_reduction_on_stiff_problems_only():
    found = curve_of(METHODS["gauss2"], problem_named("prothero_robinson"), (20, 40, 80, 160))
    shown = [
        report.order_rows(SimpleNamespace(curves={"gauss2": found}), why)[1][-1] for why in ("order reduction", "")
    ]
    assert shown == ["below the claimed order 4: order reduction", "below the claimed order 4"]


def test_kinks_and_jumps_explain_orders_below_the_claim():
    stopped = {"rates": ["y1", "-y0 - 0.2*sign(y1)"], "start": [1, "1/4"], "end": "3/2"}
    problem = user_problem.problem_given(stopped)
    later = replace(problem.reference, changes=tuple(Fraction(k, 2) for k in range(7)))
    for reference, said in (
        (problem.reference, f" at t = {atan(0.25 / 1.2):.6g}:"),
        (later, " at t = 0, 0.5, 1, 1.5, 2 and 2 later times:"),
    ):
        assert user_problem.kinks_of(replace(problem, reference=reference)).startswith(f"f has kinks or jumps{said}")
    found = curve_of(METHODS["rk4"], problem, (20, 40, 80, 160, 320))
    assert found.order.median < 2
