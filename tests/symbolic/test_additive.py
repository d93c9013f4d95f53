"""IMEX methods: coupling conditions written out, float runs of both parts, pairs whose tables do not fit."""

from dataclasses import replace
from fractions import Fraction as Q
from math import log2

import numpy as np
import pytest

from driftproof import METHODS, Facts, facts, read_method
from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import FURTHER_METHODS, entry_named
from driftproof.symbolic.additive import AdditiveFacts
from tests.looping import exactly, some

EVERY = {key: method for key, method in FURTHER_METHODS.items() if isinstance(method, Additive)}
TINY = Q(1, 10**20)  # above the rounding of fractions of 13 digits in each part, squared or not, with room


def arrays(method):
    rows = (method.a_explicit, method.a_implicit, method.b_explicit, method.b_implicit)
    return [np.array(row, dtype=float) for row in rows]


def explicit_part(y):
    return np.array([y[1], np.sin(y[0] * y[1])])


def implicit_part(y):
    return np.array([-y[0] * y[0], -y[0] - y[1] ** 3])


def end_of_run(method, steps):
    """y at t = 1 from (1, 1/2): written out from the definition, implicit stages by iteration."""
    a, implicit, b, weights = arrays(method)
    y, h = np.array([1.0, 0.5]), 1 / steps
    for _ in range(steps):
        f, g = [], []
        for i in range(len(b)):
            known = y + h * sum((a[i, m] * f[m] + implicit[i, m] * g[m] for m in range(i)), np.zeros(2))
            stage = known
            for _ in range(40):  # a contraction: h times the slope of g is below 0.1
                stage = known + h * implicit[i, i] * implicit_part(stage)
            f.append(explicit_part(stage))
            g.append(implicit_part(stage))
        y = y + h * sum(x * u + w * v for x, u, w, v in zip(b, f, weights, g, strict=True))
    return y


def rate(method, steps=40):
    first, second, third = (end_of_run(method, n * steps) for n in (1, 2, 4))
    return log2(np.linalg.norm(first - second) / np.linalg.norm(second - third))


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("key", EVERY)
def test_orders_are_those_claimed_and_those_measured(key):
    method, facts = EVERY[key], AdditiveFacts(EVERY[key])
    found = facts.orders_within(TINY)
    assert found.order == found.explicit_order == found.implicit_order == method.claimed_order
    assert found.embedded_order == method.embedded_order
    if not method.decimal:
        assert (facts.order, facts.explicit_order, facts.implicit_order) == found[1:4]
        assert facts.nodes is not None
    assert facts.implicit_stiffly_accurate is (key not in ("ars122", "ars233"))
    # At h = 1/40 the next term of the error moves the rate by less than half an order.
    assert abs(rate(method) - method.claimed_order) < 0.4


def test_coupling_conditions_written_out_hold_and_are_seen_to_fail():
    for key, method in exactly(2, [(key, EVERY[key]) for key in ("ars443", "ark324")]):
        a, implicit, b, weights = arrays(method)
        nodes = a.sum(1)
        written = [w @ m @ nodes - 1 / 6 for w in (b, weights) for m in (a, implicit)]
        assert max(map(abs, [*written, b @ nodes - 1 / 2, weights @ nodes**2 - 1 / 3])) < 1e-14, key
    # Heun beside a two-stage SDIRK of order 2 at other times: each of order 2, together of order 1.
    heun = METHODS["heun2"]
    apart = Additive("m", "m", 2, "", heun.a, ((Q(1, 4), 0), (Q(1, 2), Q(1, 4))), heun.b, heun.b)
    facts = AdditiveFacts(apart)
    assert (facts.explicit_order, facts.implicit_order, facts.order, facts.nodes) == (2, 2, 2, None)
    other = AdditiveFacts(replace(apart, a_implicit=((Q(1, 2), 0), (0, Q(1, 2))), b_implicit=(0, 1)))
    assert (other.explicit_order, other.implicit_order, other.order) == (2, 2, 1)
    assert other.order_fails.failing_tree in {("explicit", (("implicit", ()),)), ("implicit", (("explicit", ()),))}
    assert abs(rate(apart) - 2) < 0.4
    assert abs(rate(other.method) - 1) < 0.4
    for name in exactly(4, ("a_explicit", "a_implicit", "b_explicit", "b_implicit")):
        rows = getattr(EVERY["ars443"], name)
        if name.startswith("b"):
            changed = (rows[0], rows[1] + Q(1, 100), *rows[2:])
        else:
            changed = (*rows[:3], (rows[3][0], rows[3][1] + Q(1, 100), *rows[3][2:]), *rows[4:])
        assert AdditiveFacts(replace(EVERY["ars443"], **{name: changed})).order < 3, name


def test_each_part_has_the_facts_of_its_table():
    euler = AdditiveFacts(EVERY["ars111"])
    assert euler.explicit_stability_function == Facts(METHODS["forward_euler"]).stability_function
    assert euler.implicit_stability_function == Facts(METHODS["backward_euler"]).stability_function
    found = {key: AdditiveFacts(method) for key, method in some(EVERY.items())}
    stable = [key for key, facts in found.items() if facts.implicit_l_stable]
    assert stable == ["ars111", "ars121", "ars232", "ars222", "ars343", "ars443", "ark436"]
    assert 0 < abs(found["ark324"].implicit_limit_at_infinity) < TINY  # 0 but for the rounding of its fractions
    assert [key for key, facts in found.items() if not facts.weights_agree] == ["ars111", "ars222", "ars443"]


def test_digits_alone_keep_decimal_tables_from_their_order_and_stability():
    found = {key: AdditiveFacts(method) for key, method in some(EVERY.items()) if method.decimal}
    assert [facts.order_but_for_rounding.order for facts in found.values()] == exactly(3, [3, 4, 5])
    assert all(facts.implicit_stability_within_digits.l_stable for facts in found.values())


def test_facts_are_written_and_files_read(answer, refusal, tmp_path):
    assert facts(EVERY["ars222"], only=["nodes"]).data["nodes"] == ["0", "1 - 1/2*sqrt(2)", "1"]
    text = answer("facts", "ARS(4,4,3)")
    assert "  order of the implicit tableau                 3" in text
    assert "takes two right-hand sides: `driftproof facts` and" in refusal(
        "step", "ars222", "--h", "1/2", "--state", "1,0"
    )
    assert entry_named("KenCarp3") is EVERY["ark324"]
    path = tmp_path / "mine.toml"
    lines = ['family = "additive"', "A_explicit = [[0, 0], [1, 0]]", "A_implicit = [[0, 0], [0, 1]]"]
    path.write_text("\n".join([*lines, "b_explicit = [1, 0]", "b_implicit = [0, 1]"]), encoding="utf-8")
    assert facts(read_method(path), only=["order", "implicit_l_stable"]).data == {"order": 1, "implicit_l_stable": True}
