"""A text keeps the places of its characters when it is cut, joined and rewritten."""

import re

from driftproof.texts.readers.source_text import Insertion, SourceText, joined


def test_pieces_keep_their_places_when_they_are_cut_and_joined():
    source = SourceText.of("abcdef")
    text = joined([source[4:6], Insertion("-", 3), source[0:2]])
    assert (text.text, [text.origin(i) for i in range(5)]) == ("ef-ab", [4, 5, 3, 0, 1])
    assert [source[2:5].origin(i) for i in range(4)] == [2, 3, 4, 5]
    assert (source.origin(6), source[0:0].origin(0)) == (6, 0)


def test_new_text_stands_for_where_the_last_piece_ended_but_within_the_match():
    whole = SourceText.of("(cd)e").rewritten(re.compile(r".*\)"), lambda m: [m.span(), "!"])
    assert (whole.text, [whole.origin(i) for i in range(6)]) == ("(cd)!e", [0, 1, 2, 3, 3, 4])
    text = SourceText.of("ab(cd)e").rewritten(
        re.compile(r"\((.)(.)\)"), lambda m: ["<", m.span(2), "!", Insertion("c", 3)]
    )
    assert text.text == "ab<d!ce"
    assert [text.origin(i) for i in range(8)] == [0, 1, 2, 4, 5, 3, 6, 7]
    assert text.removed(re.compile("[ab]")).stripped().origin(0) == 2
