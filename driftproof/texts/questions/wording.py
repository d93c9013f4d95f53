"""Synonyms of readouts, facts and settings that questions may use.

Several words form one name with "_" between them: "phase error" is phase_error, "A-stable" is a_stable.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from functools import cache

from driftproof.methods.formulas.expression_tree import NAME, Token

# Names of the error of one step: as the head of a question they mean a step, other errors a run.
LOCAL = ("local_error", "local_truncation_error", "one_step_error")
PER_STEP = "_per_step"
_NAMES = (
    *("q", "v", "h", "state_error", "phase_error", "largest_error", "relative_error"),
    *("energy", "energy_change", "relative_energy_change", "largest_energy_change", "steps", "evaluations"),
)

# Readout or synonym -> readout. Before "of METHOD" it asks for a readout of a run.
READOUT_WORDS = {
    **dict(zip(_NAMES, _NAMES, strict=True)),
    **dict.fromkeys(("error", "errors", "global_error", *LOCAL), "state_error"),
    **dict.fromkeys(("max_error", "maximum_error", "maximal_error"), "largest_error"),
    **dict.fromkeys(("energy_error", "energy_drift"), "energy_change"),
    **dict.fromkeys(("largest_energy_error", "largest_energy_drift", "max_energy_error"), "largest_energy_change"),
    **dict.fromkeys(("function_evaluations", "number_of_evaluations"), "evaluations"),
    **dict.fromkeys(("number_of_function_evaluations", "evaluations_of_f", "f_evaluations"), "evaluations"),
    **{"number_of_steps": "steps", "step_size": "h", "position": "q", "velocity": "v"},
    **{"exact.position": "exact.q", "exact.velocity": "exact.v"},
}

AXIS = ("real", "imaginary")
_STABLE = ("stability", "stability_limit", "stability_interval", "stability_boundary", "interval_of_stability")
# Synonym -> fact, with ":" and the part that it means.
FACT_WORDS = {
    **dict.fromkeys(("amplification_factor", "growth_factor", "stability_polynomial", "r"), "stability_function"),
    **{f"{of}_{what}": f"{of}_limit" for of in AXIS for what in _STABLE},
    **dict.fromkeys(("r_at_infinity", "stability_function_at_infinity", "damping_at_infinity"), "limit_at_infinity"),
    **dict.fromkeys(("order_of_convergence", "convergence_order", "convergence_rate", "order_of_accuracy"), "order"),
    **dict.fromkeys(("order_of_error_estimate", "order_of_estimate", "error_estimate_order"), "estimate:order"),
    **dict.fromkeys(("order_of_embedded_method", "order_of_embedded_formula"), "embedded_order"),
    **dict.fromkeys(("number_of_stages", "stage_number", "stage_count"), "stages"),
    **dict.fromkeys(("dispersion_error", "phase_lag"), "dispersion"),
    **dict.fromkeys(("angle", "alpha", "stability_angle", "angle_of_stability"), "sector:degrees"),
    **dict.fromkeys(("ssp_constant", "radius_of_absolute_monotonicity"), "ssp_coefficient"),
    **dict.fromkeys(("modified_energy", "shadow_hamiltonian", "shadow_energy"), "modified_hamiltonian"),
    **dict.fromkeys(("algebraic_stability", "algebraically_stability"), "algebraically_stable"),
    **dict.fromkeys(("principal_error_norm", "principal_error_constant"), "principal_error:squared_norm:sqrt"),
    **{"energy_factor": "energy_multiplier", "dissipation_error": "dissipation", "stiff_decay": "l_stable"},
    **dict.fromkeys(("one_step", "first_step", "single_step"), "step"),
    **{head: head for head in ("step", "run", "exact")},
    **dict.fromkeys(("solution", "exact_solution", "true_solution"), "exact"),
    **dict.fromkeys(("reversible", "time_reversible", "self_adjoint"), "symmetric"),
}

# Ambiguous name -> what it may mean, as error messages show it.
_LINES = "real_limit METHOD (largest hλ on y' = -λy) or imaginary_limit METHOD (largest hω on y' = iωy)"
LIMITS = f"{_LINES}; for a problem of your own there is driftproof stability mine.toml"
# Of these the limit of h on a problem that the question states: the head of such a question.
LARGEST_STEP, STEP_LIMITS = "largest_step", re.compile("h_limit|.*step.*|.*_h|stability_limit")
_KEPT = "energy_multiplier METHOD (1 if energy is kept), invariant METHOD (what is), run METHOD h=1 t=9 : energy_change"
_TABLEAU = "one of its entries, such as b1 METHOD, a21, bhat1 or c2; `driftproof facts METHOD --all` shows more"
_OBSERVED = "ratio(run METHOD h=1/10 t=1 : error, run METHOD h=1/20 t=1 : error), or log2 of it, the observed order"
_ROUNDOFF = "the command driftproof roundoff METHOD --h 1/4 (bounds on the rounding of a step)"
_MOST = ("largest", "max", "maximal", "maximum")
_SIZES = ("h", "step", "step_size", "time_step")
# Of a splitting, whose orbit is no circle: the angle of a step depends on where it begins.
PHASE_PER_STEP = (
    "phase_error_per_step may mean dispersion METHOD (leading phase error of a step, in radians), or "
    "step METHOD h=1/10 : phase_error (of the step from (1, 0), whose orbit is no circle): say which"
)
AMBIGUOUS_FACTS = {
    **dict.fromkeys(("limit", "stability_limit", "stability_interval", "absolute_stability_interval"), LIMITS),
    **dict.fromkeys(("interval_of_stability", "interval_of_absolute_stability", "cfl", "cfl_number"), LIMITS),
    **dict.fromkeys(("cfl_limit", "cfl_condition", "h_limit", "step_limit"), LIMITS),
    **{f"{most}{stable}_{h}": LIMITS for most in (*_MOST, "critical") for stable in ("", "_stable") for h in _SIZES},
    **dict.fromkeys(("stability_region", "stability_bound", "time_step_limit", "step_size_limit"), LIMITS),
    **dict.fromkeys(("conserve_energy", "preserve_energy", "energy_conservation"), _KEPT),
    **dict.fromkeys(("butcher_tableau", "tableau", "coefficients", "b_coefficients", "weights", "nodes"), _TABLEAU),
    **dict.fromkeys(("roundoff", "rounding_error", "roundoff_error"), _ROUNDOFF),
    **dict.fromkeys(("energy_growth", "energy_growth_per_step"), _KEPT),
    **dict.fromkeys(("observed_order", "experimental_order", "error_ratio", "ratio_of_errors"), _OBSERVED),
}

# The equations of a question, its settings behind them, and the number that a setting has.
STATED = re.compile(r"\b\w+''?(?:\(t\))? ?=.*")
_SETTINGS = re.compile(r",?(?: with| at)? (?<!\w)[htN] ?= ?[0-9./]+")
_GIVEN = r"(?<!\w){} ?= ?([0-9]+(?:\.[0-9]+|/[1-9][0-9]*)?)"

# Synonym -> setting.
OTHER_SETTINGS = {
    **{"steps": "N", "n": "N", "dt": "h", "T": "t"},
    **dict.fromkeys(("step", "stepsize", "step_size", "timestep", "time_step"), "h"),
    **dict.fromkeys(("h_lambda", "hlambda"), "z"),
}

# Words that are skipped between the parts of a question.
SAY_NOTHING = {"of", "with", "on", "after", "to", "up", "for", "and", "until", "by", "using", "over", "in", "the"}
SAY_NOTHING |= {"does", "do", "have", "need", "needs", "needed", "required", "take", "reach"}
# Words that are skipped before a question and within a name.
ASKING = {"what", "is", "the", "a", "an", "how", "many", "large", "does", "do", "are", "has", "have", "value", "slope"}
ASKING |= {"approximate", "calculate", "compute", "find", "solve", "solve_ivp", "scipy"}
# Steps may be counted in words; a period is refused, because it is no whole number of steps.
_COUNT_WORDS = ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
WORDED_COUNTS = {word: n for n, word in enumerate(_COUNT_WORDS, start=1)}
PERIODS = {"period", "periods", "cycle", "cycles"}
COUNTED = {"step", "steps", *PERIODS}
# Word that has no place in a question -> the question that answers it.
_COUNTED = "how many steps reach an error is what driftproof work-precision tells; with h or N a run tells its error"
ASKED_ELSEWHERE = {
    **dict.fromkeys(("error", "tol", "tolerance", "reach"), _COUNTED),
    **dict.fromkeys(("started", "starting", "starts"), "what starts a multistep method is said as in started=rk4"),
    "stiff": "for the order on stiff problems, ask for stage_order, as in stage_order gauss4",
}
# Coefficients of a tableau: a21, a_10_2, b1, bhat1 of the embedded weights, c3; and slopes such as k1.q.
COEFFICIENT = re.compile(r"(?P<a>a)(?:_?([1-9])([1-9])|_([1-9][0-9]?)_([1-9][0-9]?))|(?P<row>bhat|b|c)_?([1-9][0-9]?)")
SLOPE = re.compile(r"k[1-9][0-9]{0,2}(?:\.[A-Za-z][A-Za-z0-9]*)?")


def meanings(name: str, method: str, question: str) -> str:
    """What an ambiguous name may mean, ready to be asked of the question's method, problem, time and step sizes."""
    meant = AMBIGUOUS_FACTS[name].replace("METHOD", method)
    if stated := STATED.search(question):
        meant = meant.replace(" h=", f" {_SETTINGS.sub('', stated[0]).strip(' ,')}, h=").replace(" t=", ", t=")
    times, sizes = (re.findall(_GIVEN.format(x), question) for x in "th")
    sizes += [str(Fraction(x) / 2) for x in sizes[:1]]
    for usual, own in [*zip(["t=1"], times, strict=False), *zip(["h=1/10", "h=1/20"], sizes, strict=False)]:
        meant = re.sub(rf"{usual}\b", f"{usual[:2]}{own}", meant)
    return meant


@cache
def names_that_ask() -> frozenset[str]:
    """Every name that a question may begin with."""
    from driftproof.symbolic.facts import FACTS, ON_REQUEST, OTHER_FACTS

    per_step = (f"{name}{PER_STEP}" for name in READOUT_WORDS)
    facts = (*FACTS, *ON_REQUEST, *OTHER_FACTS)
    return frozenset((*facts, *FACT_WORDS, *AMBIGUOUS_FACTS, *READOUT_WORDS, *per_step))


def longest_name(tokens: Sequence[Token]) -> tuple[str, int]:
    """The longest of these names that the tokens begin with, and its number of tokens; ("", 0) if there is none.

    Spaces or hyphens separate its words; case and the words of ASKING, such as "the", are ignored.
    """
    found, words = ("", 0), list[str]()
    for i, token in enumerate(tokens):
        if token.kind == NAME:
            words += [token.text.lower()] if token.text not in ASKING else []
            if (name := "_".join(words)) in names_that_ask() or COEFFICIENT.fullmatch(name) or SLOPE.fullmatch(name):
                found = name, i + 1
        elif token.text != "-" or not i or tokens[i - 1].end != token.column or tokens[i + 1].column != token.end:
            break
    return found
