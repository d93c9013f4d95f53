"""Systems y' = f(t, y) given as text, checked to be formulas, and their partial derivatives."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field

from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.schemes import MethodError

# The functions that a rate may call; every type of numbers in which runs are computed has them.
SMOOTH_FUNCTIONS = ("sin", "cos", "exp", "log", "sqrt")
FUNCTIONS = (*SMOOTH_FUNCTIONS, "abs")
# A function with jumps, which has the derivative 0 elsewhere.
FLOOR = "floor"
# What derivatives use besides, as if it were constant: copysign(1, x), of abs.
OF_DERIVATIVES = ("copysign",)
_OPERATORS = (ast.USub, ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Gt, ast.GtE, ast.Lt, ast.LtE)
# chosen: a rate that is longer is not quoted where another is wanted.
_LONGEST_QUOTED = 40
_ALLOWED = (ast.Expression, ast.BinOp, ast.UnaryOp, ast.IfExp, ast.Name, ast.Load, *_OPERATORS)


@dataclass(frozen=True)
class VectorField:
    """The system y' = f(t, y), with an expression for each component of f.

    An expression contains t, y0, y1, ..., named parameters, whole numbers, + - * / and `FUNCTIONS`, as in van der Pol's
    VectorField(("y1", "mu * (1 - y0 * y0) * y1 - y0"), (("mu", Fraction(5)),)). With kinks or jumps it also contains
    floor and choices by one comparison, as (y0 if y0 > 0 else 0). Powers are written as products, because compilers and
    Python compute them differently. Parameters are exact. Raises MethodError for any other expression.
    `unknowns` are the user's own names of y0, y1, ..., if there are any, for reports and messages.
    """

    rates: tuple[str, ...]
    parameters: tuple[tuple[str, Exact], ...] = ()
    unknowns: tuple[str, ...] = field(default=(), compare=False, repr=False)

    def __post_init__(self) -> None:
        """Raise MethodError for a system without rates, and for a rate that is no such expression."""
        if not self.rates:
            raise MethodError("a right-hand side needs at least one rate")
        known = dict.fromkeys(("t", *self.components, *(name for name, _ in self.parameters)))
        for i, rate in enumerate(self.rates):
            for found in _out_of_place(_parsed(rate, i), known):
                raise MethodError(f"rate {i}, {rate!r}: {found} is not allowed; write + - * / with {', '.join(known)}")

    @property
    def components(self) -> tuple[str, ...]:
        """The names of the components: y0, y1, ..."""
        return tuple(f"y{i}" for i in range(len(self.rates)))

    def in_own_words(self, text: str) -> str:
        """The text with the user's names of the unknowns in place of y0, y1, ..."""
        return re.sub(r"\by(\d+)\b", lambda found: dict(enumerate(self.unknowns)).get(int(found[1]), found[0]), text)

    @property
    def autonomous(self) -> bool:
        """True if no rate reads t."""
        return all("t" not in _names(_parsed(rate, i)) for i, rate in enumerate(self.rates))

    @property
    def smooth(self) -> bool:
        """True if no rate has a kink or a jump: an absolute value, a choice, a number rounded to an integer."""
        return not any(True for _ in self._kinks())

    def _kinks(self) -> Iterator[ast.AST]:
        """The parts of rates that say where one has a kink or a jump."""
        for node in (node for i, rate in enumerate(self.rates) for node in ast.walk(_parsed(rate, i))):
            if isinstance(node, ast.IfExp):
                yield node.test
            elif isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("abs", FLOOR):
                yield node

    @property
    def linear(self) -> bool:
        """True if f(t, y) = A(t) y + b(t) is written so: no derivative by a component reads one, and no kink does."""
        slopes = (ast.parse(partial_derivative(rate, y)) for rate in self.rates for y in self.components)
        return not any(_names(node).intersection(self.components) for node in (*self._kinks(), *slopes))

    def dependence(self) -> list[set[int]]:
        """The indices of the components that each rate reads."""
        number = {name: i for i, name in enumerate(self.components)}
        return [{number[name] for name in _names(_parsed(r, i)) & number.keys()} for i, r in enumerate(self.rates)]

    def second_order(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The names of the positions and of the velocities: the first and the second half of the components.

        Raises MethodError unless the rates of the positions are written as exactly the velocities, and the rates of the
        velocities, the accelerations, read no velocity.
        """
        half, odd = divmod(len(self.rates), 2)
        positions, velocities = self.components[:half], self.components[half:]
        if odd:
            raise MethodError(f"a second-order system has as many velocities as positions, not {len(self.rates)} rates")
        for i, (rate, v) in enumerate(zip(self.rates, velocities, strict=False)):
            if ast.unparse(_parsed(rate, i)) != v:
                shown = repr(rate) if len(rate) <= _LONGEST_QUOTED else "no velocity"
                said = f"the rate of y{i} is {shown}; a second-order system needs {v!r}: positions come first"
                raise MethodError(self.in_own_words(said))
        for i, rate in enumerate(self.rates[half:], half):
            for v in sorted(_names(_parsed(rate, i)).intersection(velocities)):
                shown = f", {rate!r}," if len(rate) <= _LONGEST_QUOTED else ""
                said = f"the rate of y{i}{shown} reads the velocity {v}; kicks and drifts need accelerations"
                raise MethodError(f"{self.in_own_words(said)} that depend on positions only")
        return positions, velocities

    def at(self, names: Mapping[str, str]) -> list[str]:
        """The rates with t, y0, y1, ... replaced by other names."""
        return [ast.unparse(_Renamed(names).visit(_parsed(rate, i))) for i, rate in enumerate(self.rates)]


class _Renamed(ast.NodeTransformer):
    def __init__(self, names: Mapping[str, str]) -> None:
        self.names = names

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(self.names.get(node.id, node.id), node.ctx)


def _parsed(rate: str, i: int) -> ast.Expression:
    try:
        return ast.parse(rate, mode="eval")
    except SyntaxError:
        raise MethodError(f"rate {i}, {rate!r}: not an expression") from None


def _names(tree: ast.AST) -> set[str]:
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}


def _out_of_place(tree: ast.Expression, known: Collection[str]) -> Iterator[str]:
    """The parts that a rate may not have: unknown names, calls other than of `FUNCTIONS`, numbers not whole."""
    called = {node.func for node in ast.walk(tree) if isinstance(node, ast.Call)}
    chosen = [node.test for node in ast.walk(tree) if isinstance(node, ast.IfExp)]
    for node in ast.walk(tree):
        whole = isinstance(node, ast.Constant) and type(node.value) is int
        if whole or (isinstance(node, ast.Call) and not node.keywords):
            continue
        if isinstance(node, ast.Compare) and node in chosen and len(node.ops) == 1:
            continue
        allowed = (*FUNCTIONS, *OF_DERIVATIVES, FLOOR) if node in called else known
        tested = not isinstance(node, ast.IfExp) or isinstance(node.test, ast.Compare)
        if not (isinstance(node, _ALLOWED) and tested) or (isinstance(node, ast.Name) and node.id not in allowed):
            yield repr(ast.unparse(node) or type(node).__name__)


def partial_derivative(expression: str, name: str) -> str:
    """The partial derivative of a rate of a `VectorField` with respect to one of its names, as a rate."""
    return ast.unparse(_derivative(ast.parse(expression, mode="eval").body, name))


ZERO, ONE = ast.Constant(0), ast.Constant(1)


def _derivative(x: ast.expr, name: str) -> ast.expr:
    if isinstance(x, ast.Name):
        return ONE if x.id == name else ZERO
    if isinstance(x, ast.UnaryOp):
        return _negative(_derivative(x.operand, name))
    if isinstance(x, ast.BinOp):
        return _OF_OPERATION[type(x.op)](x.left, x.right, _derivative(x.left, name), _derivative(x.right, name))
    if isinstance(x, ast.IfExp):
        one, other = _derivative(x.body, name), _derivative(x.orelse, name)
        return one if ast.dump(one) == ast.dump(other) else ast.IfExp(x.test, one, other)
    if isinstance(x, ast.Call) and isinstance(x.func, ast.Name) and x.func.id not in (*OF_DERIVATIVES, FLOOR):
        (argument,) = x.args
        return _product(_OF_FUNCTION[x.func.id](argument), _derivative(argument, name))
    return ZERO


def _is(x: ast.expr, value: int) -> bool:
    return isinstance(x, ast.Constant) and x.value == value


def _sum(a: ast.expr, b: ast.expr) -> ast.expr:
    return b if _is(a, 0) else a if _is(b, 0) else ast.BinOp(a, ast.Add(), b)


def _difference(a: ast.expr, b: ast.expr) -> ast.expr:
    return _negative(b) if _is(a, 0) else a if _is(b, 0) else ast.BinOp(a, ast.Sub(), b)


def _product(a: ast.expr, b: ast.expr) -> ast.expr:
    if _is(a, 0) or _is(b, 0):
        return ZERO
    return b if _is(a, 1) else a if _is(b, 1) else ast.BinOp(a, ast.Mult(), b)


def _quotient(a: ast.expr, b: ast.expr) -> ast.expr:
    return ZERO if _is(a, 0) else ast.BinOp(a, ast.Div(), b)


def _negative(a: ast.expr) -> ast.expr:
    return ZERO if _is(a, 0) else ast.UnaryOp(ast.USub(), a)


def _call(function: str, *arguments: ast.expr) -> ast.expr:
    return ast.Call(ast.Name(function, ast.Load()), [*arguments], [])


# (a, b, a', b') -> the derivative of a op b.
_OF_OPERATION: dict[type[ast.operator], Callable[[ast.expr, ast.expr, ast.expr, ast.expr], ast.expr]] = {
    ast.Add: lambda a, b, da, db: _sum(da, db),
    ast.Sub: lambda a, b, da, db: _difference(da, db),
    ast.Mult: lambda a, b, da, db: _sum(_product(da, b), _product(a, db)),
    # a'/b - (a/b)(b'/b): without b², which may overflow although the quotient does not.
    ast.Div: lambda a, b, da, db: _difference(_quotient(da, b), _product(_quotient(a, b), _quotient(db, b))),
}
_OF_FUNCTION: dict[str, Callable[[ast.expr], ast.expr]] = {
    "sin": lambda x: _call("cos", x),
    "cos": lambda x: _negative(_call("sin", x)),
    "exp": lambda x: _call("exp", x),
    "log": lambda x: _quotient(ONE, x),
    "sqrt": lambda x: _quotient(ONE, _product(ast.Constant(2), _call("sqrt", x))),
    "abs": lambda x: _call("copysign", ONE, x),
}
