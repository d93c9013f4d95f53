"""The tables of docs/language.md: questions, and the answers that they have now."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from driftproof.texts.questions.answer import OutputOptions, format_answer
from driftproof.texts.questions.decimals import PLAIN, ROUNDING_POLICIES, Style
from driftproof.texts.questions.evaluate import value

RUNS = (
    "rk4.first_step.q",
    "quarter_cycle.state_error",
    "step rk4 h=1/2 : q",
    "step rk4 h=1/2 from 1,0 : energy_change",
    "step rk4 h=1/2 : k2.v",
    "step symplectic_euler h=2 N=5 from 1,0 : v",
    "run symplectic_euler h=1/4 t=10 : phase_error deg",
    "run symplectic_euler N=40 t=10 : phase_error turns",
    "run rk4 h=0.25 t=10 from 0,1 : state_error",
    "run forward_euler h=1/4 N=40 : evaluations",
    "run rk4 N=1000000000 t=10 : state_error",
    "run implicit_midpoint h=1/4 t=10 : energy_change",
    "run sdirk_order_2 at 1/4 h=1/4 t=10 : energy",
    "exact t=10 : q",
    "exact t=1/2 from 3/5,-2 : v",
)
FACTS = (
    "order rk4",
    "order_fails rk4 : residual",
    "a_stable radau_iia2",
    "stability_function radau_iia2",
    "stability_function rk4 z=-1",
    "energy_multiplier rk4",
    "energy_multiplier rk4 h=1/4",
    "one_step_matrix velocity_verlet : M_vq",
    "determinant symplectic_euler",
    "invariant symplectic_euler",
    "invariant symplectic_euler h=1/2 from 1/2,1",
    "imaginary_limit rk4",
    "real_limit rk4",
    "real_limit backward_euler",
    "error_constant rk4",
    "dispersion rk4",
    "dispersion rk4 : coefficient",
    "sector sdirk4 : degrees",
    "ssp_coefficient ssprk33",
    "principal_error rk4 : squared_norm",
    "order sdirk_order_2 at (1/2 + sqrt(3)/6)",
    "a_stable sdirk_order_2",
    "stages rk4",
)
ARITHMETIC = (
    "(step rk4 h=1/2 : q) - (exact t=1/2 : q)",
    "percent(run forward_euler h=1/4 t=10 : energy_change, 1/2)",
    "ratio(run rk4 h=1/2 t=10 : state_error, run rk4 h=1/4 t=10 : state_error)",
    "log2(ratio(run rk4 h=1/80 t=10 : state_error, run rk4 h=1/160 t=10 : state_error))",
    "log10(run rk4 h=1/1000 t=10 : state_error)",
    "2 * imaginary_limit rk4",
    "(energy_multiplier forward_euler h=1/4) ** 40",
    "-23/48 + 2**-3",
)
BOUNDS = (
    "roundoff symplectic_euler h=1/4 : qq",
    "roundoff symplectic_euler h=1/4 sharp : qq",
    "roundoff rk4 h=1/4 from 1,0 : v",
    "roundoff rk4 h=1/4 : c",
)
# A number, the places that it is rounded to, and why it is here.
ROUNDED = (
    ("1/8", 2, "a tie"),
    ("3/8", 2, "a tie, the other way"),
    ("-5/2", 0, "a tie below zero"),
    ("0.615", 2, "a tie that the double nearest to it is not"),
    ("1.005", 2, "the same, below the tie"),
    ("-1/1000", 2, "a negative number that rounds to 0"),
    ("sqrt(2)", 2, "no tie"),
)
REFUSED = (
    "step rk4 h=1/2 : speed",
    "step rk5 h=1/2 : q",
    "run rk4 h=1/3 t=1/2 : q",
    "run gauss2 h=1/4 t=10 : evaluations",
    "energy_multiplier symplectic_euler",
    "run rk4 h=1e-9 t=1e12 : q",
    "2 ** 99",
    "1 / (1 - 1)",
    "__import__('os')",
    "(run rk4 h=1/4 t=10 : phase_error deg) + (run rk4 h=1/4 t=10 : phase_error rad)",
)


def answers(questions: tuple[str, ...]) -> list[list[str]]:
    """Each question with what `driftproof value` prints."""
    options = OutputOptions(None, None, PLAIN)
    rows = [[f"`{question}`", format_answer(value(question), options, "text")] for question in questions]
    return [["question", "answer"], *rows]


def roundings() -> list[list[str]]:
    """Numbers under every policy, "refused" where a tie is no answer."""
    rows = [
        [f"`{question}`", str(places), *(_rounded(question, places, name) for name in (None, *ROUNDING_POLICIES)), why]
        for question, places, why in ROUNDED
    ]
    return [["number", "places", "none named", *ROUNDING_POLICIES, ""], *rows]


def _rounded(question: str, places: int, rounding: str | None) -> str:
    try:
        return value(question).places(places, Style(rounding))
    except ValueError:
        return "refused"


def refusals() -> list[list[str]]:
    """Questions without an answer, each with the one line that says why."""
    rows = []
    for question in REFUSED:
        try:
            value(question)
        except ValueError as error:
            rows.append([f"`{question}`", str(error).partition(", ")[2]])
    return [["question", "the line, after the question"], *rows]


QUESTIONS_OF = {"runs": RUNS, "facts": FACTS, "arithmetic": ARITHMETIC, "bounds": BOUNDS}
TABLES: dict[str, Callable[[], list[list[str]]]] = {
    **{name: partial(answers, questions) for name, questions in QUESTIONS_OF.items()},
    "roundings": roundings,
    "refusals": refusals,
}
