"""Parse the parts of a question: numbers, lists, rates, and the names of methods, files and readouts."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from fractions import Fraction
from functools import cache
from typing import Any
from unicodedata import name, normalize

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS, keys_of_name
from driftproof.methods.formulas.expression_tree import END, NAME, NUMBER, ExpressionParser, Token
from driftproof.methods.formulas.field_text import LEAD, of_first_order
from driftproof.methods.names import also_known_as
from driftproof.texts.questions import wording
from driftproof.texts.questions.errors import QuestionError

OWN_PI = "steps and times are rational, so round pi yourself, as in h=0.01 t=6.28"
# The factors before a derivative in an equation, and what has one.
_LEAD = re.compile(rf"{LEAD}+(?=[^\W\d]\w* ?' ?(?:\(t\) ?)?=)")
UNKNOWNS = re.compile(r"\w+(?= ?')|(?<=\bd)\w+(?= ?/ ?d[tx]\b)")


def without_accents(text: str) -> str:
    """The text with each accented letter as its plain one, so that columns stay."""
    return "".join(normalize("NFKD", c)[0] if c.isalpha() else c for c in text)


def with_greek_spelled(text: str) -> str:
    """The text with Greek letters spelled out: theta for θ, beta y for βy, k theta for kθ, but dtheta for dθ."""
    spelled = lambda letter: name(letter[0][0]).split()[-1].lower().replace("lamda", "lambda")
    apart = re.sub(r"(?<=[A-Zabce-zα-ω])(?=[α-ω])|(?<=[α-ω])(?=[^\W\d_])", " ", text.replace("µ", "μ"))
    return re.sub(r"[α-ω]", spelled, apart)


def with_time(text: str, unknowns: Collection[str]) -> str:
    """The text with t for x, if no unknown has that name, in dy/dx and words such as x and xy, as in y' = x + xy."""
    timed = lambda word: word[0].replace("x", "t") if {*word[0]} <= {"x", *unknowns} or word[0] == "dx" else word[0]
    return text if "x" in unknowns else re.sub(r"(?<![^\W\d])(?!exp\b)[^\W\d]\w*", timed, text)


def with_roots_spelled(text: str) -> str:
    """The text with sqrt(2) for √2 and sqrt( for √(."""
    return re.sub(r"√([0-9]+\.[0-9]+|\w+)", r"sqrt(\1)", text).replace("√(", "sqrt(")


def with_calls_bracketed(text: str) -> str:
    """The text with sin(t) for sin t, and cos(2t) for cos 2t."""
    return re.sub(r"\b(sin|cos|tan|tanh|exp|ln|log|sqrt) (\w+)(?![\w(])", r"\1(\2)", text)


def with_powers_of_e(text: str, unknowns: Collection[str]) -> str:
    """The text with exp(-t) for e^(-t) and e^-t in its equations, unless e is an unknown."""
    power = r"(?<![\w.)])e ?(?:\^|\*\*) ?(?:\(([^()]*)\)|(-?\w+))"
    return text if "e" in unknowns else re.sub(power, lambda to: f"exp({to[1] or to[2]})", text)


def parsed_spelling(question: str) -> str:
    """The question as it is parsed: Greek letters are spelled out, and equations are of first order."""
    question = of_first_order(with_greek_spelled(question))
    question = with_time(question, unknowns) if (unknowns := UNKNOWNS.findall(question)) else question
    return with_calls_bracketed(with_powers_of_e(question, unknowns)) if unknowns else question


@cache
def _token() -> re.Pattern[str]:
    """A token of a question: also the prime of y', names of files, names in quotes, and titles with signs."""
    from driftproof.methods.families import FAMILIES

    methods = {**METHODS, **FURTHER_METHODS, **FAMILIES}
    names = {without_accents(name) for key in methods for name in (methods[key].title, *also_known_as(key))}
    longest_first = sorted((re.escape(name) for name in names if re.search(r"[^\w ]", name)), key=len, reverse=True)
    names_with_signs = f"(?i:{'|'.join(longest_first)})(?!\\w)"
    plain = ExpressionParser.token().pattern.replace("[A-Za-z_]", f"{names_with_signs}|[A-Za-z_]")
    quoted = r"(?<![\w)])(?P<mark>[\"'])(?! ?[=('])(?P<quoted>.+?)(?P=mark)"
    file = r"(?![-+])(?P<file>[^\s\"'*()=:,^]+\.toml(?!\w))"
    return re.compile(f"{quoted}|(?P<prime>')|{file}|{plain}", re.ASCII)


class PieceParser(ExpressionParser):
    """A parser of the parts of a question; each method consumes its tokens or raises QuestionError at their column."""

    what = "a question"
    example = "ask for example: step rk4 h=1/2 : q"
    refusal = QuestionError
    token = staticmethod(_token)
    in_rate = False

    def __init__(self, question: str, largest_power: int) -> None:
        """Cut the question into tokens; accents count in names of files and in quotes only."""
        plain = without_accents(question).translate(self.typographic).removesuffix("?")
        super().__init__(plain, largest_power=largest_power)
        for i, (kind, text, column) in enumerate(self.tokens):
            if kind in ("quoted", "file"):
                self.tokens[i] = Token(NAME, question[column - 1 :][: len(text)], column)

    def method_name(self, first: Token) -> Token:
        """The longest method name or file name that begins with this token, else the token itself."""
        found, alone, last = first, keys_of_name(first.text), first
        for i, token in enumerate(self.tokens[self.at :], self.at):
            after = self.after(i)
            if token.text in "=:,()" or after.text == "=" or token.text in ("at", "from"):
                break
            if token.kind not in (NAME, NUMBER) and token.text != "'" and (len(alone) == 1 or token.column > last.end):
                break
            last = token
            piece = self.piece(first.column, token.end)
            if token.text not in wording.SAY_NOTHING and keys_of_name(piece.text):
                found, self.at = piece, i + 1
        return found

    def value(self) -> Token:
        """The value of a parameter as text: a literal, or an expression in brackets, which is not parsed here."""
        self.accept("=")
        first = self.next
        if first.text != "(":
            self.literal("value")
            last = self.tokens[self.at - 1]
        else:
            *_, last = self.bracketed()
        return self.piece(first.column, last.end)

    def start(self) -> tuple[Fraction | str, ...]:
        """Parse a state: one or more numbers, separated by commas, with or without brackets."""
        bracket = self.accept("(")
        found = [self.entry()]
        while self.accept(","):
            found.append(self.entry())
        if bracket:
            self.expect(")", "the bracket of a start is not closed")
        return tuple(found)

    def entry(self) -> Fraction | str:
        """An entry of a start: a literal, or as text a product with pi, e, exp or sqrt, such as -pi/4 or 2*sqrt(3)."""
        first, depth = self.next, 0
        for count, token in enumerate(self.tokens[self.at :]):
            depth += (token.text == "(") - (token.text == ")")
            before = self.tokens[self.at + count - 1]
            apart = count > 0 and token.column > before.end and not {token.text, before.text} & {*"*/-+"}
            if token.kind == END or depth < 0 or (not depth and (token.text in ",:" or apart)):
                break
        if not any(token.text in ("pi", "sqrt", "e", "exp") for token in self.tokens[self.at : self.at + count]):
            return self.literal("start")
        self.at += count
        return self.piece(first.column, self.tokens[self.at - 1].end).text

    def rates(self) -> tuple[Token, ...]:
        """The components of y' as texts, given in brackets and separated by commas."""
        if self.next.text != "(":
            raise self.error(self.next, "rates are written in brackets, separated by commas, as in (y1, -sin(y0))")
        first, *inside, last = self.bracketed()
        ends, depth = [first.end], 0
        for token in inside:
            depth += (token.text == "(") - (token.text == ")")
            ends += [token.column, token.end] if token.text == "," and not depth else []
        ends.append(last.column)
        return tuple(self.piece(*ends[i : i + 2]) for i in range(0, len(ends), 2))

    def leads(self, at: int) -> bool:
        """True if factors before a derivative, as in L*x' = ..., begin with the token of this index."""
        return not self.in_rate and _LEAD.match(self.text, self.tokens[at].column - 1) is not None

    def without_lead(self, first: Token) -> tuple[Token, str]:
        """The name behind the factors that begin with a token just taken, and these; itself and "" for none."""
        found = _LEAD.match(self.text, first.column - 1)
        while found and first.column <= found.end():
            first = self.take()
        return first, found[0].rstrip(" *") if found else ""

    def rate(self, lead: str = "") -> Token:
        """Parse what follows y' =, y'(t) =, dy/dt = or energy =, from before = on; a name in it begins no query.

        It is divided by the factors of the derivative, its `lead`.
        """
        prime = self.take()
        if self.next.text == "'":
            raise self.error(prime, "an equation has at most two primes; write y''' = y as y'=v, v'=a, a'=y")
        if self.accept("("):
            self.take(), self.expect(")", "a bracket is not closed")
        self.expect("=", "expected = and a rate, as in y'=-2*y")
        first, self.in_rate, self.numbers = self.next, True, ("t", "pi", *UNKNOWNS.findall(self.text))
        self.sum()
        self.in_rate, self.numbers = False, ()
        if self.next.kind == NAME and self.next.column == self.tokens[self.at - 1].end:
            raise self.error(
                self.next, f"{self.next.shown} is not an unknown or a function; write a product as t*y or t y"
            )
        found = self.piece(first.column, self.tokens[self.at - 1].end)
        return found._replace(text=f"({found.text})/({lead})") if lead else found

    def continues(self) -> bool:
        """Whether a rate continues with a factor, and no setting such as t=1 and no start such as y(0)=1 begins."""
        after, inside, closed = (self.after(self.at + i) for i in range(3))
        at = after.text == "(" and inside.kind == NUMBER and closed.text == ")"  # y(0), not y(1 - y)
        begins = after.text in ("=", "'") or after.kind == NUMBER or at
        return super().continues() and (self.next.text == "(" or not begins)

    def put(self, found: Any, name: Token, key: str, read: Callable[[], Any]) -> None:
        """Store under `key` what `read` returns; refuse a second one, and equations together with rates= or from."""
        if not isinstance(found, dict) or found.get(key, {}) != {}:
            raise self.error(name, f"{name.shown} is given twice")
        found[key] = read()

    def bracketed(self) -> list[Token]:
        """Consume and return the tokens from the next one, an opening bracket, to its closing bracket."""
        found, open_brackets = [self.take()], 1
        while open_brackets:
            token = self.take()
            if token.kind == END:
                raise self.error(found[0], "a bracket is not closed")
            open_brackets += (token.text == "(") - (token.text == ")")
            found.append(token)
        return found

    def piece(self, start: int, end: int) -> Token:
        """The text from column `start` to before column `end`, as a token."""
        return Token(NUMBER, self.text[start - 1 : end - 1], start)

    def literal(self, what: str) -> Fraction:
        """Parse a rational number such as 10, -1/4 or 0.25; errors call it `what`."""
        first = self.next
        sign = self.accept("-", "+")
        token = self.take()
        if token.kind == NUMBER and self.next.text in ("i", "j"):
            raise self.error(first, f"{what} must be real; |R(iy)|^2 is energy_multiplier METHOD h=y")
        if token.kind != NUMBER:
            own = f"; {OWN_PI}" if token.text == "pi" else ""
            raise self.error(token, f"{what}: expected a number such as 1/4 or 0.25, found {token.shown}{own}")
        text = (sign.text if sign else "") + token.text
        if self.next.text == "/" and self.next.column == token.end and self.tokens[self.at + 1].kind == NUMBER:
            self.take()
            token = self.take()
            text += f"/{token.text}"
        if self.next.kind != END and self.next.column == token.end and self.next.text not in "):,":
            has_pi = "pi" in (self.next.text, self.after(self.at).text)
            hint = "numbers have no units" if self.next.kind == NAME else "put brackets around the question"
            hint = OWN_PI if has_pi else hint
            raise self.error(self.next, f"unexpected {self.next.shown} in a number; {hint}")
        return self.rational(text, first)

    def readout(self) -> Token:
        """Parse the name of a readout, of one word or two, such as "phase error"."""
        if self.next.kind != NAME:
            what = "expected the name of a readout, such as q, after the colon"
            raise self.error(self.next, f"{what}; found {self.next.shown}")
        first = self.take()
        if (both := f"{first.text}_{self.next.text}") in wording.READOUT_WORDS:
            self.take()
            first = first._replace(text=both)
        return first._replace(text=wording.READOUT_WORDS.get(first.text, first.text))

    def after(self, at: int) -> Token:
        """The token after the one at this index; the end token follows itself."""
        return self.tokens[min(at + 1, len(self.tokens) - 1)]
