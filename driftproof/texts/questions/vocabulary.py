"""Every name that a question may use."""

from __future__ import annotations


def vocabulary() -> str:
    """The heads with their readouts, the facts, the functions, the families and the ids, a line or more for each."""
    from driftproof.methods.families import FAMILIES
    from driftproof.texts.questions.arithmetic import FUNCTIONS
    from driftproof.texts.questions.bounds import ENTRIES, GROWTH, OF_STATE
    from driftproof.texts.questions.facts import NAMES
    from driftproof.texts.questions.runs import EXACT_READOUTS, READOUTS, UNITS
    from driftproof.texts.values.published import published_values

    parts = {
        "readouts of step and run": [*READOUTS, "k1.q", "k1.v", "..."],
        "readouts of exact": [*EXACT_READOUTS],
        "readouts of roundoff": [*OF_STATE, *ENTRIES, GROWTH],
        "units of phase_error": [*UNITS],
        "facts": [*NAMES],
        "functions": [*FUNCTIONS],
        "families, with at": [f"{key} ({family.parameter})" for key, family in FAMILIES.items()],
        "published values": [*published_values()],
    }
    lines = [f"{title}:\n  {', '.join(names)}" for title, names in parts.items()]
    return "\n".join([*lines, "methods:\n  `driftproof methods` lists them"])
