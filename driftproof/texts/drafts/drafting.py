"""Draft a claims file from the values that the numbers of a text look like, for its author to complete."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

from driftproof.support.plain_text import counted
from driftproof.texts.claims.checking import Span, places_of
from driftproof.texts.claims.claims import MOST_CLAIMS, Claim, parse_claims
from driftproof.texts.claims.listings import listings_in
from driftproof.texts.claims.phrases import Phrase, digits_of
from driftproof.texts.drafts.members import SLIP, Group, Member, groups, of_one_method, problems_named_once, uncovered
from driftproof.texts.drafts.phrase_search import PhraseSearch, as_phrase, placeholders
from driftproof.texts.drafts.suggestions import Missed, Suggestions
from driftproof.texts.questions.decimals import HALF_EVEN, Style
from driftproof.texts.readers.document import Document
from driftproof.texts.readers.number_words import words_said_in
from driftproof.texts.readers.numbers import TextNumber, numbers_in
from driftproof.texts.words.method_names import methods_asked, methods_named, starters_said, starts_said
from driftproof.texts.words.stated_facts import Said, properties_in
from driftproof.texts.words.stated_problems import equations_in, parameters_in
from driftproof.texts.words.tables import Address

# A claim with longer questions takes its phrase as its id.
_LONGEST_ID = 80
# Significant digits shown of a value that the text does not contain, and the numbers that are named beside it.
_SHOWN_DIGITS, _MOST_PLACES = 8, 3
# Chosen: questions read from the text that are shown; they differ in methods and step sizes.
_MOST_READ = 12
# What a draft calls perhaps wrong.
_DOUBT = re.compile(rf"(?m)^# ((?:cell [0-9]+, )?line [0-9]+)(?: of its output)?: (.+?) {SLIP} (.+)$")
# What it says of a table without a right number.
_OF_TABLE = "numbers of this table are off:"
_ENERGY = re.compile("(energy=[^=]+), h=")
_BELOW = re.compile(r"(?m)^(?:# ?)?\[\[claim\]\]\n(?:.+\n?)+")
_HEADER = """\
# Claims drafted by `driftproof check --init {name}`. Each phrase occurs in the text as often as its count says.
# A number that looks like a value need not mean that value: read each claim. Numbers that look like no value, or
# hardly like one, are comments: ask for the value (`driftproof value --help` shows how), or say why the number is
# given. What the text chooses, as in h = 0.1, is marked as given. If the text solves a problem of its own, say which
# one if it is not read from the text, and its numbers are drafted as well; the option may be repeated:
# --ask "run heun2 y'=-y, y(0)=1, h=0.1, t=1 : {{y,exact.y,error}}"
"""


class Doubt(NamedTuple):
    """What the draft called perhaps wrong in this line, what it said of it, and the claim whose phrase has it."""

    line: str
    words: str
    said: str
    claim: Claim | None

    def place(self, document: Document, uncovered: Iterable[TextNumber]) -> TextNumber | None:
        """The words where they stand now: one of the uncovered numbers, if any in the claim's phrase, or a sentence."""
        flat = document.text.text.replace("\n", " ")
        if " " in self.words and self.words in flat:
            return TextNumber(at := flat.index(self.words), at + len(self.words), self.words, None)
        places = places_of(document, self.claim, self.words) if self.claim else None
        words = [TextNumber(*word, None) for word in words_said_in(document.text.text)]
        found = [x for x in (*uncovered, *words) if x.text == self.words and (places is None or x.start in places)]
        numbers = re.compile("[0-9]+")

        def apart(x: TextNumber) -> list[int]:
            places = map(numbers.findall, (document.place(x.start), self.line))
            return [abs(int(a) - int(b)) for a, b in zip(*places, strict=False)]

        return min(found, key=apart, default=None)


def draft(document: Document, name: str, asked: Iterable[str] = ()) -> str:
    """The draft of a claims file for the text called `name`, with one claim for each group of uncovered numbers.

    The `asked` questions whose values the text does not contain are listed at the end. Raises ValueError if there would
    be more claims than a file may have, and for a question without an answer.
    """
    text = document.text.text
    printed = [(one.program.text, document.span(one.printed)) for one in listings_in(document) if one.printed]
    suggestions, ids = Suggestions(text, asked, printed), Counter[str]()
    members, inputs = _members(document, suggestions)
    drafted = [_HEADER.format(name=" ".join(name.split())), *_read_from(document, suggestions, members, ids)]
    drafted += [*_tables_off(document, suggestions), *_properties(document, ids)]
    for claim in _of_groups(document, suggestions, members, inputs, ids):
        if len(drafted) > MOST_CLAIMS:
            raise ValueError(f"claims for more than {MOST_CLAIMS} groups of numbers are not drafted")
        drafted.append(claim)
    drafted += _not_found(document, suggestions)
    if inputs:
        drafted.append(f"# Left out: numbers in program code, {len(inputs)} in all; they are inputs, not claims.\n")
    return "\n".join(drafted).rstrip("\n")


def _members(document: Document, suggestions: Suggestions) -> tuple[list[Member], list[Member]]:
    """The numbers and words of the text that may be claims, and the inputs of its programs, which are none."""
    text = document.text.text
    equations, letters = _equation_at(text), parameters_in(text)
    numbers = [*(x for x in numbers_in(text) if x.label is None), *suggestions.words]
    members = [Member.of(x, suggestions, text, equations, letters) for x in sorted(numbers, key=lambda one: one.start)]
    code = {at for span in document.code for at in range(*span)}
    # A single digit of a program, such as an initial 1.0 or a number of turns, looks like too much to be a value.
    in_code = [m for m in members if m.number.start in code]
    inputs = [m for m in in_code if not (m.strong and len(digits_of(m.number.text).rstrip("0")) > 1)]
    return [member for member in members if member not in inputs], inputs


def _equation_at(text: str) -> dict[int, Span]:
    """For each place in an equation, where that begins and ends."""
    return {at: span for span in equations_in(text) for at in range(*span)}


def _read_from(
    document: Document, suggestions: Suggestions, members: Sequence[Member], ids: Counter[str]
) -> Iterator[str]:
    """What was read from the text: questions, wrong words for what starts a method, and equations that it chooses."""
    text, questions = document.text.text, suggestions.values.stated
    if not questions:
        return
    shown = [f"# --ask {_quoted(one)}\n" for one in questions[:_MOST_READ]]
    more = f"# and {rest} more\n" if (rest := len(questions) - _MOST_READ) > 0 else ""
    yield f"# Read from the text:\n{''.join(shown)}{more}{''.join(_energies_not_kept(suggestions))}"
    held = {by for one in members if one.strong for by in re.findall(r" started=(\w+)", one.alike[0].question)}
    starts = {*starts_said(text.lower())} if any(" started=" in x for x in questions) else set()
    others = _other_starts(document, starts, held)
    for start, end in sorted(others):
        words, at = as_phrase(text[start:end].strip()), document.place(start)
        yield f"# {at}: {words} {SLIP} what starts the values held is {', '.join(sorted(held))}\n"
    equations = _equation_at(text)
    with_numbers = {equations.get(x.start, (0, 0)) for x in numbers_in(text) if x.label is None}
    yield from _given(text, ({*equations.values()} - with_numbers) | (starts - others), ids)


def _energies_not_kept(suggestions: Suggestions) -> Iterator[str]:
    """What is said of each energy of the text that its own equations change, as one with a wrong sign."""
    remarks = dict[str, str]()
    for each in suggestions.values.known:
        if each.answer.remark and (found := _ENERGY.search(each.question)):
            remarks[found[1]] = each.answer.remark
    yield from (f"# {energy}: {said}; if it should, one of the two is wrong\n" for energy, said in remarks.items())


def _other_starts(document: Document, starts: set[Span], held: set[str]) -> set[Span]:
    """The places in prose that say what starts a method, if none of them names what starts the values `held`."""
    code = {at for span in document.code for at in range(*span)}
    prose = {span for span in starts if span[0] not in code}
    said = chain.from_iterable(starters_said(document.text.text[slice(*span)].lower()) for span in prose)
    return prose if held and held.isdisjoint(said) else set()


def _tables_off(document: Document, suggestions: Suggestions) -> Iterator[str]:
    """The tables of the text that have no right number."""
    for off, known in suggestions.tables_off():
        said = f"all {len(off)} {_OF_TABLE} {off[0].text} is not {known.question}"
        yield f"# {document.place(off[0].start)}: {said}; are the problem, h and t those of the text?\n"


def _of_groups(
    document: Document,
    suggestions: Suggestions,
    members: list[Member],
    inputs: Sequence[Member],
    ids: Counter[str],
) -> Iterator[str]:
    """The claims of the groups of numbers, each with the other places where its phrase stands."""
    text, covered = document.text.text, set[int]()
    search = PhraseSearch(text)
    fences = sorted({0, len(text), *(at for one in inputs for at in (one.number.start, one.number.end))})
    grouped = [of_one_method(group) for group in groups(text, members, fences)]
    questions = {member.number.start: member.alike[0].question for member in chain(*grouped) if member.strong}
    for *room, group in uncovered(grouped, fences, covered):
        first = group[0].number
        line = document.place(first.start)
        place = f"{line}, column {document.position(first.start).column}" if not document.cells else line
        phrase, stands, address = search.phrase(room, group)
        meant = [[questions.get(at + member.number.start - first.start) for member in group] for at in stands]
        if any(one != meant[0] for one in meant):  # the same words and numbers elsewhere do not mean the same
            group = [replace(member, strong=False) for member in group]
            phrase, stands, address = search.phrase(room, group, bound=True)
        covered |= {at + member.number.start - first.start for at in stands | {first.start} for member in group}
        if stands:
            there = " ".join((phrase, *address[:2], *address.columns))
            methods = _methods(group, there, suggestions) if len(stands) == 1 else []
            yield _claim(group, phrase, len(stands), place, ids, methods, address)
        else:
            slips = [member.remark(line) for member in group if member.slips]
            yield "".join([*slips, f"# {place}: no phrase can be drafted for {first.text}\n"])


def _not_found(document: Document, suggestions: Suggestions) -> Iterator[str]:
    """What the author asked for and the text does not have, or only perhaps, and what was not asked."""
    missed = sorted(suggestions.nowhere(), key=lambda one: not one[2])
    for guessed, why in enumerate(("but not found in the text", "and found only as a guess, a comment above")):
        if lines := [_asked_line(document, one) for one in missed if bool(one[3] and not one[2]) == guessed]:
            yield f"# Asked for with --ask, {why}:\n{''.join(lines)}"
    for why, those in suggestions.values.not_asked.items():
        if those:
            yield f"# Not asked, because {why}: {len(those)}, such as {next(iter(those))}\n"


def doubts_of(claims: str) -> list[Doubt]:
    """What a drafted claims file calls perhaps a slip, each with the claim below it, a comment or not, that has it."""
    found = list[Doubt]()
    for doubt in _DOUBT.finditer(claims):
        own, below = list[Claim](), _BELOW.search(claims, doubt.end())
        with suppress(ValueError):
            own += parse_claims(re.sub("(?m)^# ?", "", below[0])).claims if below else ()
        has_it = own and not own[0].phrase.names and doubt[2] in own[0].phrase.free_numbers_and_words
        found.append(Doubt(doubt[1], doubt[2], doubt[3], own[0] if has_it else None))
    return found


def lines_to_look_at(claims: str, name: str) -> list[str]:
    """What a drafted claims file for the text called `name` asks its reader to look at, in lines."""
    doubtful = (x for x in claims.splitlines() if x[:1] == "#" and any(said in x for said in (SLIP, _OF_TABLE)))
    slips = [f"  {line[2:]}\n" for line in doubtful]
    return [f"{name}: {counted(len(slips), 'number')} to look at:\n", *problems_named_once(slips)] if slips else []


def _given(text: str, spans: set[Span], ids: Counter[str]) -> Iterator[str]:
    """Claims that equations without numbers, and what starts a multistep method, stand in the text as they do."""
    for phrase in dict.fromkeys(as_phrase(text[start:end].strip()) for start, end in sorted(spans)):
        with suppress(ValueError):  # too long
            if count := len(Phrase.of(phrase).exact({}).findall(text)):
                yield "\n".join([*_entry(phrase, ids, phrase, count), 'given = "the text chooses it"', ""])


def _properties(document: Document, ids: Counter[str]) -> Iterator[str]:
    """Claims of the properties that the text says methods have, and of the others that they are perhaps slips."""
    text, of_phrases = document.text.text, dict[str, list[Said]]()
    for said in properties_in(text):
        of_phrases.setdefault(said.phrase, []).append(said)
    for said in chain(*of_phrases.values()):
        if not said.holds:
            so, line = "no" if said.answer == "yes" else "yes", document.place(said.start)
            yield f"# {line}: {said.phrase} {SLIP} {said.question} is {so}\n"
    for phrase, found in of_phrases.items():
        said_so = Phrase.of(as_phrase(phrase))
        count, given = len(said_so.exact({}).findall(text)), 'given = "said of the method, not of the property"'
        for said in found if count and all(one.holds for one in found) else ():
            lines = [*_entry(phrase, ids, as_phrase(phrase), count), f"value = {_quoted(said.question)}"]
            lines += ['answer = "no"'] * (said.answer == "no") + [given] * bool(said_so.free_numbers)
            yield "\n".join([*lines, ""])
            if count > 1:
                break


def _methods(group: Group, phrase: str, suggestions: Suggestions) -> list[str]:
    """The methods of the values of a group, or the one of all, if the text names them there, and not in the phrase."""
    strong = [member for member in group if member.strong]
    asked = [methods_asked(member.alike[0].question) for member in strong]
    row = suggestions.tables.row_of(strong[0].number) if strong else []
    if not strong or any(len(keys) != 1 for keys in asked) or (row and any(keys != asked[0] for keys in asked)):
        return []
    keys, said = [key for (key,) in asked], phrase.lower()
    label = next((cell.text for cell in row if keys[0] in methods_named(cell.text)), "")
    is_said = {*keys} <= methods_named(said) and label in said
    named = all(key in suggestions.methods_at(member.number) for key, member in zip(keys, strong, strict=True))
    return [] if is_said or not named else keys if len({*keys}) > 1 else keys[:1]


def _claim(
    group: Group, phrase: str, count: int, place: str, ids: Counter[str], methods: list[str], address: Address
) -> str:
    """The claim of a group, with remarks; a comment with its `place` as id if its numbers are only guessed."""
    head, line = group[0], place.partition(", column")[0]
    valued, chosen = any(member.strong for member in group), head.chosen
    if valued or chosen:
        asked = ", ".join(member.alike[0].question for member in group if member.strong)
        place = asked if asked and len(asked) <= _LONGEST_ID else phrase
    lines = _entry(place, ids, phrase, count)
    lines += [f"{x} = {_quoted(said)}" for x, said in zip(("row", "column"), address[:2], strict=True) if said]
    lines += [f"column = [{', '.join(map(_quoted, address.columns))}]"] * bool(address.columns)
    if valued or chosen:
        lines += _values([member for member in group if member.strong]) if valued else []
        lines += [f"method = {json.dumps(methods if methods[1:] else methods[0])}"] if methods else []
        lines += ['given = "the text chooses it"'] * chosen
    else:
        lines = [f"# {line}" for line in ("TODO", *lines, 'given = "TODO: why"')]
    return "".join([*dict.fromkeys(member.remark(line) for member in group), *(f"{line}\n" for line in lines)])


def _entry(name: str, ids: Counter[str], phrase: str, count: int) -> list[str]:
    """The first lines of a claim of this name, which has a number if others have it, and of its phrase."""
    ids[name] += 1
    name += f" ({ids[name]})" if ids[name] > 1 else ""
    return ["[[claim]]", f"id = {_quoted(name)}", f"phrase = {_quoted(phrase)}", *[f"count = {count}"] * (count > 1)]


def _asked_line(document: Document, missed: Missed) -> str:
    """The line of an asked value without a claim: the value, and at most _MOST_PLACES numbers that may mean it."""
    question, answer, slips, vague = missed
    shown = "whose digits take more bits than a draft does"  # such as log2 of the ratio of two equal errors
    with suppress(ValueError):
        shown = answer.digits(_SHOWN_DIGITS, Style(HALF_EVEN)) if answer.is_number else str(answer.exact_text)
    shown = shown if "e" in shown else re.sub(r"(\.[0-9]*?)0+\Z", r"\1", shown).removesuffix(".")
    found = dict.fromkeys(f"{x.text} in {document.place(x.start)}" for x in slips or vague)
    places = [*found][:_MOST_PLACES]
    return f"#   {question}, {shown}{(bool(places) * ('; a slip? ' if slips else '; perhaps ')) + ', '.join(places)}\n"


def _values(group: Group) -> list[str]:
    best = []
    for alike, *_ in (member.alike for member in group):
        sizes = (("places", alike.form.places), ("digits", alike.form.digits))
        form = (
            [f'spelled = "{alike.form.spelled}"'] * bool(alike.form.spelled)
            + ["exact = true"] * alike.form.exact
            + [f"{key} = {n}" for key, n in sizes if n is not None]
        )
        best.append((_quoted(alike.question), form))
    if len(best) == 1:
        return [f"value = {best[0][0]}", *best[0][1]]
    tables = [f"{{ {', '.join([f'ask = {question}', *form])} }}" if form else question for question, form in best]
    return [f"values = {{ {', '.join(map('{} = {}'.format, placeholders(group), tables))} }}"]


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
