"""Standing still on the page: the count, who moved, what follows without it, and the angles typed beside it."""

import math
from collections.abc import Iterable
from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QPaintEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

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


def counting_of(names: Iterable[str]) -> StandStillView:
    return StandStillView(StandPhase.COUNTING, 1.2, movement_deg_s=dict.fromkeys(names, 0.4))


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


def test_the_ring_states_which_key_starts_it_and_closes_with_a_check_mark() -> None:
    face = ring_face(StandStillView(movement_deg_s=STILL))
    assert (face.share, face.key, face.word) == (0.0, "Space", "starts")
    face = ring_face(StandStillView(StandPhase.DONE, 3.0, movement_deg_s=STILL))
    assert (face.share, face.icon) == (1.0, Icon.CHECK)


def test_the_verdict_names_what_holds_up_the_count(snapshot: SnapshotAssertion) -> None:
    thigh, foot, pelvis = Site.LEFT_THIGH, Site.RIGHT_FOOT, Site.PELVIS
    unplaced = StandStillView(StandPhase.COUNTING, 0.1, movement_deg_s={"0A2C": 9.0, "0A22": 0.4}, moved=("0A2C",))
    views = {
        "who moved is named": counting(0.2, moved=(thigh,)),
        "but not once a second is still again": counting(1.1, moved=(thigh,)),
        "both legs": counting(0.0, moved=(thigh, foot)),
        "many sensors in a few words": counting(0.0, moved=LEG_SITES),
        "a silent sensor comes before one that moves": counting(0.0, moved=(thigh,), silent=(foot,)),
        "fewer sensors are counted as they are": StandStillView(movement_deg_s=dict.fromkeys(LEG_SITES[:4], 0.2)),
        "and more than there are places": counting_of(f"0A{number}" for number in range(9)),
        "sensors that nobody has placed go by their names": unplaced,
        "a silent pelvis holds up nothing": counting(silent=(pelvis,)),
        "unless a foot is silent too": counting(0.0, silent=(pelvis, Site.LEFT_FOOT)),
        "a pelvis that moves": counting(0.0, moved=(pelvis,)),
        "a foot and a pelvis that move": counting(0.0, moved=(Site.LEFT_FOOT, pelvis)),
        "what is not received enough is not still": replace(
            counting(), movement_deg_s=STILL | {Site.LEFT_FOOT: math.inf}
        ),
    }
    stated = {case: verdict(view) for case, view in views.items()}
    stated["in less room"] = verdict(counting(silent=(pelvis,)), is_short=True)
    assert stated == snapshot


def test_what_is_done_and_the_way_without_standing_are_stated_when_they_are_so(snapshot: SnapshotAssertion) -> None:
    done = StandStillView(phase=StandPhase.DONE, still_s=3.0)
    assert {
        "offset and reference are set": instruction(done),
        "not before it has been read back": instruction(replace(done, is_read_back=False)),
        "after three restarts the way without is offered": way_round(counting(restarts=3)),
        "after two it is not": way_round(counting(restarts=2)),
    } == snapshot


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
    seven = counting_of(Site)
    assert verdict(seven)[1] == "All 7 sensors still"
    page.show_state(seven)
    assert page.findChildren(MovementBars)[0].sizeHint().height() == 7 * 32


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
