"""What is stated while sensors are brought onto one clock, and of each way in which that may fail."""

import pytest

from app.widgets.sensors_progress import LineState
from app.wizard.sensor_sync import REASONS, SensorSync, SyncView, lines_of, progress_of, sentence_of
from devices.dot.synchronising import SyncFailure, SyncStage

NAMES = ("DOT 0001", "DOT 0002", "DOT 0003")
DONE, NOW, TO_DO = LineState.DONE, LineState.NOW, LineState.TO_DO


@pytest.mark.parametrize(
    ("stage", "sensor", "stated"),
    [
        (SyncStage.PREPARING, "", "Connecting to the sensors."),
        (SyncStage.PREPARING, "DOT 0002", "DOT 0002 is being set up."),
        (SyncStage.WAITING, "", "The sensors are comparing their clocks automatically. Leave them where they are."),
        (SyncStage.CONNECTING, "DOT 0001", "Checking the result of DOT 0001."),
        (SyncStage.LISTENING, "", "Comparing the sensor clocks."),
    ],
)
def test_each_stage_has_its_sentence(stage: SyncStage, sensor: str, stated: str) -> None:
    assert sentence_of(SyncView(stage, sensor)) == stated


@pytest.mark.parametrize(
    ("stage", "sensor", "states"),
    [
        (SyncStage.PREPARING, "", [TO_DO, TO_DO, TO_DO]),
        (SyncStage.PREPARING, "DOT 0002", [DONE, NOW, TO_DO]),
        (SyncStage.WAITING, "", [NOW, NOW, NOW]),
        (SyncStage.CONNECTING, "DOT 0001", [NOW, TO_DO, TO_DO]),
        (SyncStage.LISTENING, "", [DONE, DONE, DONE]),
    ],
)
def test_sensors_before_the_one_that_it_is_about_are_done(
    stage: SyncStage, sensor: str, states: list[LineState]
) -> None:
    assert [line.state for line in lines_of(SyncView(stage, sensor), NAMES)] == states


def test_every_failure_has_its_reason() -> None:
    assert set(REASONS) == set(SyncFailure)
    assert len(set(REASONS.values())) == len(REASONS)


class _Shown(SensorSync):
    """One that shows what it is given to."""

    def __init__(self, view: SyncView) -> None:
        super().__init__(None)  # type: ignore[arg-type]  # it belongs to nobody
        self.view = view


@pytest.mark.parametrize(
    ("left_s", "attempt", "sentence", "title"),
    [
        (22.0, 1, "About 25 s left.", "The sensors are being synchronised"),
        (4.0, 2, "", "Some sensors did not synchronise: all are being synchronised again"),
        (None, 1, "", "The sensors are being synchronised"),
    ],
)
def test_how_long_it_takes_is_reported_unless_that_is_soon(
    left_s: float | None, attempt: int, sentence: str, title: str
) -> None:
    shown = progress_of(_Shown(SyncView(SyncStage.WAITING, "", left_s, 0.5, attempt)), NAMES)
    assert (sentence in shown.sentence) if sentence else ("are left" not in shown.sentence)
    assert shown.title == title
    assert shown.stop == "Cancel"
