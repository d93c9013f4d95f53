"""Steps some of whose names say nothing: what such an argument is shows by what a step calls, and what it returns."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from driftproof.blackbox.stepper import calling_conventions as calling
from driftproof.blackbox.stepper.function_wrappers import gradients_of
from driftproof.blackbox.stepper.wrapper_parts import (
    arguments_by_role,
    called_with,
    is_before,
    plain_role,
)

# The names under which the one argument that says nothing is tried: the state, the velocity, the position.
_TRIED = ("y", "v", "q")


def named_forms(step: Callable[..., Any]) -> Iterator[Callable[..., Any]]:
    """Yield the step with usual names that it may be: of two gradients, or of one unusual name.

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
    unknown = [each for each in names if not _is_known(each)]
    if calling.size_name(names) and any(plain_role(each) == calling.FUNCTION for each in names):
        twice = [each for each in names if plain_role(each) == calling.VELOCITY] if not unknown else []
        for name, usual in ((x, each) for x in (unknown if len(unknown) == 1 else twice[:1]) for each in _TRIED):
            if usual not in names:
                yield renamed(step, names, {name: usual})


def renamed(step: Callable[..., Any], names: Sequence[str], usual: Mapping[str, str]) -> Callable[..., Any]:
    """The step whose arguments have these usual names in place of their own."""
    own = {each: usual.get(each, each) for each in names}
    return called_with(step, names, own, [*own.values()])


def _is_known(name: str) -> bool:
    """True if the name says what an argument is, or that it is a number of its own or of an earlier time."""
    word = calling.word_of(name)
    masses = (*calling.UNIT_PARAMETERS, *calling.MASSES, *calling.INVERSE_MASSES)
    known = word in (*masses, *calling.COUNTS, "neq", "nvar", "dim") or word.endswith("out")
    return known or is_before(name) or calling.role_of(name, calling.ROLES) is not None
