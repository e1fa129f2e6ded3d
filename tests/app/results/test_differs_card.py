"""The largest differences: at least three rows, each with its interval and its mark; and what is drawn of both."""

import datetime
import math
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QImage, QPainter
from pytestqt.qtbot import QtBot

from app.results.differs_card import HEAD, LEAST, MOST, ROW, DiffersCard
from app.summary.facts import Facts
from app.theme.current import current_theme
from app.widgets.table_cells import IntervalStrip, MarkCell, TextCell
from core.body import Joint, Side
from core.goals import Goal, GoalOf
from core.results import Analysis
from core.session import Session
from tests.app.changed_analysis import recalibrated, rewalked, visit_of, walk_of
from tests.app.reports.patient.test_what_stands_out import with_more
from tests.simulated import LONG_WALK, analysis_of, session_of

MINUS = "\N{MINUS SIGN}"


@pytest.fixture(scope="module")
def session() -> Session:
    return session_of(LONG_WALK)


@pytest.fixture(scope="module")
def analysis(session: Session) -> Analysis:
    return analysis_of(session)


@pytest.fixture
def card(qtbot: QtBot) -> DiffersCard:
    found = DiffersCard()
    qtbot.addWidget(found)
    found.resize(1016, 150)
    return found


def facts(session: Session, analysis: Analysis) -> Facts:
    return Facts(visit_of(analysis, session), walk_of(analysis))


def row(card: DiffersCard, name: str) -> tuple[object, ...]:
    card.set_room(1000, is_compact=False)
    return next(one.cells for one in card.table.cells.rows if one.cells[0].words == name)


def test_there_are_as_many_rows_as_fit_but_never_under_three(
    card: DiffersCard, session: Session, analysis: Analysis
) -> None:
    card.show_facts(facts(session, analysis))
    for height, rows in ((0, LEAST), (HEAD + 4 * ROW + 4, 4), (HEAD + 5 * ROW + 4, 5), (2000, MOST)):
        card.set_room(height, is_compact=False)
        assert card.table.cells.rowCount() == rows
        assert card.minimumSizeHint().height() <= max(height, HEAD + LEAST * ROW + 4)


def test_one_leg_has_no_differences(card: DiffersCard, session: Session, analysis: Analysis) -> None:
    card.show_facts(facts(session, analysis))
    assert card.has_rows
    alone = rewalked(analysis, gait={Side.RIGHT: walk_of(analysis).gait[Side.RIGHT]})
    card.show_facts(facts(session, alone))
    assert not card.has_rows


def test_what_is_beyond_healthy_people_comes_first_filled_and_within_error_has_no_circle(
    card: DiffersCard, session: Session, analysis: Analysis
) -> None:
    card.show_facts(facts(session, with_more(analysis, Side.LEFT, "knee_stance_to_swing_rad", -25.0)))
    marks = [one.cells[-1] for one in card.table.cells.rows]
    assert marks[0] == MarkCell("beyond 95 of 100", has_circle=True, is_filled=True)
    assert set(marks[1:]) == {MarkCell("within error")}
    assert card.table.cells.rows[0].cells[0].words == "Knee flexion, stance to swing"
    assert "Knee range of motion" not in card.table.as_text()  # which is the same movement


def test_beyond_error_alone_is_an_outlined_circle(card: DiffersCard, session: Session, analysis: Analysis) -> None:
    card.show_facts(facts(session, with_more(analysis, Side.LEFT, "knee_stance_to_swing_rad", -7.5)))
    assert row(card, "Knee flexion, stance to swing")[-1] == MarkCell("beyond error", has_circle=True)


def test_a_row_has_both_values_their_difference_and_its_interval(
    card: DiffersCard, session: Session, analysis: Analysis
) -> None:
    found = facts(session, analysis)
    card.show_facts(found)
    _, left, right, less, likely, strip, _ = row(card, "Knee flexion, stance to swing")
    column = "knee_stance_to_swing_deg"
    values = [found.value(side, column).mean for side in Side]
    assert [cell.words for cell in (left, right)] == [f"{value:.1f}°" for value in values]  # type: ignore[attr-defined] # cells are objects here
    assert isinstance(less, TextCell)
    assert less.words == f"{values[0] - values[1]:+.1f}°".replace("-", MINUS)
    assert isinstance(strip, IntervalStrip)
    low, high = (strip.difference + sign * strip.half for sign in (-1, 1))
    assert isinstance(likely, TextCell)
    assert likely.words == f"{low:+.0f}° to {high:+.0f}°".replace("-", MINUS)
    assert strip.difference == pytest.approx(values[0] - values[1])
    assert strip.spoken


def test_what_is_not_reported_comes_last_with_a_word_and_no_strip(
    card: DiffersCard, session: Session, analysis: Analysis
) -> None:
    gated = recalibrated(analysis, [Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(11.0))
    card.show_facts(facts(session, gated))
    assert all(not one.cells[0].words.startswith("Knee") for one in card.table.cells.rows)  # others are reported
    cells = [one.cells for one in card.rows]
    knees = [k for k, one in enumerate(cells) if one[0].words.startswith("Knee")]
    assert min(knees) > max(k for k, one in enumerate(cells) if isinstance(one[5], IntervalStrip))
    assert cells[knees[0]][5].words == "difference not reported"
    assert cells[knees[0]][6].words == ""


def test_goals_give_way_before_the_table_gets_wider_and_are_under_the_mouse(
    card: DiffersCard, session: Session, analysis: Analysis
) -> None:
    card.show_facts(facts(session, analysis))
    goals = tuple(
        Goal("knee_stance_to_swing_deg", of, 60.0, datetime.date(2026, 1, 1)) for of in (GoalOf.LEFT, GoalOf.RIGHT)
    )
    agreed = replace(session, patient=replace(session.patient, goals=goals))
    found = facts(agreed, analysis)
    bare = card.table.minimumSizeHint().width()
    card.show_facts(found)
    (first,) = (one for one in card.table.cells.rows if one.cells[0].words.startswith("Knee flexion, stance to swing"))
    assert first is card.table.cells.rows[0]
    assert "goal L 60" in first.cells[0].words
    assert "goal R 60" in first.hint
    assert card.table.minimumSizeHint().width() <= bare + 20


def painted(strip: IntervalStrip) -> QImage:
    image = QImage(146, 28, QImage.Format.Format_RGB32)
    image.fill(QColor(current_theme().colours.surface))
    painter = QPainter(image)
    strip.paint(painter, QRectF(0, 0, 146, 28), current_theme())
    painter.end()
    return image


def is_ink(image: QImage, x: float, y: int) -> bool:
    return abs(image.pixelColor(int(x), y).lightness() - QColor(current_theme().colours.ink).lightness()) < 60


def test_dot_whisker_and_zone_lie_where_their_numbers_are() -> None:
    """Half a strip is 73 - 5 px for the scale: 68 px for 10."""
    image = painted(IntervalStrip(5.0, 3.0, 2.0, 10.0))
    surface, zone = QColor(current_theme().colours.surface), QColor(current_theme().colours.band_2sd)
    centre = 73.0
    assert is_ink(image, centre + 34, 14)  # the dot
    for end in (2.0, 8.0):
        assert is_ink(image, centre + 6.8 * end, 12)  # the whisker's ends are upright
    assert is_ink(image, centre + 6.8 * 3.0, 14)
    assert not is_ink(image, centre + 6.8 * 8.0 + 4, 14)
    assert not is_ink(image, centre + 6.8 * 2.0 - 5, 14)
    assert image.pixelColor(round(centre - 6.8 * 2.0 + 2), 8) == zone
    assert image.pixelColor(round(centre + 6.8 * 2.0 - 3), 8) == zone
    assert image.pixelColor(round(centre - 6.8 * 2.0 - 3), 8) == surface


def test_a_difference_beyond_its_interval_has_the_larger_dot() -> None:
    def dot(difference: float) -> int:
        image = painted(IntervalStrip(difference, 3.0, math.nan, 10.0))
        x = round(73 + 6.8 * difference)
        return sum(is_ink(image, x, y) for y in range(28))

    assert dot(5.0) > dot(2.0)


def test_what_reaches_beyond_an_edge_ends_there_and_what_is_not_known_is_not_drawn() -> None:
    beyond = painted(IntervalStrip(30.0, 40.0, math.nan, 10.0))
    assert is_ink(beyond, 73 + 68, 14)
    assert is_ink(beyond, 73 - 68, 12)
    nothing = painted(IntervalStrip(math.nan, math.nan, math.nan, 10.0))
    assert not any(is_ink(nothing, x, y) for x in range(146) for y in range(28) if abs(x - 73) > 2)
