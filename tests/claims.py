"""What sources claim of their tables and orders, by the problems that they claim it for; and what the trees say."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

from driftproof.methods.schemes import Method, Nystrom, Splitting
from driftproof.symbolic.facts import general_order
from driftproof.symbolic.trees.order_conditions import OrderFact, runge_kutta_conditions
from driftproof.symbolic.trees.partitioned_trees import nystrom_conditions, nystrom_order, separable_conditions

# The printed nodes of Lobatto IIIB are not the row sums of its A.
KNOWN_INCONSISTENT = {"lobatto_iiib2": {"c[0] - sum(a[0])": Q(-1, 2), "c[1] - sum(a[1])": Q(1, 2)}}
# Bounds, decimal places, of the residuals of rounded tables: more than that is no rounding.
ROUNDED_SUMS = {"prince_dormand87": 16, "tsitouras54": 14, "dop853": 27, "dop853_third": 27, "kahan_li6": 25}
ROUNDED_SUMS |= {"suzuki_umeno8": 25, "mclachlan_atela3": 18, "mclachlan_atela5": 18}
# How far order conditions of rounded tables are off at most: some units of the last digit that is right, which of
# Yoshida's 15 is the 14th, of order 8 the 12th; there the weights of solution A are as large as 2.4, 17 of them.
ROUNDED = {"prince_dormand87": Q("1e-17"), "tsitouras54": Q("2e-15"), "dop853": Q("1e-27"), "dop853_third": Q("1e-27")}
ROUNDED |= dict.fromkeys(("yoshida6", "yoshida6_position_first", "yoshida6_b", "yoshida6_c"), Q("1e-13"))
ROUNDED |= {"yoshida8": Q("1e-12"), "yoshida8_position_first": Q("1e-12"), "yoshida8_a": Q("2e-10")}
ROUNDED |= dict.fromkeys(("kahan_li6", "kahan_li8", "suzuki_umeno8"), Q("1e-25"))
ROUNDED |= dict.fromkeys(("mclachlan_atela3", "mclachlan_atela4", "mclachlan_atela5"), Q("1e-18"))
ROUNDED |= dict.fromkeys(("pefrl", "vefrl", "blanes_moan4", "blanes_moan6"), Q("1e-15"))
ROUNDED |= dict.fromkeys(("blanes_moan_rkn4", "blanes_moan_rkn6a", "blanes_moan_rkn6b"), Q("1e-15"))
# Coarser than what all of that makes of a step, finer than every error term.
NEARLY = Q(1, 10**9)
# Claimed where drifts are linear in v; on every T(p) + V(q) the order is this. The first one is symmetric: its even
# order is one for free, and up to order 3 there is no difference.
SEPARABLE = {"blanes_moan_rkn4": 4, "mclachlan_atela4": 3, "mclachlan_atela5": 3}
SEPARABLE |= {"blanes_moan_rkn6a": 4, "blanes_moan_rkn6b": 4}


def claimed(method: Method) -> dict[str, int]:
    """The order on each kind of problem that the family is for."""
    if isinstance(method, Splitting):
        return {"separable": SEPARABLE.get(method.key, method.claimed_order), "second_order": method.claimed_order}
    return {"second_order" if isinstance(method, Nystrom) else "general": method.claimed_order}


def by_trees(method: Method) -> dict[str, OrderFact[Any]]:
    """The exact order on each of them."""
    if isinstance(method, Splitting):
        return {"separable": general_order(method), "second_order": nystrom_order(method)}
    return {"second_order" if isinstance(method, Nystrom) else "general": general_order(method)}


def conditions(method: Any) -> dict[str, Any]:
    """The order conditions on each of them."""
    if isinstance(method, Splitting):
        return {"separable": separable_conditions(method), "second_order": nystrom_conditions(method)}
    if isinstance(method, Nystrom):
        return {"second_order": nystrom_conditions(method)}
    return {"general": runge_kutta_conditions(method)}
