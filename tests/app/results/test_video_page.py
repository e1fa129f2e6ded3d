"""A walk's clip beside its curves: one cursor for all, values that equal the charts', and synchronising by hand."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from app.plots.moment_chart import MomentChart
from app.results.beside_stride import StridePlace, place_at, time_at, used_strides
from app.results.result_page import ResultPage
from app.results.shown_clips import ClipsOfVisit
from app.results.tools_row import ANSWER, COMPARE
from app.summary.request import AnalysedVisit
from app.theme.current import px, set_scale
from app.widgets.accessible_role import show_roles
from app.wording.translation import use_language
from core.body import Joint, Side
from core.results import RecordingAnalysis
from core.verdicts.model import READ, GateReason, JointVerdicts, Verdict, assess
from core.video.clip import Clip, Sync, SyncBy
from core.video.moments import Moment, moments_s
from tests.app.accessibility.accessible_tree import complaints
from tests.app.changed_analysis import recalibrated, visit_of
from tests.app.drawn_clips import SURE, Jpegs, drawn_clip
from tests.app.room import settle, words_cut
from tests.simulated import TWO_WALKS, analysis_of, session_of

SMALL = (320, 180)
ROOMS = {"1280 x 800": (1064, 672, 1.0), "960 x 600": (896, 480, 1.0), "1920 x 1200 at 200 %": (896, 480, 2.0)}


@cache
def visit() -> AnalysedVisit:
    session = session_of(TWO_WALKS)
    return visit_of(analysis_of(session), session)


def walk(name: str = "walk 1") -> RecordingAnalysis:
    return visit().walk(name)


@cache
def clip_of(name: str) -> Clip:
    return drawn_clip(walk(name), number=int(name[-1]), size=SMALL)


def first() -> Clip:
    return clip_of("walk 1")


@pytest.fixture
def page(qtbot: QtBot, shared_page: ResultPage) -> Iterator[ResultPage]:
    """With the clip of the first walk in sight."""
    page = shared_page
    page.set_room(1064, 672)
    page.resize(1064, 672)
    page.show_visit(visit())
    page.show_clips([first()])
    show(page, "walk 1")
    page.view.choose(ANSWER)
    page.show_video.setChecked(False)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    QTest.keyClick(page, Qt.Key.Key_V)
    page.video.transport.choose(Side.LEFT, Moment.INITIAL_CONTACT)
    page.video.move_to(5.0)
    yield page
    page.clear_clips()  # which stops it too


def show(page: ResultPage, name: str) -> None:
    page.recordings.setCurrentIndex(page.recordings.findData(name))


def number_at(clip: Clip, time_s: float) -> int:
    return int(np.argmin(np.abs(clip.time_s - time_s)))


def tags(page: ResultPage) -> dict[tuple[Side, str], str]:
    return {(tag.side, tag.words.split()[0]): tag.words.split()[1] for tag in page.video.player.values}


def wait_for(page: ResultPage, number: int, qtbot: QtBot) -> None:
    qtbot.waitUntil(lambda: page.video.player.shown_frame == number)


def wait_for_cursor(page: ResultPage, time_s: float, qtbot: QtBot) -> None:
    qtbot.waitUntil(lambda: page.video.cursor_s == pytest.approx(time_s))


def states(page: ResultPage) -> tuple[bool, bool, bool]:
    """Whether it plays, is synchronised by hand, and has a tag in amber."""
    return page.video.is_playing, page.video.is_synchronising, page.video.player.is_caution


def test_without_any_clip_nothing_is_offered(page: ResultPage) -> None:
    page.clear_clips()
    page.show_visit(visit())
    assert not page.show_video.isVisible()
    page.show_clips([first()])
    assert page.show_video.isVisible()


def test_a_walk_without_a_clip_states_so_and_its_curves_come_back(page: ResultPage) -> None:
    assert page.video.isVisible()
    assert page.show_video.text() == "Video"
    show(page, "walk 2")
    assert page.show_video.text() == "No video of this walk"
    assert not page.show_video.isEnabled()
    assert not page.video.isVisible()
    assert page.cycles.isVisible()
    show(page, "walk 1")
    assert page.video.isVisible()
    assert page.show_video.isEnabled()


def test_v_puts_the_clip_in_place_of_curves_tiles_and_table_and_back(page: ResultPage) -> None:
    gone = (page.tiles, page.cycles, page.legs, page.differs, page.thin, page.show_legs, page.all_figures)
    assert not any(part.isVisible() for part in gone)
    for part in (page.headline, page.door, page.video.synchronise, page.video.player, page.video.strip):
        assert part.isVisible()
    assert page.video.player.hasFocus()
    QTest.keyClick(page.video.player, Qt.Key.Key_V)
    assert not page.video.isVisible()
    assert page.cycles.isVisible()
    assert not page.video.synchronise.isVisible()
    page.show_video.click()
    page.view.choose(COMPARE)
    assert not page.video.isVisible()
    assert not page.show_video.isVisible()


def test_one_cursor_moves_curves_strip_and_clip(page: ResultPage, qtbot: QtBot) -> None:
    for time_s in (2.0, 9.3, 4.711):
        page.video.move_to(time_s)
        assert {frame.chart.cursor_s for frame in page.video.frames} == {time_s}
        assert page.video.strip.lanes.cursor_s == time_s
        first_s, last_s = page.video.knee.chart.visible_s
        assert first_s <= time_s <= last_s
        assert last_s - first_s == pytest.approx(3.0)
        assert page.video.strip.lanes.window_s == pytest.approx((first_s, last_s))
        wait_for(page, number_at(first(), time_s), qtbot)


def test_the_values_over_the_clip_are_those_of_the_curves(page: ResultPage) -> None:
    for time_s in (3.0, 5.234):
        page.video.move_to(time_s)
        found = tags(page)
        assert len(found) == 4
        for frame, word in ((page.video.knee, "knee"), (page.video.ankle, "ankle")):
            for side in Side:
                curve = np.rad2deg(walk().joints[frame.chart.kind.of(side)].angle_rad)
                expected = float(np.interp(time_s, walk().time_s, curve))
                assert frame.chart.values_deg[side] == pytest.approx(expected)
                assert found[side, word] == f"{round(expected)}°".replace("-", "\N{MINUS SIGN}")


def test_an_angle_that_is_not_reported_has_neither_curve_nor_value(page: ResultPage) -> None:
    doubted = recalibrated(visit().analysis, [Joint.LEFT_KNEE], axis_sd_rad=0.2)
    page.show_visit(replace(visit(), analysis=doubted))
    page.video.move_to(5.0)
    assert set(page.video.knee.chart.curves) == {Side.RIGHT}
    assert set(page.video.ankle.chart.curves) == set(Side)
    assert set(tags(page)) == {(Side.RIGHT, "knee"), (Side.LEFT, "ankle"), (Side.RIGHT, "ankle")}


def test_without_an_absolute_angle_curves_are_about_their_mean_and_have_no_values(page: ResultPage) -> None:
    height = assess([GateReason("zero", Verdict.NOT_REPORTED)])
    one = walk()
    judged = replace(one.verdicts, joints={**one.verdicts.joints, Joint.LEFT_KNEE: JointVerdicts(READ, height, READ)})
    recordings = tuple(
        replace(found, verdicts=judged) if found.name == one.name else found for found in visit().analysis.recordings
    )
    page.show_visit(replace(visit(), analysis=replace(visit().analysis, recordings=recordings)))
    page.video.move_to(5.0)
    for side in Side:
        drawn = page.video.knee.chart.curves[side].angle_deg
        assert np.nanmean(drawn) == pytest.approx(0.0, abs=1e-9)
    assert page.video.knee.readings() == []
    assert {word for _, word in tags(page)} == {"ankle"}


def contacts(side: Side | None = None, name: str = "walk 1") -> list[float]:
    found = [moments_s(walk(name), one, Moment.INITIAL_CONTACT) for one in Side if side in (None, one)]
    return sorted(float(time_s) for times_s in found for time_s in times_s)


def test_contacts_are_lettered_in_both_charts(page: ResultPage) -> None:
    for frame in page.video.frames:
        for side in Side:
            np.testing.assert_array_equal(frame.chart.contacts_s[side], contacts(side))


def test_comma_and_full_stop_step_a_frame(page: ResultPage, qtbot: QtBot) -> None:
    page.video.move_to(5.0)
    number = number_at(first(), 5.0)
    QTest.keyClick(page.video.player, Qt.Key.Key_Period)
    assert page.video.cursor_s == pytest.approx(first().time_s[number + 1])
    QTest.keyClick(page.video.player, Qt.Key.Key_Comma)
    QTest.keyClick(page.video.player, Qt.Key.Key_Comma)
    assert page.video.cursor_s == pytest.approx(first().time_s[number - 1])
    qtbot.waitUntil(lambda: page.video.player.shown_frame == number - 1)


def test_page_keys_step_to_the_moments_that_are_chosen(page: ResultPage) -> None:
    for side, moment in product(Side, Moment):
        times_s = moments_s(walk(), side, moment)
        page.video.transport.choose(side, moment)
        page.video.move_to(float(times_s[3]) + 0.01)
        QTest.keyClick(page.video.player, Qt.Key.Key_PageUp)
        assert page.video.cursor_s == pytest.approx(times_s[3])
        QTest.keyClick(page.video.player, Qt.Key.Key_PageDown)
        assert page.video.cursor_s == pytest.approx(times_s[4])
        page.video.transport.earlier.click()
        assert page.video.cursor_s == pytest.approx(times_s[3])
        page.video.move_to(float(times_s[-1]))
        QTest.keyClick(page.video.player, Qt.Key.Key_PageDown)
        assert page.video.cursor_s == pytest.approx(times_s[-1])  # there is none beyond


def test_arrows_move_the_cursor_and_stay_within_the_walk(page: ResultPage) -> None:
    page.video.move_to(5.0)
    QTest.keyClick(page.video.player, Qt.Key.Key_Right)
    assert page.video.cursor_s == pytest.approx(5.01)
    QTest.keyClick(page.video.player, Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier)
    assert page.video.cursor_s == pytest.approx(4.91)
    page.video.move_to(-5.0)
    assert page.video.cursor_s == walk().time_s[0]
    page.video.move_to(1e4)
    assert page.video.cursor_s == walk().time_s[-1]


def click_in(chart: MomentChart, share: float) -> float:
    """Click at a share of the plot's width; the time that is there."""
    plot = chart.view_box.sceneBoundingRect()
    at = QPointF(plot.left() + share * plot.width(), plot.center().y())
    first_s, last_s = chart.visible_s
    QTest.mouseClick(chart.viewport(), Qt.MouseButton.LeftButton, pos=chart.mapFromScene(at))
    return first_s + share * (last_s - first_s)


def test_a_click_on_a_curve_or_the_strip_moves_the_cursor_and_the_curve_stays(page: ResultPage) -> None:
    settle()
    for frame in page.video.frames:
        before = frame.chart.visible_s
        time_s = click_in(frame.chart, 0.7)
        assert page.video.cursor_s == pytest.approx(time_s, abs=0.02)
        assert frame.chart.visible_s == before
        assert page.video.player.hasFocus()
    lanes = page.video.strip.lanes
    QTest.mouseClick(lanes, Qt.MouseButton.LeftButton, pos=QPoint(round(lanes.x_of(10.0)), 10))
    assert page.video.cursor_s == pytest.approx(10.0, abs=0.05)


def playing(page: ResultPage) -> Callable[[float], None]:
    """Begin to play by a clock that goes on by itself not at all: the function sets its seconds."""
    time_s = [100.0]
    page.video.now_s = lambda: time_s[0]
    QTest.keyClick(page.video.player, Qt.Key.Key_Space)

    def set_clock(elapsed_s: float) -> None:
        time_s[0] = 100.0 + elapsed_s

    return set_clock


def test_space_plays_as_fast_as_chosen_and_pauses(page: ResultPage, qtbot: QtBot) -> None:
    for speed, factor in (("quarter", 0.25), ("half", 0.5), ("whole", 1.0)):
        page.video.transport.speeds.choose(speed)
        page.video.move_to(5.0)
        set_clock = playing(page)
        assert states(page)[0]
        assert page.video.transport.play.accessibleName() == "Pause"
        set_clock(2.0)
        wait_for_cursor(page, 5.0 + 2.0 * factor, qtbot)
        QTest.keyClick(page.video.player, Qt.Key.Key_Space)
        assert not states(page)[0]
        assert page.video.transport.play.accessibleName() == "Play"


def test_playing_ends_with_the_walk_and_begins_again(page: ResultPage, qtbot: QtBot) -> None:
    page.video.move_to(5.0)
    playing(page)(1000.0)
    qtbot.waitUntil(lambda: not page.video.is_playing)
    assert page.video.cursor_s == walk().time_s[-1]
    playing(page)
    assert page.video.cursor_s == walk().time_s[0]


def test_l_plays_the_stride_of_the_chosen_leg_again_and_again(page: ResultPage, qtbot: QtBot) -> None:
    page.video.transport.choose(Side.RIGHT, Moment.TOE_OFF)
    start_s, end_s = used_strides(walk(), Side.RIGHT)[3]
    page.video.transport.speeds.choose("whole")
    page.video.move_to(start_s + 0.3)
    QTest.keyClick(page.video.player, Qt.Key.Key_L)
    set_clock = playing(page)
    set_clock(2 * (end_s - start_s) + 0.1)
    wait_for_cursor(page, start_s + 0.4, qtbot)
    QTest.keyClick(page.video.player, Qt.Key.Key_L)  # from here on it goes on
    set_clock(2 * (end_s - start_s) + 0.1 + 2.0)
    wait_for_cursor(page, start_s + 2.4, qtbot)


def test_leaving_the_view_stops_it(page: ResultPage) -> None:
    playing(page)
    page.show_video.click()
    assert not page.video.is_playing


def test_where_the_clip_has_no_frame_it_states_so_and_shows_no_value(page: ResultPage, qtbot: QtBot) -> None:
    short = drawn_clip(walk(), size=SMALL, length_s=4.0)
    page.show_clips([short])
    page.video.move_to(3.0)
    qtbot.waitUntil(lambda: not page.video.player.picture.isNull())
    assert len(tags(page)) == 4
    page.video.move_to(6.0)
    assert page.video.player.note == "The video has no frame at this time."
    assert page.video.player.picture.isNull()
    assert not tags(page)
    page.video.move_to(3.0)
    qtbot.waitUntil(lambda: not page.video.player.picture.isNull())


def test_a_clip_that_is_not_synchronised_has_amber_and_no_values(page: ResultPage) -> None:
    assert states(page) == (False, False, False)
    assert tags(page)
    for sync in (None, Sync(0.0, math.nan, SyncBy.CLOCK)):
        page.show_clips([replace(first(), sync=sync)])
        assert states(page) == (False, False, True)
        assert page.video.player.state.startswith("Not synchronised")
        assert not tags(page)


def test_synchronised_at_a_contact_the_frame_is_there_from_then_on(page: ResultPage, qtbot: QtBot) -> None:
    """The clip's stamps are 0.4 s late; the frame of a contact is found by eye."""
    late = replace(first(), stamped_s=first().stamped_s + 0.4, sync=None)
    page.show_clips([late])
    confirmed: list[tuple[object, object]] = []
    page.synchronised.connect(lambda clip, sync: confirmed.append((clip, sync)))
    contact_s = contacts(Side.LEFT)[4]
    page.video.move_to(contact_s + 0.05)
    page.video.synchronise.click()
    assert states(page)[1]
    assert page.video.cursor_s == contact_s  # the nearest
    assert "left foot" in page.video.sync.what.text()
    touched = number_at(first(), contact_s)  # of the same pictures
    while page.video.player.frame != touched:
        assert page.video.player.frame is not None
        key = Qt.Key.Key_Period if page.video.player.frame < touched else Qt.Key.Key_Comma
        QTest.keyClick(page.video.player, key)
    assert page.video.cursor_s == contact_s  # the cursor stayed
    assert not tags(page)
    assert confirmed == []  # until it is confirmed
    page.video.sync.confirm.click()
    ((clip, sync),) = confirmed
    assert clip == late.id
    assert isinstance(sync, Sync)
    assert sync.by is SyncBy.HAND
    assert sync.sd_s == pytest.approx(1 / 30)
    assert sync.offset_s == pytest.approx(-0.4, abs=0.5 / 30 + 1e-6)
    assert states(page) == (False, False, False)
    assert page.video.player.state == "Synchronised, ±1 frame"
    assert tags(page)
    page.video.move_to(9.0)
    qtbot.waitUntil(lambda: abs((page.video.player.shown_frame or 0) - number_at(first(), 9.0)) <= 1)


def test_another_contact_is_chosen_by_a_click_that_need_not_hit_it(page: ResultPage) -> None:
    page.video.move_to(contacts()[5])
    page.video.synchronise.click()
    settle()
    time_s = click_in(page.video.knee.chart, 0.6)
    nearest = min(contacts(), key=lambda one: abs(one - time_s))
    assert page.video.cursor_s == nearest
    QTest.keyClick(page.video.player, Qt.Key.Key_PageDown)
    assert page.video.cursor_s == contacts()[contacts().index(nearest) + 1]


def test_drawn_along_with_shift_the_frame_moves_against_the_curves(page: ResultPage) -> None:
    page.video.move_to(contacts()[5])
    before = page.video.player.frame
    assert before is not None
    page.video.player.dragged.emit(6)
    assert page.video.is_synchronising
    assert page.video.player.frame == before + 6
    assert page.video.cursor_s == contacts()[5]


def test_cancelled_nothing_is_changed(page: ResultPage) -> None:
    confirmed: list[object] = []
    page.synchronised.connect(lambda *one: confirmed.append(one))
    page.video.move_to(contacts()[5])
    page.video.player.dragged.emit(6)
    assert page.video.sync.isVisible()
    assert not page.video.transport.isVisible()
    page.video.sync.cancel.click()
    assert page.video.transport.isVisible()
    assert page.video.player.frame == number_at(first(), contacts()[5])
    assert confirmed == []
    assert tags(page)


def test_escape_cancels(page: ResultPage) -> None:
    page.video.synchronise.click()
    assert states(page)[1]
    QTest.keyClick(page.video.player, Qt.Key.Key_Escape)
    assert not states(page)[1]
    assert page.video.isVisible()


def test_a_clip_without_a_time_has_nothing_beside_it(page: ResultPage) -> None:
    both(page)
    assert page.video.other.isVisible()
    page.show_clips([replace(first(), sync=None), clip_of("walk 2")])
    assert not page.video.other.isVisible()
    assert not page.video.beside.isEnabled()
    assert page.video.knee.isVisible()


def test_two_cameras_of_one_walk_are_chosen_from_and_one_is_not_offered(page: ResultPage) -> None:
    assert not page.video.clip.isVisible()
    other = replace(first(), id=clip_of("walk 2").id, camera=2, view="")
    page.show_clips([other, first()])
    assert [page.video.clip.itemText(k) for k in range(2)] == ["from the left", "camera 2"]
    assert page.video.clip.isVisible()
    page.video.move_to(5.0)
    page.video.clip.setCurrentIndex(1)
    assert page.video.player.clip is not None
    assert page.video.player.clip.id == other.id
    assert page.video.cursor_s == 5.0


def both(page: ResultPage) -> None:
    page.show_clips([first(), clip_of("walk 2")])
    page.video.beside.setCurrentIndex(1)


def test_beside_each_other_both_are_at_the_same_percent_of_their_own_stride(page: ResultPage) -> None:
    assert not page.video.beside.isVisible()
    both(page)
    assert page.video.beside.itemText(1) == "walk 2"
    assert page.video.other.isVisible()
    assert not page.video.knee.isVisible()
    side = Side.RIGHT
    page.video.transport.choose(side, Moment.INITIAL_CONTACT)
    own, others = used_strides(walk(), side), used_strides(walk("walk 2"), side)
    for number in (1, 3):
        start_s, end_s = own[number]
        page.video.move_to(start_s + 0.4 * (end_s - start_s))
        assert page.video.percent.text() == "Both at 40 % of the right stride"
        expected_s = others[number, 0] + 0.4 * (others[number, 1] - others[number, 0])
        assert page.video.other.frame == number_at(clip_of("walk 2"), expected_s)
        angle = np.interp(expected_s, walk("walk 2").time_s, walk("walk 2").joints[Joint.RIGHT_KNEE].angle_rad)
        shown = next(tag.words for tag in page.video.other.values if tag.side is side)
        assert shown == f"knee {round(math.degrees(angle))}°".replace("-", "\N{MINUS SIGN}")
    page.video.beside.setCurrentIndex(0)
    assert not page.video.other.isVisible()
    assert page.video.other.picture.isNull()
    assert page.video.knee.isVisible()


def test_between_used_strides_nothing_is_beside(page: ResultPage) -> None:
    both(page)
    page.video.move_to(float(walk().time_s[0]))
    assert page.video.percent.text() == "Not in a used left stride"
    assert page.video.other.frame is None
    assert page.video.other.values == ()


def test_strides_of_a_shorter_walk_begin_again() -> None:
    strides = np.array([[0.0, 1.0], [1.0, 2.0], [4.0, 6.0]])
    assert place_at(strides, 5.0) == StridePlace(2, 50.0)
    assert place_at(strides, 3.0) is None
    assert place_at(strides, -1.0) is None
    assert time_at(strides[:2], StridePlace(2, 50.0)) == 0.5
    assert time_at(strides[:0], StridePlace(2, 50.0)) is None


def test_an_earlier_visit_is_offered_by_its_day_and_one_that_is_not_synchronised_is_not(page: ResultPage) -> None:
    earlier = replace(clip_of("walk 2"), sync=SURE)
    page.show_clips_of_visits([ClipsOfVisit("3 November", visit(), [earlier])])
    assert [page.video.beside.itemText(k) for k in range(page.video.beside.count())] == ["Nothing beside", "3 November"]
    page.video.beside.setCurrentIndex(1)
    assert page.video.other.what.startswith("3 November, ")
    page.show_clips_of_visits([ClipsOfVisit("3 November", visit(), [replace(earlier, sync=None)])])
    assert page.video.beside.count() == 1
    assert not page.video.other.isVisible()


def test_at_lock_no_picture_and_no_clip_is_left(page: ResultPage, qtbot: QtBot) -> None:
    both(page)
    page.video.move_to(used_strides(walk(), Side.LEFT)[2, 0] + 0.2)
    qtbot.waitUntil(lambda: not page.video.player.picture.isNull() and not page.video.other.picture.isNull())
    playing(page)
    page.clear_clips()
    assert not page.video.is_playing
    assert not page.video.isVisible()
    assert not page.show_video.isVisible()
    for player in (page.video.player, page.video.other):
        assert player.picture.isNull()
        assert player.clip is None
    asked = [one.pictures.asked for one in (first(), clip_of("walk 2")) if isinstance(one.pictures, Jpegs)]
    before = [len(one) for one in asked]
    page.video.move_to(8.0)
    settle()
    assert [len(one) for one in asked] == before


def test_another_session_takes_the_clips_away_and_the_same_one_that_goes_on_does_not(page: ResultPage) -> None:
    """A walk of another patient has the same name."""
    same = replace(visit(), session=replace(visit().session, notes="Walked on."))
    page.show_visit(same)
    assert page.show_video.isVisible()
    patient = replace(same.session.patient, code="P-0200")
    page.show_visit(replace(same, session=replace(same.session, patient=patient)))
    assert not page.show_video.isVisible()
    assert page.video.player.clip is None
    assert page.video.player.picture.isNull()


def test_the_strip_has_every_excluded_stride_and_states_how_many(page: ResultPage) -> None:
    lanes = page.video.strip.lanes
    excluded = used = 0
    for side in Side:
        strides = walk().gait[side].strides
        out = ~strides.is_used
        np.testing.assert_array_equal(lanes.excluded_s[side][:, 0], strides.start_s[out])
        excluded, used = excluded + int(out.sum()), used + int(strides.is_used.sum())
    assert f"{used} strides used" in lanes.accessibleDescription()
    assert f"{excluded} excluded" in lanes.accessibleDescription()


def test_everything_has_a_name_and_the_values_are_read_out(page: ResultPage) -> None:
    page.video.move_to(5.0)
    show_roles()
    assert complaints(page) == []
    left = float(np.interp(5.0, walk().time_s, walk().joints[Joint.LEFT_KNEE].angle_rad))
    assert f"L knee {round(math.degrees(left))}°" in page.video.player.accessibleDescription()
    assert f"Left knee {round(math.degrees(left))}°." in page.video.knee.chart.accessibleDescription()
    page.video.synchronise.click()
    assert complaints(page) == []


@pytest.fixture(params=["de", pytest.param("en", marks=pytest.mark.endurance)])  # German is longer
def language(request: pytest.FixtureRequest, qapp: QApplication) -> Iterator[str]:
    use_language(request.param)
    yield request.param
    use_language("en")


@pytest.mark.usefixtures("language")
@pytest.mark.parametrize("room", ROOMS)
def test_nothing_is_cut_in_the_windows_that_it_is_for(qtbot: QtBot, room: str) -> None:
    width, height, scale = ROOMS[room]
    set_scale(scale)
    holder = QWidget()
    qtbot.addWidget(holder)
    page = ResultPage()
    page.setParent(holder)
    page.set_room(width, height)
    page.show_visit(visit())
    page.show_clips([first(), clip_of("walk 2")])
    holder.resize(px(width), px(height))
    holder.show()
    page.show()
    page.resize(holder.size())
    show(page, "walk 1")
    settle()
    page.show_video.click()
    steps: list[Callable[[], object]] = [
        lambda: None,
        page.video.synchronise.click,
        page.video.sync.cancel.click,
        lambda: page.video.beside.setCurrentIndex(1),
    ]
    for step in steps:
        step()
        settle()
        assert page.minimumSizeHint().width() <= holder.width()
        assert page.minimumSizeHint().height() <= holder.height()
        page.resize(holder.size())
        settle()
        assert words_cut(page) == []
    assert page.video.ankle.isHidden() is (height < 608)  # there the clip has its place
