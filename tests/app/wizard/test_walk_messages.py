"""What is stated about a walk: what is not counted for want of a sensor, when its angles come, and what it lacks."""

import pytest
from pytestqt.qtbot import QtBot

from app.acquisition.memory_fetching import Lack
from app.wizard.losses import NOTHING
from app.wizard.visit import Visit
from app.wizard.walk_messages import (
    few_strides_message,
    lacks_message,
    loose_message,
    no_angles_message,
    no_foot_message,
)
from app.wizard.walking.step import WalkingStep
from core.body import LEG_SITES, Side, Site
from core.session import RecordingKind
from tests.app.wizard.begun_visit import begin, record
from tests.app.wizard.pressing import press

FEET = frozenset((Site.LEFT_FOOT, Site.RIGHT_FOOT))
ALL = frozenset(LEG_SITES)


@pytest.mark.parametrize(
    ("worn", "stated"),
    [
        (ALL, ""),
        (ALL - FEET, "No foot sensors: strides are counted after the walk."),
        (ALL - {Site.LEFT_FOOT}, "No left foot sensor: left strides are counted after the walk."),
        ({Site.RIGHT_THIGH, Site.RIGHT_SHANK}, "No right foot sensor: right strides are counted after the walk."),
        ({Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT}, ""),  # nobody asks for a leg that wears none
    ],
)
def test_strides_that_are_not_counted_live_are_reported(worn: frozenset[Site], stated: str) -> None:
    assert no_foot_message(worn)[0] == stated


def test_angles_are_promised_for_when_they_come() -> None:
    assert "five strides" in no_angles_message(ALL)[1]
    assert "The angles appear when the walk has been stopped" in no_angles_message(ALL - FEET)[1]


@pytest.mark.parametrize(
    ("lacks", "stated"),
    [
        ((), ""),
        ((Lack("DOT 0003", lost=12),), "Samples of A Shoes could not be fetched: DOT 0003 12."),
        ((Lack("DOT 0003", 12), Lack("DOT 0004", 0, 20.4)), "DOT 0004 stopped 20 s before the end of A Shoes."),
        ((Lack("DOT 0003", is_end_known=False),), "DOT 0003 did not report the end of A Shoes."),
    ],
)
def test_what_could_not_be_fetched_is_reported_the_gravest_first(lacks: tuple[Lack, ...], stated: str) -> None:
    assert lacks_message("A Shoes", lacks)[0] == stated


def test_sensors_without_one_clock_are_named_or_stated_to_drift() -> None:
    assert loose_message(["DOT 0003"])[0] == "Not synchronised: DOT 0003."
    assert "half an hour ago" in loose_message([])[0]


def test_only_what_is_short_of_a_spread_is_reported() -> None:
    assert few_strides_message({Side.LEFT: 12}) == NOTHING
    assert (
        few_strides_message({Side.LEFT: 12, Side.RIGHT: 4})[0] == "Only 4 right strides; a standard deviation needs 10."
    )
    assert few_strides_message({Side.LEFT: 9})[0] == "Only 9 left strides; a standard deviation needs 10."


def test_who_walks_without_foot_sensors_reads_why_nothing_is_counted(
    qtbot: QtBot, visit: Visit, worn: dict[str, Site], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(visit, "evaluate", lambda: None)
    begin(qtbot, visit, worn)
    visit.sensors.assign_all({name: site for name, site in worn.items() if site not in FEET})
    for kind in (RecordingKind.STANDING, RecordingKind.FREE_MOTION):
        record(qtbot, visit, kind, 0.5)
    step = WalkingStep(visit)
    qtbot.addWidget(step.page)
    step.enter()
    with qtbot.waitSignal(visit.recordings.begun):
        press(step)
    step.tick()
    assert step.page.notice.text.startswith("No foot sensors: strides are counted after the walk.")
    with qtbot.waitSignal(visit.recordings.ended):
        press(step)
    step.leave()
