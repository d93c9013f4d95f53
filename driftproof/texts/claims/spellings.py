"""How a text spells a number: its form, the spelling of values, their telling digits, and what one slip makes of it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from driftproof.texts.claims.phrases import WORDS, NumberForm
from driftproof.texts.readers.numbers import TextNumber


def form_of(number: TextNumber, text: str = "") -> NumberForm:
    """The form in which the text writes the number; a whole number is rounded as a percentage or a ratio."""
    if number.is_worded:
        return NumberForm(spelled=WORDS)
    if "/" in number.text:
        return NumberForm(exact=True)
    if number.places is None or (not number.places and text.startswith(("%", " %", " times "), number.end)):
        return NumberForm(digits=len(digits_of(number.text)))
    return NumberForm(places=number.places or None)


def spelled(number: TextNumber) -> str:
    """The number as values are spelled: 3.3e-4 for 3.3×10^{-4}, 0.5 for .5, without a plus and without groups."""
    spelled = re.sub(r" ?[×·] ?10\^\{?(-?[0-9]+)\}?", r"e\1", number.text.replace(",", "").lstrip("+"))
    return re.sub(r"^(-?)\.", r"\g<1>0.", re.sub(r"[eE](-?)\+?0*(?=[0-9])", r"e\1", spelled))


def slips(spelled: str) -> Iterator[str]:
    """What was meant if the sign is wrong, first, or if one digit is wrong, or two neighbours are exchanged."""
    yield spelled[1:] if spelled.startswith("-") else f"-{spelled}"
    digits = [i for i, sign in enumerate(spelled) if sign.isdigit()]
    for i, j in pairwise(digits):
        if spelled[i] != spelled[j]:
            yield spelled[:i] + spelled[j] + spelled[i + 1 : j] + spelled[i] + spelled[j + 1 :]
    for i in digits:
        yield from (spelled[:i] + new + spelled[i + 1 :] for new in "0123456789" if new != spelled[i])


def digits_of(text: str, telling: bool = False) -> str:
    """The significant digits of a number; with `telling`, without the zeros of a final .0 or final 00 after the point.

    A round value such as 4.000 is likelier than one in 9000. A number that a text chooses, such as 1000, may have any
    zeros at its end, so a draft asks for its digits without them.
    """
    mantissa = re.split(r"[eE]| ?[×·]", text)[0]
    mantissa = re.sub(r"(?<=\.)0$|00+$", "", mantissa) if telling and "." in mantissa else mantissa
    return re.sub(r"[^0-9]", "", mantissa).lstrip("0")
