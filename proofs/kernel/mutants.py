"""Errors planted in the certificates, of every class: Coq must reject each with the proof of the right statement."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator
from decimal import Decimal

from proofs.kernel.certificates import Certificate, all_theorems
from proofs.kernel.coq import Theorem
from proofs.printed import ROWS

# RK4 with its last two weights exchanged.
WRONG_WEIGHT = (
    "{| written_relation := [0]; low := 0; high := 0; denominator := 6; written_matrix := "
    "[[[0]; [0]; [0]; [0]]; [[3]; [0]; [0]; [0]]; [[0]; [3]; [0]; [0]]; [[0]; [0]; [6]; [0]]]; "
    "written_weights := [[1]; [2]; [1]; [2]] |}"
)
# Alexander's table with the smallest root of its cubic, 0.15898..., as its diagonal.
ANOTHER_ROOT = (
    "{| written_relation := [36; -54; 18]; low := (9539033999320592 # 10000000000000000)%Q; "
    "high := (9539033999320594 # 10000000000000000)%Q; denominator := 24; "
    "written_matrix := written_matrix alexander3; written_weights := written_weights alexander3 |}"
)
# Theorem, a part of its statement, and the wrong text that replaces the part.
PLANTED: tuple[tuple[str, str, str], ...] = (
    # a wrong sign, coefficient or power in an identity
    ("L033_L204", "(q + h * v, v - h * q) /\\ forward", "(q + h * v, v + h * q) /\\ forward"),
    ("L043_L205", "(1 - h ^ 2) * q", "(1 - h ^ 3) * q"),
    ("L059_L207", "h ^ 4 / 24) * q", "h ^ 4 / 25) * q"),
    ("L035_L036", "(1 + h ^ 2) * energy", "(1 - h ^ 2) * energy"),
    ("L051", "(v - (h - 1) * q)", "(v - (h + 1) * q)"),
    ("L052", "(q ^ 2 + v ^ 2 - h * q * v) / 2", "(q ^ 2 + v ^ 2 + h * q * v) / 2"),
    ("L162", "(2 - h ^ 2) * fst z1", "(2 + h ^ 2) * fst z1"),
    ("L176", "h ^ 6 / 72 + h ^ 8 / 576) * energy", "h ^ 6 / 72 + h ^ 8 / 575) * energy"),
    ("L183", "- (w ^ 2) * x", "- w * x"),
    # a bound or a limit that is a little off, a sign that turns
    ("L040", "1 < sqrt (1 + h ^ 2)", "2 < sqrt (1 + h ^ 2)"),
    ("L041", "(energy z))", "(2 * energy z))"),
    ("L055", "0 < h < 2", "0 < h < 3"),
    ("L056", "2 < h ->", "1 < h ->"),
    ("L062", "z <> (0, 0) ->", "z <> (1, 0) ->"),
    ("L065", "2 * sqrt 2 < h", "2 < h"),
    ("L146", "<= 4 / 3", "<= 13 / 10"),
    ("L163", "0 < h < 2 ->", "0 < h < 3 ->"),
    ("L174", "2 < h ->", "1 < h ->"),
    ("L175", "h <= 2 * sqrt 2", "h <= 3"),
    ("L177", "1 / 4 <= damping h < 1", "1 / 3 <= damping h < 1"),
    ("L178", "1 < damping h", "2 < damping h"),
    ("L179", "6369051672525773", "6369051672525772"),
    ("L180", "88.47 <", "88.48 <"),
    ("L182", "4 < (5 / 2) ^ 2 < 8", "4 < (5 / 2) ^ 2 < 6"),
    # a wrong rule of motion, a wrong unit, a wrong angle
    ("L018", "flow 0 = (1, 0)", "flow 0 = (0, 1)"),
    ("L020_L106", "= -1", "= 1"),
    ("L024", "- k * x tau / m", "k * x tau / m"),
    ("L027", "sqrt (m / k)", "sqrt (k / m)"),
    ("L094", "3 * n <> 10", "5 * n <> 10"),
    ("L061", "g (t + h)]", "g (t + h / 2)]"),
    ("L135", "< 180", "< 179"),
    ("L153", "degrees a +", "degrees (2 * a) +"),
    ("L158", "40 * atan", "39 * atan"),
    ("L159", "unwrapped + 360\n", "unwrapped + 180\n"),
    ("L160", "0 < s < PI", "0 < s < 2 * PI"),
    ("L165", "2 * INR n + 1", "2 * INR n - 1"),
    ("L240_L245", "4 * r ^ 2", "2 * r ^ 2"),
    ("L247", "sqrt 2", "sqrt 3"),
    # an order too high, a weight or an irrational coefficient that is wrong
    ("order_of_rk4", "rk4 4", "rk4 5"),
    ("order_of_cooper_verner8", "cooper_verner8 8", "cooper_verner8 9"),
    ("order_of_rk4", "rk4", WRONG_WEIGHT),
    ("order_of_implicit_midpoint", "implicit_midpoint 2", "implicit_midpoint 3"),
    ("L058", "length eight = 8", "length eight = 9"),
    # a method that is not A-stable in place of one that is, a wrong node
    ("a_stable_implicit_midpoint", "a_stable implicit_midpoint", "a_stable rk4"),
    ("a_stable_alexander3", "a_stable alexander3", f"a_stable {ANOTHER_ROOT}"),
    ("a_stable_sdirk4", "a_stable sdirk4", "a_stable sdirk4_embedded"),
    ("a_stable_gauss4", "70]", "71]"),
    # a method that is A-stable in place of one that is not
    ("not_a_stable_radau_i2", "[0; -2; 3]", "[1; -4; 3]"),
    ("not_a_stable_radau_i3", "[0; 3; -12; 10]", "[-1; 9; -18; 10]"),
    # a rounding bound that is one unit roundoff too small
    ("rounding_of_forward_euler_position", "fst 6", "fst 5"),
    ("rounding_of_forward_euler_velocity", "snd 6", "snd 5"),
    ("rounding_of_symplectic_euler_velocity", "snd 6", "snd 5"),
    ("rounding_of_rk4_velocity", "snd 80", "snd 8"),
    ("n_steps_of_symplectic_euler", "0 < h < 2 ->", "0 < h < 3 ->"),
    ("n_steps_of_symplectic_euler", "((1 + c) ^ N - 1)", "((1 + c) ^ N - 2)"),
    # the last bit of a float run
    ("float_run_compare_rk4", "da065dp", "da065ep"),
    # a convergence that is an order too fast, a leading error that is a little off
    ("L008", "h <= 2 * sqrt 2", "h <= 3"),
    ("L064", "K * h ^ 3 *", "K * h ^ 4 *"),
    ("L185", "one_step_error m (p + 1)", "one_step_error m p"),
    ("L186", "errs_by symplectic_euler 2", "errs_by symplectic_euler 1"),
    ("L187", "converges rk4 4", "converges rk4 5"),
    ("L188", "one_step_error rk4 5", "one_step_error rk4 6"),
    ("leading_errors", "(1 / 12)", "(1 / 13)"),
    # a limit, a factor or an end that is off by one in its last digit
    ("L039", "h <= 1.98029 ", "h <= 1.98030 "),
    ("L147", "0.250082", "0.250083"),
    ("L148", "48 *", "49 *"),
    ("L191", "15.999 *", "16.000 *"),
    ("L192", "15.9 *", "16.1 *"),
    ("L192", "1.19 *", "1.18 *"),
    ("L193", "2.785 *", "2.786 *"),
    ("L244", "290 *", "310 *"),
    ("L012", "7 / 2", "4"),
    ("L048", "- (1 / 2) * q", "1 / 2 * q"),
    ("local_errors", "- (v / 120)", "v / 120"),
    ("T01", "length sympy =", "1 + length sympy ="),
    ("T04", "h < 2)", "h < 3)"),
)


def mutants() -> list[tuple[Certificate, Theorem]]:
    """Pairs of a right theorem and one of its mutants."""
    by_name = {certificate.theorem.name: certificate for certificate in all_theorems()}
    planted = [*PLANTED, *_last_digits(), *_rounded_orders()]
    return [(by_name[name], _changed(by_name[name].theorem, right, wrong)) for name, right, wrong in planted]


def _changed(theorem: Theorem, right: str, wrong: str) -> Theorem:
    if theorem.statement.count(right) != 1:
        planted = f"the error planted in {theorem.name} replaces {right!r}, which has to stand once in its statement"
        raise ValueError(f"{planted}; it may be that the programs, or PLANTED, changed: {theorem.statement}")
    return dataclasses.replace(theorem, statement=theorem.statement.replace(right, wrong))


def _last_digits() -> Iterator[tuple[str, str, str]]:
    """Replacements that change the last digit of each printed number by one."""
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


def _rounded_orders() -> Iterator[tuple[str, str, str]]:
    """Replacements for each table of decimals: an order one too high, and either bound off by one in its last digit."""
    for found in all_theorems():
        if found.theorem.statement.startswith("has_rounded_order"):
            _, table, order, missed, exceeded = found.theorem.statement.split()
            yield found.theorem.name, f"{table} {order}", f"{table} {int(order) + 1}"
            yield found.theorem.name, missed, f"{_neighbour(missed, -1):e}"
            yield found.theorem.name, exceeded, f"{_neighbour(exceeded, 1):e}"


def _neighbour(text: str, units: int) -> Decimal:
    number = Decimal(text)
    return number + units * Decimal((0, (1,), int(number.as_tuple().exponent)))


def _statement(name: str) -> str:
    return next(found.theorem.statement for found in all_theorems() if found.theorem.name == name)
