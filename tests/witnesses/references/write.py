"""The decimals of every reference, computed anew: closed forms in balls, and solutions that are enclosed.

`python -m tests.witnesses.references.write [KEY...]` writes numeric/problems/digits.json, in minutes a key. The times
stand in the file; a new problem has its end there first, without a state, and gets the eighths of it.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from pathlib import Path

from flint import arb, ctx

from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.problem import EXACT, Problem
from driftproof.reports.user_problem import enclosed_reference
from driftproof.symbolic.algebra.certified import CertifiableReal, significant
from tests.witnesses.references.closed_forms import CLOSED_FORMS

PLACES = 20
LEAST_EXPONENT = 400
Row = list[str]
DIGITS = Path(__file__).parents[3] / "driftproof/numeric/problems/digits.json"


def computed(problem: Problem, times: Sequence[Fraction]) -> list[Row]:
    """The states at the times as decimals, by the evidence that the reference of the problem claims."""
    if problem.reference.evidence == EXACT:
        return [closed_form(problem.key, t) for t in times]
    return list(map(list, enclosed_reference(problem.field, problem.start, times).states))


def closed_form(key: str, t: Fraction) -> Row:
    state = cache(lambda _bits: CLOSED_FORMS[key](t))
    return [_decimal(lambda i=i: state(ctx.prec)[i]) for i in range(len(state(ctx.prec)))]


def _decimal(value: CertifiableReal) -> str:
    """Correctly rounded to PLACES digits; what is far below any format that runs here is 0e-400."""
    with ctx.workprec(64):
        if callable(value) and value().abs_upper() < arb(10) ** -LEAST_EXPONENT / 2:
            return f"0e-{LEAST_EXPONENT}"
    return significant(value, PLACES)


def written(found: dict[str, dict[str, list[str]]]) -> str:
    """The file, one line a state."""
    blocks = []
    for key in sorted(found):
        lines = ",\n".join(f"  {json.dumps(t)}: {json.dumps(state)}" for t, state in found[key].items())
        blocks.append(f" {json.dumps(key)}: {{\n{lines}\n }}")
    return "{\n" + ",\n".join(blocks) + "\n}\n"


def main(keys: Sequence[str]) -> None:
    found = json.loads(DIGITS.read_text(encoding="utf-8"))
    for key in keys:
        if key not in PROBLEMS:
            raise SystemExit(f"{key} is not in driftproof/numeric/problems/catalogue.py")
        if PROBLEMS[key].reference.evidence == EXACT and key not in CLOSED_FORMS:
            raise SystemExit(f"{key} has no closed form in tests/witnesses/references/closed_forms.py")
    for key in keys or PROBLEMS:
        times = PROBLEMS[key].reference.times
        times = times if len(times) > 1 else tuple(times[0] * k / 8 for k in range(1, 9))
        found[key] = dict(zip(map(str, times), computed(PROBLEMS[key], times), strict=True))
        print(key, flush=True)
    DIGITS.write_text(written(found), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
