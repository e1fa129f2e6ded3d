"""The sentence over the results: letters shrink, last sentences go, and nothing is lost to who asks for it."""

import pytest
from PySide6.QtGui import QFontMetrics
from pytestqt.qtbot import QtBot

from app.results.headline_text import SECOND, SIZES, SPARE, HeadlineText
from app.theme.current import current_theme
from app.widgets.text import SEMIBOLD

FIRST = "Left knee flexes 53° from stance to swing, up 18° since 1 July."
BESIDE = (
    "Likely between 9° and 27°.",
    "About 6° of it goes with walking 0.43 m/s faster.",
    "Since 23 September: +5°, within measurement error.",
)


@pytest.fixture
def headline(qtbot: QtBot) -> HeadlineText:
    found = HeadlineText()
    qtbot.addWidget(found)
    found.resize(1016, 50)
    found.show()
    found.show_sentences(FIRST, BESIDE)
    return found


def width_of(text: str, size: int, *, is_first: bool) -> int:
    theme = current_theme()
    return QFontMetrics(theme.font(size, SEMIBOLD) if is_first else theme.font(size)).horizontalAdvance(text)


def test_where_there_is_room_all_of_it_is_shown_in_large_letters(headline: HeadlineText) -> None:
    assert headline.first.font().pixelSize() == SIZES[0]
    assert headline.shown == " ".join(BESIDE)


@pytest.mark.parametrize("size", SIZES)
def test_letters_shrink_as_far_as_the_sentence_needs_and_no_further(headline: HeadlineText, size: int) -> None:
    headline.resize(width_of(FIRST, size, is_first=True) + SPARE, 50)
    assert headline.first.font().pixelSize() == size


def test_a_sentence_that_is_longer_still_takes_two_lines(headline: HeadlineText) -> None:
    headline.resize(400, 80)
    assert headline.first.font().pixelSize() == SIZES[-1]
    assert headline.first.wordWrap()
    assert headline.first.heightForWidth(400) > headline.first.heightForWidth(1016)


@pytest.mark.parametrize("count", [3, 2, 1])
def test_the_last_sentence_goes_first_and_the_first_one_stays(headline: HeadlineText, count: int) -> None:
    shown = " ".join(BESIDE[:count])
    headline.resize(width_of(shown, SECOND, is_first=False) + SPARE, 50)
    assert headline.shown == shown
    headline.resize(60, 50)
    assert headline.shown == BESIDE[0]


def test_the_tooltip_and_the_accessible_name_have_every_sentence(headline: HeadlineText) -> None:
    headline.resize(300, 80)
    assert headline.toolTip() == headline.accessibleName() == headline.text == " ".join([FIRST, *BESIDE])


def test_room_brings_sentences_back(headline: HeadlineText) -> None:
    headline.resize(200, 80)
    headline.resize(1016, 50)
    assert headline.shown == " ".join(BESIDE)


def test_without_anything_beside_it_there_is_no_second_line(headline: HeadlineText) -> None:
    headline.show_sentences(FIRST)
    assert not headline.second.isVisible()
    assert headline.text == FIRST
