"""What is stated while sensors are brought onto one clock, and of each way in which that may fail."""

import pytest
from syrupy.assertion import SnapshotAssertion

from app.wizard.sensor_sync import REASONS, SensorSync, SyncView, lines_of, progress_of, sentence_of
from devices.dot.synchronising import SyncFailure, SyncStage

NAMES = ("DOT 0001", "DOT 0002", "DOT 0003")


def test_each_stage_has_its_sentence_and_sensors_before_the_one_that_it_is_about_are_done(
    snapshot: SnapshotAssertion,
) -> None:
    views = {
        "preparing, before the first": SyncView(SyncStage.PREPARING, ""),
        "preparing the second": SyncView(SyncStage.PREPARING, "DOT 0002"),
        "waiting for all": SyncView(SyncStage.WAITING, ""),
        "connecting to the first": SyncView(SyncStage.CONNECTING, "DOT 0001"),
        "listening to all": SyncView(SyncStage.LISTENING, ""),
    }
    assert {
        case: (sentence_of(view), [line.state.name for line in lines_of(view, NAMES)]) for case, view in views.items()
    } == snapshot


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
