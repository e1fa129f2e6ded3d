"""Sensors that the motion contradicts: one key puts them where it detects them, and no way ends there."""

from collections.abc import Iterator

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.system.prompts import prompter
from app.widgets.action_bar import VerbButton
from app.widgets.body_figure import SensorMark
from app.widgets.gauge import GaugeState
from app.widgets.rail_row import StepState
from app.widgets.sensor_tile import marks
from app.wizard.free_motion.motion_shown import gauge_faces, sensor_marks
from app.wizard.free_motion.step import FreeMotionStep
from app.wizard.keys import Intent, KeyAction
from app.wizard.sensors.step import SensorsStep
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from app.wizard.wizard import Wizard
from app.wizard.worn_tiles import worn_tiles
from core.body import LEG_JOINTS, Joint, Site
from core.placement.labels import groups_of
from core.session import RecordingKind
from tests.app.wizard.begun_visit import begin, record
from tests.app.wizard.free_motion.test_hints import motion, state
from tests.app.wizard.pressing import press

THIGH, SHANK, FOOT = Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT
MIXED = {THIGH: SHANK, SHANK: FOOT, FOOT: THIGH}


@pytest.fixture
def moved(
    qtbot: QtBot, visit: Visit, worn: dict[str, Site], monkeypatch: pytest.MonkeyPatch
) -> Iterator[FreeMotionStep]:
    """The step after a free motion has been recorded."""
    monkeypatch.setattr(visit, "evaluate", lambda: None)
    begin(qtbot, visit, worn)
    record(qtbot, visit, RecordingKind.FREE_MOTION, 0.5)
    step = FreeMotionStep(visit)
    qtbot.addWidget(step.page)
    step.page.show()
    step.enter()
    yield step
    step.leave()


def recorded_at(visit: Visit) -> dict[Site, str]:
    """The sensors that the free motion is of."""
    free = visit.recordings.free_motion
    assert free is not None
    assert free.stored.placement is not None
    return {site: sensor.name for site, sensor in free.stored.placement.sensors.items()}


@pytest.mark.parametrize("detected", [{THIGH: SHANK, SHANK: THIGH}, MIXED], ids=["two", "three"])
def test_detected_positions_are_used_by_one_button_and_come_back_with_their_doubt_when_that_is_undone(
    qtbot: QtBot, visit: Visit, moved: FreeMotionStep, detected: dict[Site, Site]
) -> None:
    visit.sensors.doubt(detected)
    assert [(one.text, one.key) for one in moved.bar().on_page] == [
        ("Use detected positions", "Enter"),
        ("Check positions", "P"),
    ]
    assert moved.state is StepState.ATTENTION
    moved.enter()
    moved.done.connect(moved.leave)  # as the wizard does
    before = dict(visit.sensors.site_of)
    with qtbot.waitSignals([moved.done, moved.offered, visit.worn.corrected]):
        moved.page.swapped.use.click()
    assert visit.sensors.site_of == {name: detected.get(site, site) for name, site in before.items()}
    assert recorded_at(visit) == visit.sensors.sensor_at  # what was recorded is of the new positions
    assert not visit.sensors.detected
    with qtbot.waitSignal(visit.worn.corrected):
        moved.undo()
    assert (visit.sensors.site_of, visit.sensors.detected) == (before, detected)
    assert recorded_at(visit) == visit.sensors.sensor_at


def test_without_a_doubt_the_primary_button_goes_on_and_a_change_by_hand_ends_one(
    visit: Visit, moved: FreeMotionStep
) -> None:
    bar = moved.bar()
    assert bar.primary is not None
    assert (bar.primary.text, bar.primary.is_enabled, bar.on_page) == ("Continue to walking", True, ())
    assert moved.state is StepState.DONE
    assert (moved.page.swapped.isHidden(), moved.page.band.isHidden()) == (True, False)
    assert all(gauge.face.state is not GaugeState.NEEDS for gauge in moved.page.gauges.values())
    assert not any(tile.moves_like or tile.is_bad for tile in worn_tiles(visit.sensors).values())
    visit.sensors.doubt(MIXED)
    assert moved.is_in_doubt
    visit.sensors.assign(visit.sensors.sensor_at[THIGH], SHANK)
    assert not moved.is_in_doubt


def test_sensors_that_look_swapped_take_the_hints_place_and_walking_waits_for_them(
    visit: Visit, moved: FreeMotionStep
) -> None:
    visit.sensors.doubt({SHANK: Site.RIGHT_THIGH, Site.RIGHT_THIGH: SHANK})
    moved.enter()
    page = moved.page
    assert (page.swapped.isHidden(), page.band.isHidden(), page.question.isHidden()) == (False, True, True)
    assert page.swapped.text == (
        "Left shank and right thigh look swapped. These angles would be wrong: left knee, left ankle and right knee."
    )
    bar = moved.bar()
    assert bar.primary is not None
    assert (bar.primary.is_enabled, bar.note) == (False, "Correct the sensor positions first.")
    walking = WalkingStep(visit)
    assert walking.cannot_enter == bar.note
    filled = [button for button in page.findChildren(VerbButton) if button.is_filled and not button.isHidden()]
    assert filled == [page.swapped.use]
    visit.sensors.doubt({THIGH: SHANK, SHANK: THIGH})
    moved.enter()
    words = "Left thigh and left shank look swapped. These angles would be wrong: left knee and left ankle."
    assert page.swapped.text == words
    visit.sensors.doubt({})
    moved.enter()
    assert (page.swapped.isHidden(), page.band.isHidden()) == (True, False)
    assert walking.cannot_enter != bar.note
    walking.deleteLater()


def test_what_the_step_shows_is_spoken_while_it_is_in_sight(
    visit: Visit, moved: FreeMotionStep, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    monkeypatch.setattr(prompter, "speak", asked.append)
    moved.enter()
    visit.sensors.doubt(MIXED)
    moved.enter()
    assert asked == ["recorded", "swapped"]
    moved.leave()
    for _ in range(9):
        moved.tick()
    assert len(asked) == 2


def test_gauges_of_swapped_sensors_show_what_they_need_and_tiles_and_figure_what_moves_like_what(
    visit: Visit, moved: FreeMotionStep
) -> None:
    known = motion({joint: state(0.8, 6.0, None, is_closed=True) for joint in LEG_JOINTS})
    visit.sensors.doubt({SHANK: Site.RIGHT_THIGH, Site.RIGHT_THIGH: SHANK})
    faces = gauge_faces(visit, known, None)
    needs = {joint: face.note for joint, face in faces.items() if face.state is GaugeState.NEEDS}
    assert needs == {
        Joint.LEFT_KNEE: "Needs the left shank sensor",
        Joint.LEFT_ANKLE: "Needs the left shank sensor",
        Joint.RIGHT_KNEE: "Needs the right thigh sensor",
    }
    for joint in needs:
        centre = faces[joint].centre
        assert centre is not None
        assert (centre.figure, centre.share) == ("\N{EN DASH}", 0.0)
    assert faces[Joint.RIGHT_ANKLE].state is GaugeState.CENTRE
    tiles = worn_tiles(visit.sensors)
    amber = {site: tile.words for site, tile in tiles.items() if tile.is_bad}
    assert amber == {SHANK: "moves like R thigh", Site.RIGHT_THIGH: "moves like L shank"}
    assert {site for site, mark in marks(tiles).items() if mark is SensorMark.SWAPPED} == set(amber)
    assert {site for site, mark in sensor_marks(visit.sensors).items() if mark is SensorMark.SWAPPED} == set(amber)
    moved.enter()
    doubted = moved.page.figure.grab().toImage()
    moved.page.figure.show_moves({})
    assert moved.page.figure.grab().toImage() != doubted  # the arrow
    visit.sensors.doubt(MIXED)
    moved.enter()
    assert moved.page.gauges[Joint.LEFT_KNEE].face.note == "Needs both sensors"


def test_positions_can_be_checked_and_kept_as_they_are(
    qtbot: QtBot, visit: Visit, moved: FreeMotionStep, worn: dict[str, Site]
) -> None:
    visit.sensors.doubt(MIXED)
    with qtbot.waitSignal(moved.jumped) as jumped:
        press(moved, "Check positions")
    assert jumped.args == [StepId.SENSORS]
    sensors = SensorsStep(visit)
    qtbot.addWidget(sensors.page)
    sensors.enter()
    words = (
        "Left thigh, left shank and left foot look mixed up. "
        "Change the sensor positions, or continue with the current ones."
    )
    assert sensors.page.notice.text == words
    assert (sensors.state, sensors.note) == (StepState.ATTENTION, "positions look swapped")
    sensors.leave()
    assert visit.sensors.site_of == worn
    sensors.enter()
    assert sensors.page.notice.text == "All six sensors are assigned and connected."
    primary = moved.bar().primary
    assert primary is not None
    assert primary.text == "Continue to walking"
    visit.sensors.doubt(MIXED)  # the motion still reports it
    assert not visit.sensors.detected
    moved.enter()
    assert moved.page.swapped.isHidden()
    sensors.deleteLater()


def test_sensors_left_to_another_motion_that_shows_no_positions_lead_to_them(
    qtbot: QtBot, visit: Visit, moved: FreeMotionStep
) -> None:
    visit.sensors.leave_to_motion(True)
    moved.enter()
    assert visit.recordings.is_recording
    assert moved.bar().primary is not None
    done: list[None] = []
    moved.done.connect(lambda: done.append(None))
    with qtbot.waitSignal(moved.reported) as reported:
        press(moved)
    assert reported.args[0] == "Sensor positions could not be detected."
    bar = moved.bar()
    assert bar.primary is not None
    assert (bar.primary.text, [one.text for one in bar.quiet]) == ("Start free motion", ["Check positions"])
    assert done == []


def test_groups_are_the_cycles_in_which_sensors_change_places() -> None:
    right = Site.RIGHT_THIGH, Site.RIGHT_SHANK
    assert groups_of(MIXED | dict(zip(right, reversed(right), strict=True))) == [(THIGH, SHANK, FOOT), right]


def test_the_keys_on_the_bar_use_and_check_the_positions(wizard: Wizard, monkeypatch: pytest.MonkeyPatch) -> None:
    wizard.begin(None)
    step = wizard.steps[StepId.FREE_MOTION]
    gone: list[StepId] = []
    monkeypatch.setattr(type(step), "cannot_enter", "")
    wizard.go_to(StepId.FREE_MOTION)
    visit = wizard.visit
    assert visit is not None
    used: list[None] = []
    monkeypatch.setattr(type(step), "_use_detected", lambda _: used.append(None))
    visit.sensors.doubt(MIXED)
    assert set(wizard.shell.bar.keys) == {"Enter", "Space", "P"}
    step.jumped.disconnect()
    step.jumped.connect(gone.append)
    wizard.shell.bar.back.setFocus()
    QTest.keyClick(wizard.shell.bar.back, Qt.Key.Key_Return)
    assert used == [None]
    QTest.keyClick(wizard.shell.bar.back, Qt.Key.Key_P)
    assert gone == [StepId.SENSORS]


def test_what_the_toast_offers_is_taken_back_by_the_step_that_offered_it(
    wizard: Wizard, monkeypatch: pytest.MonkeyPatch
) -> None:
    wizard.begin(None)
    undone: list[StepId] = []
    for step in wizard.steps.values():
        monkeypatch.setattr(type(step), "undo", lambda self: undone.append(self.id))
    wizard.steps[StepId.FREE_MOTION].offered.emit("Sensor positions changed.")
    wizard.shell.toast.undo()
    assert undone == [StepId.FREE_MOTION]
    wizard.act_on(Intent(KeyAction.UNDO))  # with nothing offered, it is the current step's
    assert undone[1:] == [StepId.PATIENT]
