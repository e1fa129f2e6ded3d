"""A text that wraps keeps a unit in one line, and states what it was reported."""

import pytest
from pytestqt.qtbot import QtBot

from app.widgets.text import Text


@pytest.mark.parametrize("unit", ["m/s", "m/s²", "°/s"])
def test_a_unit_is_not_broken(qtbot: QtBot, unit: str) -> None:
    whole, broken = (Text(f"Geschwindigkeit 1,18{space}{word}", wraps=True) for space, word in (
        ("\N{NO-BREAK SPACE}", unit), ("\N{NO-BREAK SPACE}", unit.replace("/", "/ "))
    ))  # fmt: skip
    for text in (whole, broken):
        qtbot.addWidget(text)
    assert whole.text() == f"Geschwindigkeit 1,18\N{NO-BREAK SPACE}{unit}"
    width = whole.fontMetrics().horizontalAdvance(whole.text()) - 4  # too narrow by less than the unit
    assert broken.heightForWidth(width) > whole.fontMetrics().height()
    lines = whole.heightForWidth(width) / whole.fontMetrics().height()
    assert round(lines) == 2, "goes into the next line with its figure"


def test_words_with_a_stroke_are_broken_as_ever(qtbot: QtBot) -> None:
    text = Text("steps/step or m/s", wraps=True)
    qtbot.addWidget(text)
    assert super(Text, text).text() == "steps/step or m/\N{WORD JOINER}s"
    text.setWordWrap(False)
    text.setText("1.18 m/s")
    assert super(Text, text).text() == "1.18 m/s"
