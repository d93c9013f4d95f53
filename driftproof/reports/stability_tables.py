"""What is proved and seen of the stability of methods, as tables, and the problems as a list."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import inf

from driftproof.numeric.reference_errors import FOLLOWS
from driftproof.support.plain_text import Json, table, with_digits

DIGITS = 6
# The words before the number of steps with which the fastest decay along a solution is stable.
STABLE_FROM = ", stable from"
# Characters of an exact number that is shown in a table.
_LONGEST_EXACT = 24
# Said of a step that `numeric.steps.implicit` finds past a singular matrix.
_ANOTHER_BRANCH = (
    "another branch: in the step to that t the root found of the stage equations is not the one that continues the\n"
    "solution as h grows from 0, but one behind a singular matrix; of the continued root the error may be another"
)


def stability_text(answer: Json) -> str:
    """The answer as tables: how far steps stay stable, then each run, then what is expected."""
    applying = [entry for entry in answer["methods"] if "refused" not in entry]
    refused = [entry for entry in answer["methods"] if "refused" in entry]
    tables = [part(answer, applying) for part in (_limits_text, _runs_text, _expected_text) if applying]
    reasons = [f"{entry['method']} does not apply: {entry['refused']}" for entry in refused]
    starts = [f"first values of {each['method']}: steps of {each['started']}" for each in applying if "started" in each]
    claims = [f"{each['method']}: {line}" for each in applying for line in each.get("claims", ())]
    return "\n\n".join(filter(None, [answer["title"], *tables, "\n".join([*starts, *claims]), *reasons]))


def _limits_text(answer: Json, entries: Sequence[Json]) -> str:
    if not answer["linear"]:
        rows = [["method", "N", "largest tried"]]
        for entry in entries:
            rows.append([entry["method"], str(entry["fewest_steps"] or "none"), str(entry["looked_up_to"])])
        said = f"the error at the end is below {FOLLOWS} of the solution's size; with N - 1, 2(N - 1), ... not always"
        title = f"Observed: with N steps, 2N, 4N, ... {said}"
        proofs = f"\n\n{answer['proofs']}" if "proofs" in answer else ""
        return f"{title}\n\n{table(rows, right=(1, 2))}{proofs}{_decay_text(entries)}"
    rows = [["method", "proved: bounded for", "observed over 2^48 steps", "R(oo)"]]
    for entry in entries:
        seen = _seen_text(
            entry["seen"], by_rounding=entry["limit"] == "oo", in_blocks=_may_be_in_blocks(entry["limit"])
        )
        rows.append([entry["method"], limit_text(entry), seen, _short(entry["at_infinity"]) or "none"])
    notes = ["observed: the powers of the float step's matrix, in balanced units, stay below 1e9"]
    if any("again" in entry["seen"] for entry in entries):
        notes.insert(0, "proved: for every h from 0 on; what is bounded again beyond is only observed")
    if any("started" in entry for entry in entries):
        notes.append("R(oo): of a multistep method the size of the largest root of sigma")
    notes += [answer["proofs"]] if "proofs" in answer else []
    return "\n".join(["The step sizes h whose powers stay bounded\n", f"{table(rows)}\n", *notes])


def _decay_text(entries: Sequence[Json]) -> str:
    """The fastest decay along the solution, and which methods follow it with fewer steps than it is stable for."""
    seen = [(entry["method"], entry["decay"]) for entry in entries if "decay" in entry]
    if not seen:
        return ""
    rate, t = (with_digits(float(seen[0][1][name]), 3) for name in ("rate", "t"))
    short = any(entry["fewest_steps"] for entry in entries if "decay" in entry)
    late = "with fewer steps growth may have had no time to show, and a longer run may be lost"
    needed = ", ".join(f"{each['stable_from']} on with {key}" for key, each in seen)
    return (
        f"\n\nBut the fastest decay along the solution, at t = {t}, is that of y' = -{rate} y, which is stable from "
        f"N = {needed};\n{late if short else 'that many were not tried'}"
    )


def _short(number: str | None) -> str | None:
    """A long fraction as a decimal."""
    return number if number is None or len(number) <= _LONGEST_EXACT else with_digits(float(Fraction(number)), DIGITS)


def limit_text(entry: Json) -> str:
    """The step sizes for which powers are proved to be bounded."""
    limit = entry["limit"]
    if limit in ("0", "oo"):
        return {"0": "no small h", "oo": "every h > 0"}[limit]
    if "refused" in limit:
        return f"not decided: {limit['refused']}"
    exact = limit["exact"] if limit["exact"] and len(limit["exact"]) <= _LONGEST_EXACT else None
    digits, _, power = limit["decimal"].partition("e")
    digits = digits.rstrip("0").rstrip(".") if "." in digits else digits
    few = digits if len(digits) <= 12 else f"{digits[:12]}..."
    decimal, shown = (f"{x}e{power}" if power else x for x in (digits, few))
    return f"h {'<=' if entry['attained'] else '<'} {shown if exact in (None, decimal) else f'{exact} = {shown}'}"


def _may_be_in_blocks(limit: Json) -> bool:
    """True if growth at small h is none of the method: these are proved, or left open for a Jordan block alone."""
    return limit != "0" and ("refused" not in limit or "Jordan block" in limit["refused"])


def _seen_text(seen: Json, *, by_rounding: bool = False, in_blocks: bool = False) -> str:
    low, high = float(seen["bounded"]), float(seen["grows"])
    if not low and in_blocks:
        return "not seen: equal eigenvalues that act on each other grow far before they vanish"
    if high == inf:
        return f"up to {with_digits(low, 4)}, the largest tried"
    if by_rounding:
        return f"up to {with_digits(low, 4)}, where rounding grows"
    again = f" from {' to '.join(with_digits(float(h), 4) for h in seen['again'])}" if "again" in seen else ""
    if low:
        return f"up to {with_digits(low, 10)}{f', again{again}' if again else ''}"
    return f"growth at {with_digits(high, 4)}, the smallest tried{f'; bounded{again}' if again else ''}"


def _runs_text(answer: Json, entries: Sequence[Json]) -> str:
    verdicts = {True: "yes", False: "no"}
    rows = [["method", "h", "steps", *(["bounded?", "factor"] if answer["linear"] else []), "result at t"]]
    for entry in entries:
        for run in entry["runs"]:
            proved = [verdicts.get(run["bounded"], "not decided"), _factor_text(run)] if answer["linear"] else []
            rows.append([entry["method"], f"{float(run['h']):.6g}", str(run["steps"]), *proved, _outcome(run)])
    size = float(answer["size"])
    reached = f"whose largest norm is {with_digits(size, 3)}" if size else "which is 0 throughout: no error is small"
    notes = f"error: the Euclidean distance from the solution at t, {reached}"
    notes += f"\n{answer['kinks']}" if "kinks" in answer else ""
    if any("another_branch" in run for entry in entries for run in entry["runs"]):
        notes += f"\n{_ANOTHER_BRANCH}"
    if answer["linear"]:
        largest = f"the eigenvalue of largest modulus, {answer['stiffest']}"
        notes += f"\nbounded?: proved, for exactly this h; factor: growth per step for {largest}"
    return f"{table(rows, right=(2,))}\n\n{notes}"


def _factor_text(run: Json) -> str:
    """The decimal, or the difference of the factor from 1 if the decimal is 1; and what grows if it is another part."""
    if "grows" in run:
        shown = (
            _factor_text({name: each[name] for name in ("factor", "factor_less_one")}) for each in (run, run["grows"])
        )
        return f"{next(shown)}, but {next(shown)} for {run['grows']['eigenvalue']}"
    decimal, rest = run["factor"].get("decimal", "not decided"), run["factor_less_one"]
    if rest is None or Fraction(decimal) != 1:
        return str(decimal)
    return f"1 {'-' if rest.startswith('-') else '+'} {rest.lstrip('-')}"


def _outcome(run: Json) -> str:
    if run["failed_after"] is not None:
        return f"ends at step {run['failed_after']}: {run['remark']}"
    if run["error"] is None:
        return "finite at t, but its error overflows binary64: lost"
    size = f"below {run['below']}" if "below" in run else with_digits(float(run["error"]), 3)
    error = f"error {size}" + (f" of {run['only']}, its start" if "only" in run else "")
    error += ", larger than the solution: lost" if run["lost"] else ""
    return f"{error}; {run['another_branch']}" if "another_branch" in run else error


def _expected_text(_: Json, entries: Sequence[Json]) -> str:
    methods_of_sentence: dict[str, list[str]] = {}
    for entry in entries:
        if entry["expected"]:
            methods_of_sentence.setdefault(entry["expected"], []).append(entry["method"])
    lines = [f"{', '.join(methods)}: {sentence}" for sentence, methods in methods_of_sentence.items()]
    return "Expected\n\n" + "\n".join(lines) if lines else ""


def problems_text(listed: Sequence[Json]) -> str:
    """The problems listed by `problems_json`, as a table."""
    kinds = {"linear": "linear", "stiff": "stiff", "second_order": "q'' = F(q)"}
    shown = [", ".join(words for name, words in kinds.items() if entry[name]) for entry in listed]
    rows = [[entry["problem"], kind, entry["title"]] for entry, kind in zip(listed, shown, strict=True)]
    return table([["problem", "kind", "title"], *rows])
