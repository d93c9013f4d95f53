"""What an answer of named parts, such as a record, holds: position and velocity, time, state and error, by name."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from types import SimpleNamespace

import numpy as np

from driftproof.blackbox.findings import NotANumber
from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.states.array_adapters import Foreign, as_array

# The relative error allowed to a clock, which may be a number of 11 bits.
CLOCK_ERROR = 2.0**-8
# Endings of the names of new values.
_NEW = re.compile("_?(new|next|out|1)$")


def parts_of(record: Foreign) -> Mapping[str, Foreign]:
    """The fields of a dataclass, a named tuple or a namespace by name, or a mapping as it is; nothing for others."""
    if isinstance(record, SimpleNamespace):
        return vars(record)
    if hasattr(record, "_asdict"):
        return dict(record._asdict())
    if dataclasses.is_dataclass(record):
        return {field.name: getattr(record, field.name) for field in dataclasses.fields(record)}
    return record if isinstance(record, Mapping) else {}


def named_parts(answer: Foreign) -> Mapping[str, Foreign]:
    """The parts of a record, or of any other object that is no array, by name."""
    return parts_of(answer) or ({} if hasattr(answer, "__array__") else getattr(answer, "__dict__", {}))


def part_pair(answer: Foreign) -> Foreign:
    """Position and velocity of a record, by name or else as its fields in order; any other answer unchanged."""
    return named_pair(answer) or [*parts_of(answer).values()] or answer


def named_pair(answer: Foreign) -> list[Foreign]:
    """The position and the velocity in an answer of named parts; nothing unless both are there."""
    roles = _by_role(answer, (calling.POSITION, calling.VELOCITY, calling.TIME))
    found = [roles.get(role) for role in (calling.POSITION, calling.VELOCITY)]
    return [] if any(part is None for part in found) else found


def _by_role(answer: Foreign, roles: Sequence[str]) -> dict[str | None, Foreign]:
    """The parts of an answer by the roles that their names are in use for: in each, one that is said to be new."""
    found: dict[str | None, Foreign] = {}
    for name, x in sorted(named_parts(answer).items(), key=lambda part: not _NEW.search(str(part[0]))):
        word = str(name)
        found.setdefault(calling.role_of(word, roles) or calling.role_of(_NEW.sub("", word), roles), x)
    return found


def run_parts(answer: Foreign) -> Foreign:
    """What a run returns by names as (qs, vs), or as (ts, ys); any other answer as it is.

    >>> run_parts({"x": [1.0, 0.5], "v": [0.0, -1.0], "t": [0.0, 0.5]})
    ([1.0, 0.5], [0.0, -1.0])
    """
    return tuple(named_pair(answer)) or in_parts(answer)


def clock_of(record: Foreign) -> Foreign:
    """The time in a record, one number; None if it has none."""
    for name, x in parts_of(record).items():
        if role_in_state(str(name)) == calling.TIME:
            with suppress(NotANumber):
                return x if as_array(x).size == 1 else None
    return None


def in_parts(answer: Foreign) -> Foreign:
    """The time, the state and the error that an answer of named parts holds, as a tuple; any other answer as it is.

    >>> in_parts({"y_new": 1.5, "err": 0.25, "nfev": 6})
    (1.5, 0.25)
    """
    roles = _by_role(answer, (calling.STATE, calling.TIME))
    parts = [roles[each] for each in (calling.TIME, calling.STATE) if each in roles]
    errors = [x for name, x in named_parts(answer).items() if "err" in str(name).lower()][:1]
    return (*parts, *errors) if calling.STATE in roles else answer


def goes_on(before: float, after: float, h: float) -> bool:
    """True if a clock stands still or goes on by h."""
    return bool(np.isclose(after - before, (0.0, h), rtol=CLOCK_ERROR, atol=CLOCK_ERROR * abs(before)).any())


def role_in_state(name: str) -> str | None:
    """The role that the name of a part has in a state of the oscillator: position, velocity, time, or none."""
    return calling.role_of(name, (calling.POSITION, calling.VELOCITY, calling.TIME))
