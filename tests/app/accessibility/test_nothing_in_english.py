"""Tests that in German nothing in sight or read by a screen reader is still in English.

They cover every page of a visit and all others that are filled.

A sentence is found that `tr` did not pass: it is in the catalogue and its German states otherwise. So is what never
was in the catalogue, by the little words that every English sentence has.
"""

import re
from collections.abc import Iterator
from string import Formatter

import pytest
from PySide6.QtWidgets import QAbstractButton, QComboBox, QLabel, QLineEdit, QWidget
from pytestqt.qtbot import QtBot

from app.widgets.table import CellTable
from app.wording.translation import use_language
from tests.app.accessibility.framed_pages import FRAMED, framed
from tests.app.results.filled_pages import PAGES
from tests.app.room import settle
from tests.app.test_german import ENGLISH, pairs

FEWEST_LETTERS = 6  # beside the fields of a message: fewer report no language
# what the tests themselves fill in as typed, read or stated elsewhere
FILLED_IN = re.compile(
    "|".join(
        [
            *("Shoes", "Barefoot", "Aids", "Device", "Alignment [A-C](, B, C)?", "Replay", "batch of 2026"),
            *(r"male · left prosthetic", r"3 sessions", r"3 recordings", r"Serial ports", "Repeat one leg"),
            *("The clinic's server does not respond", "Change direction.", "Stopping now .* absolute angles."),
            *("column acc_x_m_s2. is missing", "Write the file as FORMATS says it."),
        ]
    )
)


@pytest.fixture(autouse=True)
def german() -> Iterator[None]:
    use_language("de")
    yield
    use_language("en")


def stated_on(page: QWidget) -> Iterator[str]:
    """Everything that a page shows or gives who receives it."""
    for widget in [page, *page.findChildren(QWidget)]:
        yield from (widget.accessibleName(), widget.accessibleDescription(), widget.toolTip())
        if isinstance(widget, (QLabel, QAbstractButton)):
            yield widget.text()
        elif isinstance(widget, QComboBox):
            yield from (widget.itemText(row) for row in range(widget.count()))
        elif isinstance(widget, QLineEdit):
            yield widget.placeholderText()
        elif isinstance(widget, CellTable):
            yield from (cell.words for row in widget.cells.rows for cell in row.cells)
        if hasattr(widget, "painted_texts"):
            yield from (text.text for text in widget.painted_texts())


def known_english() -> list[re.Pattern[str]]:
    """What the catalogue states in English and otherwise in German, each as what its fields may be filled into."""
    found = []
    for pair in pairs():
        parts = [(literal, field) for literal, field, _, _ in Formatter().parse(pair.english)]
        letters = sum(letter.isalpha() for literal, _ in parts for letter in literal)
        if pair.english != pair.german and letters >= FEWEST_LETTERS:
            found.append(re.compile("".join(re.escape(literal) + (".+?" if field else "") for literal, field in parts)))
    return found


def english_in(stated: set[str]) -> list[str]:
    required = {FILLED_IN.sub("", text) for text in stated}
    known = known_english()
    german = {re.sub(r"\{[^}]*\}", "", pair.german) for pair in pairs()}
    return sorted(
        text for text in required - german if ENGLISH.search(text) or any(pattern.fullmatch(text) for pattern in known)
    )


@pytest.mark.endurance
def test_nothing_on_a_page_is_in_english(qtbot: QtBot) -> None:
    stated: set[str] = set()
    for name in FRAMED:
        shell = framed(name)
        qtbot.addWidget(shell)
        shell.resize(1280, 800)
        shell.show()
        settle()
        stated |= set(stated_on(shell))
        shell.close()
    for name in PAGES.keys() - FRAMED.keys():
        page = PAGES[name]()
        qtbot.addWidget(page)
        page.show()
        settle()
        stated |= set(stated_on(page))
        page.close()
    assert len(stated) > 500
    assert english_in(stated) == []


def test_what_is_in_english_is_found() -> None:
    assert english_in({"Knie links", "No walks yet.", "12 strides", "Is it so?", "Shoes", "12 Doppelschritte"}) == [
        "12 strides",
        "Is it so?",
        "No walks yet.",
    ]
