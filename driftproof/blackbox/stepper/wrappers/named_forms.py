"""Steps some of whose names say nothing: what such an argument is shows by what a step calls, and what it returns."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from itertools import permutations
from typing import Any

import numpy as np

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.wrappers.function_wrappers import gradients_of
from driftproof.blackbox.stepper.wrappers.wrapper_parts import (
    TRIAL_ARGUMENTS,
    arguments_by_role,
    called_with,
    is_before,
    kind_by_names,
    plain_role,
)

# The names under which arguments that say nothing are tried: the state, the velocity, the position, the right-hand side
# and the time; of more arguments than these, too many things may be meant.
_TRIED, _MOST = ("y", "v", "q", "f", "t"), 2


def named_forms(step: Callable[..., Any]) -> Iterator[Callable[..., Any]]:
    """Yield the step with usual names that it may be: of two gradients, or of one or two unusual names.

    >>> def euler(rhs, t, c, dt):
    ...     return c + dt * rhs(t, c)
    >>> [*inspect.signature(next(named_forms(euler))).parameters]
    ['rhs', 't', 'y', 'dt']
    """
    names = [] if inspect.isclass(step) else calling.names_with_step(step) or []
    if gradients := gradients_of(names):
        given = arguments_by_role([each for each in names if each not in gradients], calling.FORCE)
        if {"q", "v", "h"} <= {*given.values()} and len(given) + len(gradients) == len(names):
            yield called_with(step, names, {**gradients, **given}, ["force", "q", "v", "h"])
    unknown, known = [each for each in names if not _is_known(each)], [*map(plain_role, names)]
    if not unknown:  # of two velocities one is another thing
        unknown = [each for each in names if plain_role(each) == calling.VELOCITY][:1]
    missing = [each for each in _TRIED if each not in names and (each in "yvq" or plain_role(each) not in known)]
    tried = unknown != [] and len(unknown) <= _MOST and calling.size_name(names) != ""
    for usual in permutations(missing, len(unknown)) if tried else ():
        if "f" in usual or calling.FUNCTION in known:
            form = renamed(step, names, dict(zip(unknown, usual, strict=True)))
            if "t" not in usual or not _depends_on_t(form):
                yield form


def renamed(step: Callable[..., Any], names: Sequence[str], usual: Mapping[str, str]) -> Callable[..., Any]:
    """The step whose arguments have these usual names in place of their own."""
    own = {each: usual.get(each, each) for each in names}
    return called_with(step, names, own, [*own.values()])


def _depends_on_t(form: Callable[..., Any]) -> bool:
    """True if what it takes for the time changes its answer, though no force or slope depends on that: it is none."""
    names = calling.names_with_step(form) or []
    given = arguments_by_role(names, kind_by_names(names))
    with suppress(Exception):
        ends = []
        for t in (0.0, 0.5):
            known = {key: copy(x) for key, x in TRIAL_ARGUMENTS.items()} | {"t": t, "0.0": t}
            ends.append(form(*(known[given[each]] for each in names)))
        return not all(np.array_equal(x, y) for x, y in zip(*map(np.atleast_1d, ends), strict=True))
    return False


def _is_known(name: str) -> bool:
    """True if the name says what an argument is, or that it is a number of its own or of an earlier time."""
    word = calling.word_of(name)
    masses = (*calling.UNIT_PARAMETERS, *calling.MASSES, *calling.INVERSE_MASSES)
    known = word in (*masses, *calling.COUNTS, "neq", "nvar", "dim") or word.endswith("out")
    return known or is_before(name) or calling.role_of(name, calling.ROLES) is not None
