"""Errors to plant in the certificates, of every class: Coq must refuse each with the proof of the right statement."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator

from proofs.kernel.certificates import Certificate, all_theorems
from proofs.kernel.coq import Theorem
from proofs.printed import ROWS

# Theorem -> what its statement says, and what a wrong one says instead.
PLANTED: tuple[tuple[str, str, str], ...] = ()


def mutants() -> list[tuple[Certificate, Theorem]]:
    """Every right theorem that has one, with each of its mutants."""
    by_name = {certificate.theorem.name: certificate for certificate in all_theorems()}
    planted = [*PLANTED, *_last_digits()]
    return [(by_name[name], _changed(by_name[name].theorem, right, wrong)) for name, right, wrong in planted]


def _changed(theorem: Theorem, right: str, wrong: str) -> Theorem:
    if theorem.statement.count(right) != 1:
        raise ValueError(f"{theorem.name} does not hold {right!r} once: {theorem.statement}")
    return dataclasses.replace(theorem, statement=theorem.statement.replace(right, wrong))


def _last_digits() -> Iterator[tuple[str, str, str]]:
    """Each printed number with its last digit one off."""
    names = {certificate.theorem.name for certificate in all_theorems()}
    for row in ROWS:
        if row.claim in names:
            digits = re.search(r"\d(?=(e|$))", row.text)
            assert digits is not None
            place = digits.start()
            wrong = f"{row.text[:place]}{(int(row.text[place]) + 1) % 10}{row.text[place + 1 :]}"
            for relation in ("==", "≈", "="):
                if f" {relation} {row.text})" in _statement(row.claim):
                    yield row.claim, f" {relation} {row.text})", f" {relation} {wrong})"
                    break


def _statement(name: str) -> str:
    return next(found.theorem.statement for found in all_theorems() if found.theorem.name == name)
