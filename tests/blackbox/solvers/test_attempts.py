"""Where the estimate of a pair is 0, or the same for all steps of h, a solver's attempts show it without a law."""

from __future__ import annotations

import pytest

from driftproof.blackbox.solvers.attempts import of_another_estimate, settled_steps
from driftproof.blackbox.solvers.foreign_solver import ForeignSolver
from driftproof.blackbox.solvers.steps import read_steps
from tests.blackbox.solvers.planted_solvers import adaptive
from tests.looping import exactly

EXCHANGED = adaptive(estimate=lambda e: [e[0], e[2], e[1], e[3]])  # 1/9 and 1/12
TO_AND_FRO = adaptive("heun_euler21", exponent=2, safety=0.9, least=0.2, most=5.0, grows_after_rejection=True)
# 7571/16659 for 7571/16695
OF_A_TYPO = adaptive(
    "dormand_prince54", exponent=0.2, estimate=lambda e: [*e[:2], e[2] - 7571 / 16659 + 7571 / 16695, *e[3:]]
)
OF_FEW_LENGTHS = adaptive(changed=lambda factor, rejections: 4.0 if factor > 1 else 0.25)
LAWLESS = {"changed": lambda factor, rejections: factor * (1 + (1e4 * factor % 1) / 10)}
# The estimate where it is 0, where it is one of h alone, and whether steps go to and fro there.
CASES = {
    "right": (adaptive("dormand_prince54", exponent=0.2), "", "steps settle 2 times as long at 32 times", ""),
    "with memory": (adaptive("dormand_prince54", exponent=0.17, memory=0.04), "", "steps settle 2 times as long", ""),
    "of high order": (adaptive("verner87", exponent=1 / 8), "", "steps settle 1.9", ""),
    "of no law": (adaptive(**LAWLESS), "", "steps settle 1.97 times as long at 8 times", ""),
    "per unit of time": (adaptive("fehlberg45", exponent=1 / 4, per_unit=True), "", "steps settle 2.38 times", ""),
    "of the tolerance 1e-5": (adaptive(tolerances=lambda rtol, atol: (1e-5, 1e-8)), "", "", ""),
    "with weights exchanged": (EXCHANGED, "it makes 2215 calls of f on slopes of degree 1 in t", "", ""),
    "of a typo": (OF_A_TYPO, "it makes 30000 calls of f on slopes of degree 3 in t", "", ""),
    "to and fro": (TO_AND_FRO, "", "", "36 of 72 attempts are rejected, as with too large an exponent"),
}


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("name", CASES)
def test_an_estimate_shows_where_it_is_0_and_where_it_is_one_of_h_alone(name):
    solve, *words = CASES[name]
    subject = ForeignSolver(solve)
    steps = read_steps(subject)
    found = [of_another_estimate(subject, steps.pairs[0]), *settled_steps(subject, steps, steps.pairs[0])]
    for said, expected in exactly(3, zip(found, words, strict=True)):
        assert expected in said
        assert bool(said) is bool(expected) or name == "with weights exchanged", said
