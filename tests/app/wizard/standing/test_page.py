"""Standing still on the page: the count, who moved, what follows without it, and the angles typed beside it."""

import math
from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QPaintEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.theme.current import set_scale
from app.theme.icons import Icon
from app.widgets.stillness import MovementBars
from app.wizard.standing.page import (
    StandPhase,
    StandStillPage,
    StandStillView,
    instruction,
    ring_face,
    verdict,
    way_round,
)
from app.wording.translation import tr, use_language
from core.body import LEG_JOINTS, LEG_SITES, Joint, Site
from tests.app.accessibility.framed_pages import framed
from tests.app.room import settle, words_cut

STILL: dict[str, float] = dict.fromkeys(LEG_SITES, 0.4)


def counting(still_s: float = 1.2, **more: object) -> StandStillView:
    return StandStillView(StandPhase.COUNTING, still_s, movement_deg_s=STILL, **more)  # type: ignore[arg-type]  # any of its fields


@pytest.fixture
def page(qtbot: QtBot) -> StandStillPage:
    page = StandStillPage()
    page.zero.show_zero(dict.fromkeys(LEG_JOINTS, 0.0))
    qtbot.addWidget(page)
    page.resize(1064, 600)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    return page


@pytest.mark.parametrize(
    ("still_s", "figure"), [(0.0, "3"), (0.9, "3"), (1.0, "2"), (1.9, "2"), (2.5, "1"), (3.0, "1")]
)
def test_the_ring_counts_the_seconds_that_are_left(still_s: float, figure: str) -> None:
    face = ring_face(counting(still_s))
    assert face.figure == figure
    assert face.share == pytest.approx(still_s / 3, abs=1e-3)


def test_before_the_count_the_ring_states_which_key_starts_it() -> None:
    face = ring_face(StandStillView(movement_deg_s=STILL))
    assert (face.share, face.key, face.word) == (0.0, "Space", "starts")


def test_the_ring_closes_with_a_check_mark() -> None:
    face = ring_face(StandStillView(StandPhase.DONE, 3.0, movement_deg_s=STILL))
    assert (face.share, face.icon) == (1.0, Icon.CHECK)


def test_bias_and_zero_are_known_once_the_recording_has_been_read_back() -> None:
    done = StandStillView(phase=StandPhase.DONE, still_s=3.0)
    assert instruction(done) == "Still for 3.0 s. Gyroscope offset and standing reference are set."
    assert instruction(replace(done, is_read_back=False)) == "Still for 3.0 s. The recording is being loaded."


def test_who_moved_is_named_until_a_second_is_still_again() -> None:
    moved = (Site.LEFT_THIGH,)
    _, what, then, is_caution = verdict(counting(0.2, moved=moved))
    assert what == "L thigh moving"
    assert then == "The countdown restarts automatically."
    assert is_caution
    assert verdict(counting(1.1, moved=moved))[1] == "All 6 sensors still"


def test_both_legs_and_many_sensors_are_stated_in_a_few_words() -> None:
    _, what, then, _ = verdict(counting(0.0, moved=(Site.LEFT_THIGH, Site.RIGHT_FOOT)))
    assert what == "L thigh and R foot moving"
    assert then == "The countdown restarts automatically."
    assert verdict(counting(0.0, moved=LEG_SITES))[1] == "6 sensors moving"


def test_a_silent_sensor_comes_before_one_that_moves() -> None:
    _, what, then, is_caution = verdict(counting(0.0, moved=(Site.LEFT_THIGH,), silent=(Site.RIGHT_FOOT,)))
    assert what == "R foot: no signal"
    assert then == "The countdown is paused. Switch the sensor off and on."
    assert is_caution


def test_fewer_sensors_are_counted_as_they_are() -> None:
    four: dict[str, float] = {site: 0.2 for site in LEG_SITES if site.segment != "foot"}
    assert verdict(StandStillView(movement_deg_s=four))[1] == "All 4 sensors still"


def test_sensors_that_nobody_has_placed_go_by_their_names() -> None:
    unplaced = StandStillView(StandPhase.COUNTING, 0.1, movement_deg_s={"0A2C": 9.0, "0A22": 0.4}, moved=("0A2C",))
    assert verdict(unplaced)[1:3] == ("0A2C moving", "The countdown restarts automatically.")


def test_going_on_without_is_offered_after_three_restarts() -> None:
    assert not way_round(counting(restarts=2))[3]
    _, what, then, is_caution = way_round(counting(restarts=3))
    assert what == "The countdown restarted 3 times."
    assert then == "If the patient cannot stand, range of motion is reported, absolute angles are not."
    assert is_caution


def test_without_standing_the_page_states_what_is_lost_and_the_way_back(qtbot: QtBot, page: StandStillPage) -> None:
    with qtbot.waitSignal(page.cannot_stand_pressed):
        page.zero.button.click()
    skipped = StandStillView(StandPhase.SKIPPED, movement_deg_s=STILL)
    page.show_state(skipped)
    assert instruction(skipped) == ("The patient cannot stand. Range of motion is reported, absolute angles are not.")
    assert not any(field.isEnabled() for field in page.zero.fields.values())
    with qtbot.waitSignal(page.can_stand_pressed):
        page.zero.button.click()


def test_no_field_takes_the_focus_by_itself_for_space_starts_the_count(page: StandStillPage) -> None:
    page.setFocus()
    page.focus()
    assert not any(one.line_edit.hasFocus() for one in page.zero.fields.values())


def test_an_angle_is_reported_with_its_joint_when_it_is_left(qtbot: QtBot, page: StandStillPage) -> None:
    knee = page.zero.fields[Joint.LEFT_KNEE].line_edit
    knee.setFocus()
    knee.selectAll()
    QTest.keyClicks(knee, "15")
    with qtbot.waitSignal(page.zero.edited) as edited:
        QTest.keyClick(knee, Qt.Key.Key_Tab)
    assert edited.args == [Joint.LEFT_KNEE, 15.0]
    assert page.zero.fields[Joint.RIGHT_KNEE].line_edit.hasFocus()  # L then R


def test_an_emptied_angle_is_reported_as_none_and_a_wrong_one_not_at_all(qtbot: QtBot, page: StandStillPage) -> None:
    ankle = page.zero.fields[Joint.RIGHT_ANKLE].line_edit
    ankle.selectAll()
    QTest.keyClicks(ankle, "61")
    with qtbot.assertNotEmitted(page.zero.edited):
        QTest.keyClick(ankle, Qt.Key.Key_Return)
    assert "\N{MINUS SIGN}60 to 60°" in ankle.accessibleName()
    ankle.clear()
    with qtbot.waitSignal(page.zero.edited) as edited:
        QTest.keyClick(ankle, Qt.Key.Key_Return)
    assert edited.args == [Joint.RIGHT_ANKLE, None]


def test_an_angle_being_typed_is_reported_when_the_page_goes(qtbot: QtBot, page: StandStillPage) -> None:
    knee = page.zero.fields[Joint.LEFT_KNEE].line_edit
    knee.setFocus()
    knee.selectAll()
    QTest.keyClicks(knee, "12")
    with qtbot.waitSignal(page.zero.edited) as edited:
        page.hide()
    assert edited.args == [Joint.LEFT_KNEE, 12.0]


def test_a_joint_without_its_sensors_has_no_angle_and_states_so(page: StandStillPage) -> None:
    page.zero.show_zero({joint: 0.0 for joint in LEG_JOINTS if joint is not Joint.RIGHT_ANKLE})
    assert [joint for joint, field in page.zero.fields.items() if not field.isEnabled()] == [Joint.RIGHT_ANKLE]
    assert page.zero.fields[Joint.RIGHT_ANKLE].text == ""
    assert "right ankle" in page.zero.why


def test_only_the_row_whose_figure_changed_is_painted(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> None:
    painted: list[int] = []
    paint = MovementBars.paintEvent

    def noting(bars: MovementBars, event: QPaintEvent) -> None:
        painted.append(event.rect().height())
        paint(bars, event)

    monkeypatch.setattr(MovementBars, "paintEvent", noting)
    bars = MovementBars()
    qtbot.addWidget(bars)
    bars.resize(268, 192)
    with qtbot.waitExposed(bars):
        bars.show()
    bars.show_movement(STILL, 3.4, (), ())
    qtbot.waitUntil(lambda: bool(painted))
    QApplication.processEvents()
    painted.clear()
    bars.show_movement(STILL | {Site.LEFT_FOOT: 0.9}, 3.4, (), ())
    QApplication.processEvents()
    bars.show_movement(STILL | {Site.LEFT_FOOT: 0.9}, 3.4, (), ())
    QApplication.processEvents()
    assert painted == [32]


def test_seven_are_counted_and_the_pelvis_has_a_row_without_a_side(page: StandStillPage) -> None:
    seven = StandStillView(StandPhase.COUNTING, 1.2, movement_deg_s=dict.fromkeys(Site, 0.4))
    assert verdict(seven)[1] == "All 7 sensors still"
    page.show_state(seven)
    assert page.findChildren(MovementBars)[0].sizeHint().height() == 7 * 32


def test_a_silent_pelvis_holds_up_nothing(page: StandStillPage) -> None:
    silent = counting(1.2, silent=(Site.PELVIS,))
    _, what, then, is_caution = verdict(silent)
    assert (what, then) == ("Pelvis: no signal", "The countdown continues; hip angles will be missing.")
    assert is_caution
    assert verdict(silent, is_short=True)[2] == "No hip angles."
    assert "The countdown is paused." in verdict(counting(0.0, silent=(Site.PELVIS, Site.LEFT_FOOT)))[2]


def test_a_pelvis_that_moves_is_named() -> None:
    _, what, then, _ = verdict(counting(0.0, moved=(Site.PELVIS,)))
    assert what == "Pelvis moving"
    assert then == "The countdown restarts automatically."
    _, what, then, _ = verdict(counting(0.0, moved=(Site.LEFT_FOOT, Site.PELVIS)))
    assert what == "L foot and pelvis moving"
    assert then == "The countdown restarts automatically."


def test_more_sensors_than_places_are_all_still() -> None:
    names = {f"0A{number}": 0.3 for number in range(9)}
    assert verdict(StandStillView(StandPhase.COUNTING, 1.0, movement_deg_s=names))[1] == "All 9 sensors still"


@pytest.mark.parametrize("phase", StandPhase)
@pytest.mark.parametrize("moves_deg_s", [21.0, 74.0])
def test_all_are_never_stated_to_be_still_beside_a_figure_above_the_limit(
    phase: StandPhase, moves_deg_s: float
) -> None:
    for sites in ((Site.LEFT_SHANK,), LEG_SITES):
        view = StandStillView(phase, 2.0, movement_deg_s=STILL | dict.fromkeys(sites, moves_deg_s))
        stated = " ".join(str(part) for part in verdict(view))
        assert "still" not in stated
        if phase in (StandPhase.READY, StandPhase.COUNTING):
            assert "moving" in stated
        assert "All 6 sensors still" in verdict(replace(view, movement_deg_s=STILL)) or phase is StandPhase.SKIPPED


def test_what_is_not_received_enough_is_not_stated_to_be_still() -> None:
    view = replace(counting(), movement_deg_s=STILL | {Site.LEFT_FOOT: math.inf})
    assert verdict(view) == (None, "", "", False)


def test_a_sensor_moves_just_when_its_figure_reaches_the_limit() -> None:
    view = counting(still_s=2.0)
    assert replace(view, movement_deg_s=STILL | {Site.LEFT_FOOT: view.limit_deg_s}).moving == (Site.LEFT_FOOT,)
    assert replace(view, movement_deg_s=STILL | {Site.LEFT_FOOT: view.limit_deg_s - 0.01}).moving == ()


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("name", ["ready to stand", "cannot stand"])
def test_at_200_percent_the_way_without_standing_is_in_sight_in_its_whole_words(
    qtbot: QtBot, name: str, language: str
) -> None:
    use_language(language)
    try:
        set_scale(2.0)
        shell = framed(name)
        qtbot.addWidget(shell)
        shell.resize(1920, 1200)
        shell.show()
        settle()
        page = shell.findChild(StandStillPage)
        assert isinstance(page, StandStillPage)
        area = page.parentWidget()
        assert area is not None
        assert page.height() <= area.height()  # nothing scrolls
        words = "Patient can stand still" if name == "cannot stand" else "Patient cannot stand still"
        assert page.zero.button.text() == tr(words)
        assert words_cut(shell) == []
    finally:
        use_language("en")
