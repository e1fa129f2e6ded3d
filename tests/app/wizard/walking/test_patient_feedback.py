"""From the estimator's values to the patient's screen: which count, which sound, when it waits, what is kept."""

import math
import sys
import threading
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.patient_screen.controls import ControlsCard
from app.system import sounds
from app.system.sounds import Loudspeaker, Sound
from app.widgets.notice import Notice
from app.wizard.walking.patient_feedback import PatientFeedback
from app.wizard.walking.patient_status import reasons_against
from app.wizard.walking.readout import LiveLane, PhaseSpan, WalkingReadout
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site
from core.calibration.strap import Slip
from core.gait.phases import Phase
from core.live.stride_values import StrideValue
from core.results import JointCalibration, ZeroKind
from core.targets import Target, TargetMeasure, TargetTally
from tests.app.patient_screen.sound_detection import spans_s
from tests.core.verdicts.built_walk import calibration

KNEE = Target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, 55)
BEAT = Target(TargetMeasure.CADENCE, None, 110)
SURE = {joint: calibration(joint) for joint in LEG_JOINTS}
WORN = {f"DEMO-{site}": site for site in LEG_SITES}


class Reported:
    """An estimator that gives what the test states, from a thread of its own as the real one does."""

    def __init__(self) -> None:
        self.state = WalkingReadout(now_s=1.0)
        self.on_value: Any = None

    def show_message(self, *values: tuple[TargetMeasure, Side, float], **changes: Any) -> None:
        new = tuple(StrideValue(measure, side, value, 1.0, 1.0) for measure, side, value in values)
        every = (*self.state.stride_values, *new)[-64:]
        total = self.state.values_reported + len(new)
        self.state = replace(self.state, stride_values=every, values_reported=total, **changes)
        if new and self.on_value is not None:
            thread = threading.Thread(target=self.on_value)
            thread.start()
            thread.join()


@pytest.fixture
def received(monkeypatch: pytest.MonkeyPatch) -> list[Sound]:
    received: list[Sound] = []
    monkeypatch.setattr(sounds, "play", received.append)
    return received


@pytest.fixture
def estimator() -> Reported:
    return Reported()


@pytest.fixture
def visit() -> Any:
    """What the feedback asks of a visit."""
    sensors = SimpleNamespace(sensor_at={site: name for name, site in WORN.items()}, site_of=WORN, are_in_memory=False)
    return SimpleNamespace(sensors=sensors, calibration=SURE, prosthetic_sides=frozenset(), rests=WORN)


@pytest.fixture
def feedback(qtbot: QtBot, visit: Any, estimator: Reported, received: list[Sound]) -> Iterator[PatientFeedback]:
    page = QWidget()
    qtbot.addWidget(page)
    card = ControlsCard()
    card.setParent(page)
    page.show()
    feedback = PatientFeedback(visit, card, page, lambda: estimator.state)
    feedback.toggle()
    reported: Any = estimator
    feedback.watch(reported)
    card.target_set.emit(KNEE)
    yield feedback
    feedback.watch(None)
    feedback.close()


def card_of(feedback: PatientFeedback) -> ControlsCard:
    page = feedback.parent()
    card = page.findChild(ControlsCard) if page is not None else None
    assert isinstance(card, ControlsCard)
    return card


def knee(*values: float, side: Side = Side.LEFT) -> list[tuple[TargetMeasure, Side, float]]:
    return [(TargetMeasure.KNEE_SWING_PEAK, side, value) for value in values]


def reach(qtbot: QtBot, feedback: PatientFeedback, estimator: Reported, value: int) -> None:
    """Show one stride, the first that is shown."""
    estimator.show_message(*knee(value))
    qtbot.waitUntil(lambda: feedback.view.last == (value,))


def test_each_stride_of_what_is_aimed_at_is_shown_and_sounds_where_it_reached(
    qtbot: QtBot, feedback: PatientFeedback, estimator: Reported, received: list[Sound]
) -> None:
    estimator.show_message(*knee(54.4))
    qtbot.waitUntil(lambda: feedback.view.last == (54,))
    assert received == []
    estimator.show_message(*knee(54.6), *knee(70.0, side=Side.RIGHT), (TargetMeasure.FOOT_STRIKE, Side.LEFT, 60.0))
    qtbot.waitUntil(lambda: feedback.view.last == (54, 55))
    assert received == [Sound.REACHED]
    assert feedback.window is not None
    assert feedback.window.view == feedback.view


def test_the_last_ten_are_kept_and_strides_of_either_foot_count_for_the_cadence(
    qtbot: QtBot, feedback: PatientFeedback, estimator: Reported
) -> None:
    estimator.show_message(*knee(*range(40, 52)))
    qtbot.waitUntil(lambda: feedback.view.last == tuple(range(42, 52)))
    card_of(feedback).target_set.emit(BEAT)
    assert feedback.view.last == ()
    estimator.show_message((TargetMeasure.CADENCE, Side.LEFT, 109.0), (TargetMeasure.CADENCE, Side.RIGHT, 111.0))
    qtbot.waitUntil(lambda: feedback.view.last == (109, 111))


@pytest.mark.parametrize(
    "gated",
    [{"missing": (Site.LEFT_SHANK,)}, {"missing": (Site.LEFT_FOOT,)}, {"slips": (Slip(Site.LEFT_THIGH, 1.0, 0.3),)}],
)
def test_a_silent_sensor_or_a_slipped_strap_of_that_leg_lets_it_wait_without_a_value(
    qtbot: QtBot, feedback: PatientFeedback, estimator: Reported, received: list[Sound], gated: dict[str, Any]
) -> None:
    reach(qtbot, feedback, estimator, 60)
    estimator.show_message(**gated)
    feedback.judge(estimator.state)  # as thirty times a second
    assert feedback.view.is_waiting
    assert feedback.view.last == ()
    estimator.show_message(*knee(61.0))
    qtbot.wait(20)
    assert feedback.view.last == ()
    assert received == [Sound.REACHED]
    estimator.show_message(*knee(62.0), missing=(), slips=())
    qtbot.waitUntil(lambda: feedback.view.last == (62,))
    assert not feedback.view.is_waiting


@pytest.mark.parametrize(
    ("target", "changes", "waits"),
    [
        (KNEE, {"missing": (Site.RIGHT_SHANK,), "slips": (Slip(Site.RIGHT_FOOT, 1.0, 0.3),)}, False),
        (BEAT, {"missing": (Site.RIGHT_FOOT,)}, False),
        (BEAT, {"missing": (Site.RIGHT_FOOT, Site.LEFT_FOOT)}, True),
        (BEAT, {"missing": (Site.RIGHT_FOOT,), "doubtful": (Site.LEFT_FOOT,)}, True),
    ],
    ids=["the other leg", "cadence by one foot", "cadence by none", "cadence by one that disagrees with its knee"],
)
def test_it_waits_only_where_what_is_aimed_at_is_not_received(
    feedback: PatientFeedback, estimator: Reported, target: Target, changes: dict[str, Any], waits: bool
) -> None:
    card_of(feedback).target_set.emit(target)
    estimator.show_message(**changes)
    feedback.judge(estimator.state)
    assert feedback.view.is_waiting is waits


def test_a_walk_counts_its_own_strides_for_each_target(
    qtbot: QtBot, feedback: PatientFeedback, estimator: Reported
) -> None:
    reach(qtbot, feedback, estimator, 60)
    feedback.begin_walk()
    assert feedback.view.last == ()
    estimator.show_message(*knee(54.0, 55.0, 56.0))
    qtbot.waitUntil(lambda: len(feedback.view.last) == 3)
    card_of(feedback).target_set.emit(BEAT)
    estimator.show_message((TargetMeasure.CADENCE, Side.LEFT, 100.0))
    qtbot.waitUntil(lambda: feedback.view.last == (100,))
    assert feedback.end_walk() == (TargetTally(KNEE, 2, 3), TargetTally(BEAT, 0, 1))
    assert feedback.end_walk() == ()


def status(feedback: PatientFeedback) -> str:
    """All that is stated beside the controls."""
    notices = card_of(feedback).findChildren(Notice)
    return " ".join(one.text for one in notices if not one.isHidden())


def shown(feedback: PatientFeedback) -> int | None:
    return feedback.view.value


def aimed(feedback: PatientFeedback) -> Target | None:
    return feedback.target


def has_sound(feedback: PatientFeedback) -> bool:
    return feedback.view.has_sound


STANDING = {side: LiveLane((PhaseSpan(Phase.FOOT_FLAT, 0.0, None),)) for side in Side}


def test_while_the_patient_is_standing_the_next_step_is_waited_for_and_between_steps_the_value_stays(
    qtbot: QtBot, feedback: PatientFeedback, estimator: Reported
) -> None:
    reach(qtbot, feedback, estimator, 60)
    estimator.show_message(lanes=STANDING, now_s=2.0)  # a foot is flat: of a slow stride
    feedback.look()
    assert shown(feedback) == 60
    estimator.show_message(now_s=30.0)
    feedback.look()
    assert shown(feedback) is None
    assert feedback.view.last == (60,)  # what was reached stays
    assert "Waiting for the next step" in feedback.view.in_words
    assert "The patient is standing." in status(feedback)
    moves = {side: LiveLane((PhaseSpan(Phase.SWING, 30.2, None),)) for side in Side}
    estimator.show_message(*knee(62.0), lanes=moves, now_s=31.0)
    qtbot.waitUntil(lambda: feedback.view.value == 62)
    assert "Waiting" not in feedback.view.in_words


def test_what_hinders_a_value_is_stated_to_the_clinician_and_is_gone_when_it_is_over(
    feedback: PatientFeedback, estimator: Reported
) -> None:
    feedback.begin_walk()
    for gated, words in (
        ({"missing": (Site.LEFT_SHANK,)}, "L shank: no signal. The patient sees no value until the signal is back."),
        ({"slips": (Slip(Site.LEFT_THIGH, 1.0, 0.3),)}, "L thigh: strap moved."),
        ({"doubtful": (Site.LEFT_FOOT,)}, "L foot: steps do not match the knee."),
        ({"implausible": (Joint.LEFT_KNEE,)}, "Left knee: angle outside"),
    ):
        before = estimator.state
        estimator.show_message(**gated)
        feedback.look()
        assert words in status(feedback)
        assert "One moment" in feedback.view.in_words
        estimator.state = before
        feedback.look()
        assert words not in status(feedback)
        assert "One moment" not in feedback.view.in_words


def test_without_a_target_a_walk_or_data_what_is_missing_is_stated(
    feedback: PatientFeedback, visit: Any, estimator: Reported
) -> None:
    assert "No walk is being recorded. Space starts one." in status(feedback)
    feedback.begin_walk()
    feedback.look()
    assert "No walk is being recorded" not in status(feedback)
    feedback.end_walk()
    card_of(feedback).target_set.emit(None)
    assert "No target yet. Type one and press Enter." in status(feedback)
    estimator.state = WalkingReadout()
    feedback.look()
    assert "No sensor data." in status(feedback)
    visit.sensors.are_in_memory = True
    feedback.look()
    assert "The sensors store the walk themselves." in status(feedback)


def test_a_knee_that_can_no_longer_be_a_target_lets_the_patient_wait_and_is_named(
    feedback: PatientFeedback, visit: Any
) -> None:
    card = card_of(feedback)
    card.target.set_value(55)
    card.target.committed.emit()
    assert aimed(feedback) == KNEE
    feedback.begin_walk()
    feedback.count({Side.LEFT: 13})
    visit.calibration = {joint: one for joint, one in SURE.items() if joint is not Joint.LEFT_KNEE}
    feedback.show_reasons()
    feedback.look()
    assert aimed(feedback) is None
    assert feedback.view.in_words == "One moment"
    assert "Knee in swing, left: no longer a target." in status(feedback)
    visit.calibration = SURE
    feedback.show_reasons()
    feedback.look()
    assert feedback.view.in_words == "13 steps so far"
    assert "No target yet." in status(feedback)
    card.target.set_value(55)
    card.target.committed.emit()
    assert aimed(feedback) == KNEE


def test_f11_opens_it_full_and_what_was_chosen_comes_back(feedback: PatientFeedback) -> None:
    feedback.close()
    feedback.toggle_full_screen()
    assert feedback.window is not None
    assert feedback.window.isFullScreen()
    assert card_of(feedback).full.text() == "Small window"
    feedback.toggle_full_screen()
    assert not feedback.window.isFullScreen()
    assert card_of(feedback).full.text() == "Full screen"
    feedback.toggle()
    feedback.toggle()
    assert feedback.window is not None
    assert not feedback.window.isFullScreen()


def test_it_is_judged_though_no_page_ticks_as_under_the_manual(
    qtbot: QtBot, feedback: PatientFeedback, estimator: Reported
) -> None:
    reach(qtbot, feedback, estimator, 60)
    estimator.show_message(missing=(Site.LEFT_SHANK,))
    qtbot.waitUntil(lambda: feedback.view.is_waiting)


def test_the_tone_is_off_by_choice_and_why_nothing_sounds_is_stated(
    qtbot: QtBot, feedback: PatientFeedback, estimator: Reported, received: list[Sound], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sounds, "has_output", lambda: True)
    card = card_of(feedback)
    feedback.look()
    assert has_sound(feedback)
    assert "ound" not in status(feedback)
    monkeypatch.setattr(sounds, "has_output", lambda: False)
    feedback.look()
    assert not has_sound(feedback)
    assert "No sound output was found." in status(feedback)
    monkeypatch.setattr(sounds, "is_on", lambda: False)
    feedback.look()
    assert "Sounds are off." in status(feedback)
    monkeypatch.undo()
    monkeypatch.setattr(sounds, "play", received.append)
    card.tone.setChecked(False)
    assert "Sounds are off." not in status(feedback)
    reach(qtbot, feedback, estimator, 60)
    assert received == []
    card.tone.setChecked(True)
    estimator.show_message(*knee(61.0))
    qtbot.waitUntil(lambda: feedback.view.last == (60, 61))
    assert received == [Sound.REACHED]


def test_the_samples_that_are_played_hold_one_tone_for_each_step_that_reached(
    qtbot: QtBot, feedback: PatientFeedback, estimator: Reported, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the samples that the player is given, one file after the other."""
    monkeypatch.undo()  # of what notes the sounds
    played = tmp_path / "played"
    takes = f"import sys; open({str(played)!r}, 'ab').write(open(sys.argv[-1], 'rb').read()[44:] + bytes(9600))"
    monkeypatch.setattr(sounds, "_loudspeaker", Loudspeaker([[sys.executable, "-c", takes]]))

    def tones() -> list[tuple[float, float]]:
        samples = np.frombuffer(played.read_bytes() if played.exists() else b"", "<i2").astype(float)
        return spans_s(samples, 48_000.0, 880.0)

    def wait_for(value: int, count: int) -> None:
        qtbot.waitUntil(lambda: shown(feedback) == value and len(tones()) == count)

    expected = 0
    for value in (54.4, 60.0, 50.0, 55.0, 54.5, 40.0, 61.0):
        estimator.show_message(*knee(value))
        expected += value >= 54.5
        wait_for(math.floor(value + 0.5), expected)
    assert expected == 4
    assert all(0.1 < end_s - begin_s < 0.25 for begin_s, end_s in tones())
    samples = np.frombuffer(played.read_bytes(), "<i2").astype(float)
    assert np.abs(samples).max() > 1000.0


def test_closed_by_its_frame_it_neither_sounds_nor_counts_until_it_is_opened_again(
    qtbot: QtBot, feedback: PatientFeedback, estimator: Reported, received: list[Sound]
) -> None:
    feedback.begin_walk()
    feedback.metronome.start(100)
    window = feedback.window
    assert window is not None
    with qtbot.waitSignal(window.closed):
        window.close()  # as its frame's button does
    assert not window.isVisible()
    was_open = feedback.is_open
    assert card_of(feedback).isHidden()
    assert feedback.metronome.beats_per_min == 0
    estimator.show_message(*knee(60.0))
    qtbot.wait(20)
    assert received == []
    assert feedback.end_walk() == ()
    feedback.toggle()
    assert (was_open, feedback.is_open) == (False, True)
    assert feedback.window is not window
    assert aimed(feedback) == KNEE  # what was typed stays


def test_the_patient_is_not_named_on_it(feedback: PatientFeedback) -> None:
    assert feedback.window is not None
    assert feedback.window.windowTitle() == "Patient screen"


def reasons(
    worn: tuple[Site, ...] = LEG_SITES,
    rested: tuple[Site, ...] = LEG_SITES,
    calibration: Mapping[Joint, JointCalibration] = SURE,
    prosthetic: frozenset[Side] = frozenset(),
) -> dict[str, str]:
    found = reasons_against(worn, rested, calibration, prosthetic)
    return {" ".join(filter(None, (side, measure))): reason for (measure, side), reason in found.items()}


def test_reasons_are_stated_in_words_of_what_is_gated_only(snapshot: SnapshotAssertion) -> None:
    without_zero = {**SURE, Joint.LEFT_KNEE: replace(SURE[Joint.LEFT_KNEE], zero=ZeroKind.NONE)}
    assert {
        "nothing": reasons(),
        "no standing reference and a prosthetic foot": reasons(
            calibration=without_zero, prosthetic=frozenset({Side.RIGHT})
        ),
        "no sensors": reasons((), (), {}),
        "one leg": reasons(tuple(site for site in LEG_SITES if site.side is Side.LEFT)),
        "a sensor that was not still": reasons(rested=tuple(one for one in LEG_SITES if one is not Site.RIGHT_THIGH)),
        "not calibrated": reasons(calibration={}),
    } == snapshot


def test_a_walk_without_a_target_shows_the_steps_that_the_operator_sees(feedback: PatientFeedback) -> None:
    card_of(feedback).target_set.emit(None)
    feedback.count({Side.LEFT: 13, Side.RIGHT: 12})
    assert feedback.view.in_words == "One moment"  # nothing is recorded
    feedback.begin_walk()
    assert feedback.view.in_words == "0 steps so far"
    feedback.count({Side.LEFT: 13, Side.RIGHT: 12})
    assert feedback.window is not None
    assert feedback.window.view.in_words == "13 steps so far"
    feedback.end_walk()
    assert feedback.window.view.in_words == "One moment"
