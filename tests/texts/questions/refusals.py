"""How a question is refused, for several test files."""

import pytest

from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value


def require_refusal(question, column, reason):
    """It is refused in one line that names the column and what is allowed."""
    with pytest.raises(QuestionError) as caught:
        value(question).digits(6)
    assert reason in caught.value.reason
    assert caught.value.column == column
    assert "\n" not in str(caught.value)
    assert f"column {column}: " in str(caught.value)
