"""Parse questions into trees of arithmetic on numbers, published values and queries, without evaluating anything.

The grammar is that of `driftproof.methods.formulas.expression_tree`, in which a name may also begin a query:

query   = head part* [":" readout [unit]]
part    = subject | "at" value | name "=" (literal | name | rates) | number "steps" | start | equation
start   = "from" ["("] entry ("," entry)* [")"]
entry   = literal | expression with pi or sqrt
rates   = "(" sum ("," sum)* ")"
equation = name "'" "=" sum | name "(" "0" ")" "=" entry
literal = ["-" | "+"] number ["/" number]
value   = literal | "(" expression of driftproof.methods.formulas.expressions ")"

Heads and subjects may have several words, as in "stability function of forward Euler"; a comma may precede an equation
or a setting, and words such as "with" may stand between any parts; "error of rk4 ..." means "run rk4 ... : error".
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise, takewhile
from typing import Any, TypeAlias

from driftproof.methods.catalogue import METHODS, keys_of_name
from driftproof.methods.formulas.expression_tree import (
    END,
    NAME,
    NUMBER,
    CallNode,
    ExpressionNode,
    NameNode,
    NumberNode,
    Token,
)
from driftproof.methods.schemes import Splitting
from driftproof.support.plain_text import did_you_mean
from driftproof.texts.questions import wording
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.pieces import OWN_PI, PieceParser, parsed_spelling

SETTINGS = ("h", "t", "N", "steps", "z", "lambda")
PROBLEM, RATES, ENERGY, STARTED = ("problem", "rates", "energy", "started")
_NO_SETTING = f"{{}} is not a setting; use {', '.join((*SETTINGS, PROBLEM, RATES))}, or a name in your equation"
_WITHOUT_SIGN = {*SETTINGS, *wording.OTHER_SETTINGS}
# Sign that is not allowed -> what to write; and what may be the name of a file, with blanks and such signs.
_HINTS = {"%": "a percentage is percent(a, b)", "[": "coefficients are b2 and a21, counted from 1, starts from 1,0"}
_QUOTES = "a file's name with blanks or signs stands in quotes: 'my method.toml'"
_UNQUOTED = re.compile(r"(?:[^\s=:]+ )*[^\s=:]*\.toml(?![\w'\"])")
_WITH_EQUATION = "as in run heun2 y'=-y y(0)=1 h=0.1 t=1 : error"
_OF_METHOD = "order rk4, or run rk4 h=0.1 t=1 : q"
# Texts have powers such as (17/16)**1000; powers that are too long to write out are enclosed.
LARGEST_POWER_ASKED = 10**6


@dataclass(frozen=True)
class Query:
    """The query HEAD SUBJECT [at VALUE] [NAME=NUMBER ...] [from q,v] [: READOUT [UNIT]]; absent parts are None.

    `at` is the value of a family's parameter as text, for `driftproof.methods.formulas.expressions`; `rates` are the components
    of y' as text, for `driftproof.methods.formulas.field_text`, and `energy` likewise; `unknowns` are their names if y' = ...
    gives them, else empty, for y0, y1, ...
    """

    head: Token
    subject: Token | None = None
    at: Token | None = None
    settings: dict[str, NumberNode] = field(default_factory=dict)
    start: tuple[Fraction | str, ...] | None = None  # text, such as pi/4, if it may be irrational
    readout: Token | None = None
    unit: Token | None = None
    problem: Token | None = None
    started: Token | None = None  # what gives the first values of a multistep method: a method, or exact
    rates: tuple[Token, ...] = ()
    energy: Token | None = None
    unknowns: tuple[str, ...] = ()
    parameters: dict[str, NumberNode] = field(default_factory=dict)  # of a problem in a file


Node: TypeAlias = ExpressionNode | Query


def parse_question(question: str) -> Node:
    """Parse a question into its tree, whose columns are those of `parsed_spelling`. Raises QuestionError."""
    question = parsed_spelling(question)
    try:
        node: Node = _QuestionParser(question, LARGEST_POWER_ASKED).tree()
    except QuestionError as error:
        of_file = any(match.start() < error.column <= match.end() for match in _UNQUOTED.finditer(question))
        if hint := _QUOTES if of_file else _HINTS.get(question[error.column - 1 : error.column]):
            raise QuestionError(error.text, error.column, f"{error.reason}; {hint}") from None
        raise
    return node


class _QuestionParser(PieceParser):
    """A parser of questions; each method consumes the tokens of the construct that it is named after."""

    def _atom(self) -> Any:
        """Parse an atom of arithmetic, or a query that begins with its count: 1000 steps of rk4 h=0.01 : q."""
        counted = self.next.text != "one" and not self.in_rate and self._is_count(self.at)
        counted = counted or self.leads(self.at)
        run = self.next._replace(kind=NAME, text="run")
        return self.query(self.next, run, defaultdict(dict)) if counted else super()._atom()

    def named(self, name: Token) -> Node:
        """Parse a name that was just taken: the id of a published value, or the beginning of a query."""
        while self.next.kind == NAME and not self.in_rate and self._only_asks(name):
            name = self.take()
            if self.accept("("):
                called: Node = self._call(name)
                return called
        of_somebody = self.next.text == "'" and self.after(self.at).text == "s"
        adjacent = self.next.text == "-" and self.next.column == name.end
        named = (adjacent or self.next.kind == NUMBER) and self._goes_on(name)
        if not self.in_rate and self.next.text == "'" and self.after(self.at).text == "=":
            parts: dict[str, Any] = defaultdict(dict)
            self._equation(name, parts)
            return self.query(name, name._replace(text="run"), parts)
        named = named or (self.next.text == "," and bool(keys_of_name(name.text)) and self._another_part(parts={}))
        if self.in_rate or not (self.next.kind == NAME or self.next.text == ":" or of_somebody or named):
            if not self.in_rate and keys_of_name(name.text):
                raise self.error(name, f"{name.text} is a method; ask for one of its values, as in {_OF_METHOD}")
            return NameNode(name.column, name.text)
        parts = defaultdict(dict)
        return self.query(name, self.head(name, parts), parts)

    def _only_asks(self, name: Token) -> bool:
        """True for a word before a question, as "what", and for "one" before a method, as in one RK4 step."""
        if name.text.lower() in ("one", "single", "first"):
            return bool(keys_of_name(self.next.text))
        return name.text.lower() in wording.ASKING | wording.SAY_NOTHING

    def _goes_on(self, name: Token) -> bool:
        """True if the next hyphen or number belongs to the name of a fact or method: Crank-Nicolson, BDF 2."""
        start = self.at
        self.method_name(name)
        longer, self.at = self.at > start, start
        return longer or wording.longest_name(self.tokens[start - 1 :])[1] > 1

    def _call(self, name: Token) -> Any:
        """Parse a call after its opening bracket: a function, R(-2) of rk4, or y(1) of rk4 y'=-y y(0)=1."""
        parts: dict[str, Any] = defaultdict(dict)
        time, closing, after = (self.after(self.at + i) for i in (-1, 0, 1))
        is_time = (time.kind, closing.text, after.kind) == (NUMBER, ")", NAME)
        if name.text != "R" and is_time and not self.in_rate:
            self._at_time(name, parts)
            return self.query(name, name._replace(text="run"), parts)
        if name.text != "R":
            if keys_of_name(name.text):
                raise self.error(name, f"{name.text} is a method, not a function; ask for example: {_OF_METHOD}")
            return super()._call(name)
        head = "limit_at_infinity" if self.accept("oo", "infinity") else wording.FACT_WORDS["r"]
        if head == wording.FACT_WORDS["r"] and not self.accept("z"):
            parts["settings"]["z"] = NumberNode(self.next.column, self.literal("z"))
        self.expect(")", "the bracket of R is not closed")
        return self.query(name, name._replace(text=head), parts)

    def _at_time(self, name: Token, parts: dict[str, Any]) -> None:
        """Parse a value such as y(1) after its opening bracket: the readout y at t = 1."""
        self.put(parts["settings"], name, "t", lambda: NumberNode(self.next.column, self.literal("t")))
        self.expect(")", "a bracket is not closed")
        self.put(parts, name, "readout", lambda: name._replace(text=wording.READOUT_WORDS.get(name.text, name.text)))

    def query(self, name: Token, head: Token, parts: dict[str, Any]) -> Node:
        """Parse the rest of a query, which began at `name`, after its head."""
        while self._another_part(parts):
            token = self.take()
            if token.text == "per" and self.accept("step"):
                head = head._replace(text=head.text.removesuffix(wording.PER_STEP) + wording.PER_STEP)
            else:
                self.part(token, parts)
        if head.text == "run" and "subject" in parts and parts["subject"].text == "exact":
            head = head._replace(text=parts.pop("subject").text)  # I(0.25) of the exact solution
        if (colon := self.accept(":")) and self.after(self.at).text == "(":
            self.part(self.take(), parts)  # y(1)
        elif colon:
            self.put(parts, self.next, "readout", self.readout)
            if self.next.kind == NAME:
                parts["unit"] = self.take()
        elif (readout := head.text.removesuffix(wording.PER_STEP)) in wording.READOUT_WORDS:
            methods = keys_of_name(parts["subject"].text) if readout != head.text and "subject" in parts else ()
            if readout == "phase_error" and any(isinstance(METHODS.get(key), Splitting) for key in methods):
                raise self.error(name, wording.PHASE_PER_STEP.replace("METHOD", methods[0]))
            parts["readout"] = head._replace(text=wording.READOUT_WORDS[readout])
            head = head._replace(text="step" if readout in wording.LOCAL or readout != head.text else "run")
        elif head.text == wording.LARGEST_STEP:
            parts["start"] = dict.fromkeys(parts["rates"], Fraction(0)) | parts["start"]
        elif wording.SLOPE.fullmatch(head.text):
            parts["readout"], head = head, head._replace(text="step")
        elif ":" in head.text:
            parts["readout"] = head._replace(text=head.text.split(":")[1])
        found = Query(head._replace(text=head.text.partition(":")[0]), **self.with_unknowns(name, parts))
        return CallNode(name.column, "sqrt", (found,)) if head.text.endswith(":sqrt") else found

    def head(self, name: Token, parts: dict[str, Any]) -> Token:
        """Parse a head of several words; it may follow its method, as in "RK4 real limit", or be missing, for run."""
        start, (text, count) = self.at, wording.longest_name(self.tokens[self.at - 1 :])
        method = self.method_name(name)
        if self.at - start >= count and (keys_of_name(method.text) or method.text.endswith(".toml")):
            parts["subject"] = method
            text, count = wording.longest_name(self.tokens[self.at :])
            after = self.tokens[self.at + count]
            if after.text == "=" or after.kind == NUMBER:  # steps = 10
                text, count = "", 0
            self.at += count
        elif text:
            self.at = start + count - 1
        else:
            self.at = start
            if any(a.text == name.text and b.text == "'" for a, b in pairwise(self.tokens)):
                parts["readout"] = name  # an unknown: y at t=1 of rk4 on y'=-y
                return name._replace(text="run")
            more = takewhile(lambda x: x.kind == NAME and x.text not in wording.SAY_NOTHING, self.tokens[start:])
            words = [name.text, *(token.text for token in more if not keys_of_name(token.text))]
            hint = did_you_mean("_".join(words), sorted(wording.names_that_ask()))
            what = f"{' '.join(words)[:40]!r} is not a known fact or readout{hint}"
            raise self.error(name, f"{what} (`driftproof value --list` lists all)")
        axis = next((i for i, token in enumerate(self.tokens) if token.text == "axis"), 0)
        if (of := self.tokens[axis - 1].text) in wording.AXIS and wording.AMBIGUOUS_FACTS.get(text) == wording.LIMITS:
            text, self.tokens[axis - 1 : axis + 1] = f"{of}_limit", []
        if text in wording.AMBIGUOUS_FACTS:
            limits = wording.AMBIGUOUS_FACTS[text] == wording.LIMITS and wording.STEP_LIMITS.fullmatch(text)
            if limits and wording.STATED.search(self.text):
                return name._replace(text=wording.LARGEST_STEP)
            rest = (self.method_name(x) for x in iter(self.take, self.tokens[-1]) if x.text not in wording.SAY_NOTHING)
            named = (x for x in rest if len(keys_of_name(x.text)) == 1 or x.text.endswith(".toml"))
            of_it = parts.get("subject") or next(named, None)
            said = self.text[max(of_it.column - 2, 0) : of_it.end].strip(" ,()") if of_it else "METHOD"
            raise self.error(name, f"{text} may mean {wording.meanings(text, said, self.text)}: say which")
        return name._replace(text=wording.FACT_WORDS.get(text, text or "run"))

    def _another_part(self, parts: Mapping[str, Any]) -> bool:
        """True if another part of the query follows; consumes a comma before an equation, a setting, at or from.

        After equations it may also be one before the method.
        """
        if self.next.text == "," and parts.get("rates") and "subject" not in parts:
            at, method = self.at, self.method_name(self.tokens[self.at + 1])
            self.at = at
            if keys_of_name(method.text) or method.text.endswith(".toml"):
                self.take()
        if self.next.text == ",":
            name, *after = (token.text for token in self.tokens[self.at + 1 : self.at + 4])
            said = name in wording.SAY_NOTHING or after[:1] == ["steps"] or self._setting_name(self.at + 1)[1]
            ends = [token.text for token in self.tokens[self.at + 4 : self.at + 6]]  # of y(1) at the end, or y(0)=1
            said = said or (after[:1] == ["("] and ends in ([")", ""], [")", "="])) or self.leads(self.at + 1)
            if said or after[:1] == ["="] or after in (["'", "="], ["'", "("]) or name in ("at", "from"):
                self.take()
        return self.next.kind == NAME or self._is_count(self.at) or self.leads(self.at)

    def _is_count(self, at: int) -> bool:
        """True if a count of steps or periods, in digits or as a word, begins at this token."""
        token = self.tokens[at]
        return (token.kind == NUMBER or token.text in wording.WORDED_COUNTS) and self.after(at).text in wording.COUNTED

    def with_unknowns(self, head: Token, parts: dict[str, Any]) -> dict[str, Any]:
        """The parts of a query, with rates and start taken from its equations, in the order of the unknowns."""
        if not (parts["rates"] or "problem" in parts) and (of := parts["settings"].pop("lambda", None)):  # y' = λy
            parts["rates"] = {"y": Token(NUMBER, f"({of.value})*y", of.column)}
            parts["start"] = parts["start"] or {"y": Fraction(1)}
        rates, start = parts["rates"], parts["start"]
        names = tuple(rates) if isinstance(rates, dict) else ()
        if isinstance(start, dict):
            if missing := [name for name in (*names, *start) if name not in start or name not in names]:
                name, of = missing[0], missing[0].removeprefix("d")
                lacks = f"{of}'(0)" if of != name and of in names else f"{name}(0)" if name in names else f"{name}'"
                raise self.error(head, f"{lacks} = ... is missing, as in y'=-y, y(0)=1")
            velocity = {name: said for name in names if (said := rates[name].text.strip()) in names}
            if {*velocity, *velocity.values()} == {*names} and not velocity.keys() & velocity.values():
                names = (*velocity, *velocity.values())  # x' = v, v' = -x, and so on: the order that kicks need
            start = tuple(start[name] for name in names)
        rates = (*(rates[name] for name in names or range(len(rates))), *filter(None, [parts["energy"] or None]))
        for name in parts["settings"].keys() - {*SETTINGS[:-1], *names}:  # as k and lambda in y'=-k*y + lambda
            in_rate = re.compile(rf"\b{name}\b")
            if any(in_rate.search(rate.text) for rate in rates):
                text = f"({parts['settings'].pop(name).value})"
                rates = tuple(rate._replace(text=in_rate.sub(text, rate.text)) for rate in rates)
        of_file = parts.get("problem") is not None and parts["problem"].text.endswith(".toml")
        own = {name: parts["settings"].pop(name) for name in [*parts["settings"]] if of_file and name not in SETTINGS}
        if wrong := [*parts["settings"].keys() - {*SETTINGS}]:
            column = parts["settings"][wrong[0]].column
            raise self.error(Token(NAME, wrong[0], column), _NO_SETTING.format(repr(wrong[0])))
        energy = rates[-1] if parts["energy"] else None
        rates = rates[: len(rates) - bool(energy)]
        return {**parts, "parameters": own, "rates": rates, "energy": energy, "start": start or None, "unknowns": names}

    def _setting_name(self, at: int) -> tuple[str, int]:
        """The name of the setting at this token, before a number or =, and its number of words; ("", 0) for none."""
        words = [token.text for token in self.tokens[at : at + 2]]
        for count in (2, 1):
            name, after = "_".join(words[:count]), self.tokens[min(at + count, len(self.tokens) - 1)]
            if name in _WITHOUT_SIGN and (after.kind == NUMBER or after.text == "="):
                return name, count
        return "", 0

    def part(self, token: Token, parts: dict[str, Any]) -> None:
        """Parse the part of a query that begins with this token, which was just taken."""
        setting, words = self._setting_name(self.at - 1)
        if words == 2:
            self.take()
        if self._is_count(self.at - 1) and self.next.text.startswith("step"):
            steps = self.rational(token.text, token) if token.kind == NUMBER else wording.WORDED_COUNTS[token.text]
            count = NumberNode(token.column, Fraction(steps))
            self.put(parts["settings"], self.take(), "N", lambda: count)
        elif not (
            (not setting and self._says_nothing(token, parts))
            or self._equation(token, parts)
            or self._assignment(token, setting, parts)
        ):
            self._bare_part(token, parts)

    def _says_nothing(self, token: Token, parts: dict[str, Any]) -> bool:
        """True for a word that may stand between parts, and for words that only announce a setting or an equation."""
        if f"{token.text}_{self.next.text}" in wording.OTHER_SETTINGS:  # step size h=0.1
            self.take()
            return True
        announced = token.text == "at" and self.next.kind == NAME and self.after(self.at).text in "='"  # at t=1
        counted = token.text == "steps" and "N" in parts["settings"]  # N=10 steps
        return token.text in wording.SAY_NOTHING or announced or counted

    def _equation(self, token: Token, parts: dict[str, Any]) -> bool:
        """Parse y' = ..., dy/dt = ..., y(0) = ... or, at the end of a question, y(1); False if it is none of them."""
        token, lead = self.without_lead(token)
        after = self.after(self.at)
        if self.next.text == "'" and after.text in ("=", "(", "'"):
            self.put(parts["rates"], token, token.text, lambda: self.rate(lead))
        elif token.text[:1] == "d" and (self.next.text, after.text) == ("/", "dt"):
            self.take()
            self.put(parts["rates"], token, token.text[1:], self.rate)
        elif token.text in ("at", "from") or self.next.text != "(" or after.kind != NUMBER:
            return False
        elif self.after(self.at + 2).kind == END:
            self.take()
            self._at_time(token, parts)
        elif after.text != "0":
            raise self.error(after, f"time starts at 0: write the initial value as {token.text}(0) = ...")
        else:
            self.take(), self.take(), self.expect(")", "a bracket is not closed")
            self.expect("=", f"expected = and a number, as in {token.text}(0)=1")
            self.put(parts["start"], token, token.text, self.entry)
        return True

    def _assignment(self, token: Token, setting: str, parts: dict[str, Any]) -> bool:
        """Parse problem=, started=, rates=, energy= or a setting, whose = is optional; False if it is none."""
        if token.text == PROBLEM and self.accept("="):
            self.put(parts, token, PROBLEM, self.take)
        elif token.text == STARTED and self.accept("="):
            self.put(parts, token, STARTED, lambda: self.method_name(self.take()))
        elif token.text == RATES and self.accept("="):
            self.put(parts, token, RATES, self.rates)
        elif token.text == ENERGY and self.next.text == "=":
            self.at -= 1
            self.put(parts, token, ENERGY, self.rate)
        elif setting or (token.text != "at" and self.next.text == "="):
            self.setting(token._replace(text=setting or token.text), parts["settings"])
        else:
            return False
        return True

    def _bare_part(self, token: Token, parts: dict[str, Any]) -> None:
        """Parse a part without an equals sign: a start, the value of a parameter, or a method."""
        key = token.text if token.text == "at" else "subject"
        if token.text == "from":
            self.put(parts, token, "start", self.start)
        elif not wording.PERIODS.isdisjoint((token.text, self.next.text)):
            raise self.error(token, f"a period is not a whole number of steps: {OWN_PI}")
        elif key in parts:
            raise self.error(token, self._why_unexpected(token))
        else:
            parts[key] = self.method_name(token) if key == "subject" else self.value()
            if parts[key].text == "exact":
                self.accept("solution")

    def _why_unexpected(self, token: Token) -> str:
        from driftproof.numeric.problems.catalogue import PROBLEMS

        if token.text in PROBLEMS or token.text.endswith(".toml"):
            return f"to name a problem, write problem={token.text}"
        hint = "" if ":" in self.text else f", {_WITH_EQUATION}"
        unexpected = f"unexpected {token.shown}; a colon and a readout may follow{hint}"
        return wording.ASKED_ELSEWHERE.get(token.text, unexpected)

    def setting(self, name: Token, settings: dict[str, NumberNode]) -> None:
        """Parse a setting NAME=LITERAL after its name; the equals sign is optional, and steps means N."""
        self.accept("=")
        key = wording.OTHER_SETTINGS.get(name.text, name.text)
        said = [token.text for token in self.tokens]
        if key not in SETTINGS and said.count(key) < 2 and PROBLEM not in said:
            raise self.error(name, wording.ASKED_ELSEWHERE.get(name.text, _NO_SETTING.format(name.shown)))
        self.put(settings, name, key, lambda: NumberNode(name.column, self.literal(name.text)))
        before, after = self.tokens[self.at - 1], self.after(self.at)
        if (self.next.text, self.next.column, after.kind, after.column) == (",", before.end, NUMBER, self.next.end):
            raise self.error(self.next, f"write it with a point: {before.text}.{after.text}")
