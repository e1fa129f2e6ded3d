"""Tests of the manual's films:

they move, stop, and fit in a longer language. They keep still for users for whom nothing should move.
"""

import math
from itertools import pairwise

import pytest
from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.films.film import SCENE_S, SCENES, Film, captions, duration_s, film_height, paint_frame, paint_stills
from app.films.free_motion import BEND, CIRCLE, FOOT, LENGTHS_M, OTHER_WAY, leg_m
from app.help import help_reader
from app.help.help_page import HelpPage
from app.help.help_topics import Topic
from app.help.topic_text import plain_words_of
from app.theme.current import current_theme, set_scale
from app.theme.theme import Theme
from app.wording.translation import tr, use_language
from core.body import Side

WIDTH = 700.0


def frame(film: Film, time_s: float, theme: Theme) -> QImage:
    rect = QRectF(0, 0, WIDTH, film_height(WIDTH, is_moving=True))
    image = QImage(rect.size().toSize(), QImage.Format.Format_RGB32)
    image.fill(0)
    painter = QPainter(image)
    paint_frame(painter, rect, theme, film, time_s)
    painter.end()
    return image


@pytest.fixture
def page(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> HelpPage:
    """A help page where things may move, whatever the machine of the test was asked for."""
    monkeypatch.setattr(help_reader, "duration_ms", lambda usual_ms, _theme: usual_ms)
    page = HelpPage()
    page.resize(1064, 672)
    qtbot.addWidget(page)
    with qtbot.waitExposed(page):
        page.show()
    return page


@pytest.mark.parametrize("film", Film)
def test_every_scene_moves_and_differs_from_the_one_before(film: Film) -> None:
    count = len(SCENES[film])
    early = [frame(film, (k + 0.1) * SCENE_S, current_theme()) for k in range(count)]
    late = [frame(film, (k + 0.3) * SCENE_S, current_theme()) for k in range(count)]
    assert all(one != other for one, other in zip(early, late, strict=True))
    assert all(one != other for one, other in zip(late, early[1:], strict=False))
    assert frame(film, duration_s(film), current_theme()) == frame(film, duration_s(film) + 1, current_theme())


def test_limbs_keep_their_lengths_and_circles_go_both_ways() -> None:
    for scene in (BEND, CIRCLE, OTHER_WAY, FOOT):
        for turn in (0.0, 0.2, 0.7, 1.3):
            points = leg_m(Side.LEFT, scene, turn)
            assert [math.dist(*ends) for ends in pairwise(points)] == pytest.approx(LENGTHS_M)
    one_way, other_way = leg_m(Side.LEFT, CIRCLE, 0.2)[2], leg_m(Side.LEFT, OTHER_WAY, 0.2)[2]
    assert (one_way[0], one_way[1]) == pytest.approx((0.84 - other_way[0], other_way[1]))


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("topic", [Topic.SENSORS, Topic.FREE_MOTION])
def test_the_scenes_of_a_film_are_in_words_below_it(page: HelpPage, topic: Topic, language: str) -> None:
    use_language(language)
    try:
        page.show_topic(topic)
        film = Film.SENSOR_PLACEMENT if topic is Topic.SENSORS else Film.FREE_MOTION
        lines = page.text.toPlainText().replace("\u2028", "\n").splitlines()
        stated = [f"{k}. {tr(scene.title)}: {tr(scene.words)}" for k, scene in enumerate(SCENES[film], start=1)]
        at = lines.index(stated[0])
        assert lines[at : at + len(stated)] == stated
        assert tr(SCENES[film][0].words).casefold() in plain_words_of(topic)  # so that the search finds it
    finally:
        use_language("en")


def test_captions_have_the_words_of_every_scene() -> None:
    for film in Film:
        assert captions(film).count("\n") == len(SCENES[film]) - 1
        assert [scene for scene in SCENES[film] if scene.words not in captions(film)] == []


def scroll_to_film(page: HelpPage) -> QPoint:
    """Bring the film into sight, and give a point of it in the viewport."""
    bar, layout = page.text.verticalScrollBar(), page.text.document().documentLayout()
    for value in range(0, bar.maximum() + 1, 50):
        bar.setValue(value)
        point = QPoint(100, 200)
        if layout.imageAt(QPointF(point.x(), point.y() + bar.value())).startswith("films/"):
            return point
    raise AssertionError("there is no film on the page")


def test_a_film_plays_once_and_space_or_a_click_stops_it_and_plays_it_again(
    page: HelpPage, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    page.show_topic(Topic.FREE_MOTION)
    assert page.text.is_playing
    page.focus()
    states = []
    QTest.keyClick(page.text, Qt.Key.Key_Space)
    states.append(page.text.is_playing)
    point = scroll_to_film(page)
    for where in (point, QPoint(100, 2), point, point):
        QTest.mouseClick(page.text.viewport(), Qt.MouseButton.LeftButton, pos=where)
        states.append(page.text.is_playing)
    assert states == [False, True, True, False, True]
    monkeypatch.setattr(help_reader, "duration_s", lambda _film: 0.1)
    qtbot.waitUntil(lambda: not page.text.is_playing)
    QTest.keyClick(page.text, Qt.Key.Key_Space)
    assert page.text.is_playing


def test_a_film_that_is_not_in_sight_does_not_run(page: HelpPage) -> None:
    states = []
    page.show_topic(Topic.SENSORS)
    states.append(page.text.is_playing)
    for act in (page.hide, page.show):
        act()
        states.append(page.text.is_playing)
    page.show_topic(Topic.KEYS)
    states.append(page.text.is_playing)
    assert states == [True, False, True, False]


def test_space_scrolls_where_there_is_no_film(page: HelpPage) -> None:
    page.show_topic(Topic.MESSAGES)
    page.focus()
    QTest.keyClick(page.text, Qt.Key.Key_Space)
    assert page.text.verticalScrollBar().value() > 0


def test_where_less_motion_is_asked_for_the_scenes_stand_side_by_side(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(help_reader, "duration_ms", lambda _usual_ms, _theme: 0)
    page = HelpPage()
    qtbot.addWidget(page)
    page.resize(1064, 672)
    page.show_topic(Topic.FREE_MOTION)
    page.show()
    page.focus()
    QTest.keyClick(page.text, Qt.Key.Key_Space)
    assert not page.text.is_playing


@pytest.mark.usefixtures("pseudo_language")
@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_words_fit_in_a_longer_language(monkeypatch: pytest.MonkeyPatch, scale: float) -> None:
    set_scale(scale)
    drawn: list[tuple[float, float]] = []
    real = QPainter.drawText

    def noted(painter: QPainter, rect: QRect, flags: int, words: str) -> None:
        needed = painter.fontMetrics().boundingRect(rect, flags, words)
        drawn.append((needed.width() - rect.width(), needed.height() - rect.height()))
        real(painter, rect, flags, words)

    monkeypatch.setattr(QPainter, "drawText", noted)
    for film in Film:
        for k in range(len(SCENES[film])):
            frame(film, (k + 0.5) * SCENE_S, current_theme())
        image = QImage(700, 588, QImage.Format.Format_RGB32)
        painter = QPainter(image)
        paint_stills(painter, QRectF(0, 0, 700, 588), current_theme(), film)
        painter.end()
    assert len(drawn) > 20
    assert [over for over in drawn if max(over) > 0] == []
