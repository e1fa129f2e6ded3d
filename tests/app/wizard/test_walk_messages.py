"""What is stated about a walk: what is not counted for want of a sensor, when its angles come, and what it lacks."""

from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.acquisition.memory_fetching import Lack
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
from tests.app.wizard.begun_visit import record
from tests.app.wizard.pressing import press

FEET = frozenset((Site.LEFT_FOOT, Site.RIGHT_FOOT))
ALL = frozenset(LEG_SITES)


def test_strides_that_are_not_counted_live_are_reported_and_angles_promised_for_when_they_come(
    snapshot: SnapshotAssertion,
) -> None:
    worn = {
        "all": ALL,
        "no feet": ALL - FEET,
        "no left foot": ALL - {Site.LEFT_FOOT},
        "a right leg without its foot": frozenset({Site.RIGHT_THIGH, Site.RIGHT_SHANK}),
        "a left leg: nobody asks for one that wears none": frozenset(
            {Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT}
        ),
    }
    assert {case: (no_foot_message(sites), no_angles_message(sites)) for case, sites in worn.items()} == snapshot


def test_what_a_walk_lacks_is_reported_the_gravest_first(snapshot: SnapshotAssertion) -> None:
    lacks = {
        "nothing": (),
        "samples": (Lack("DOT 0003", lost=12),),
        "samples of one and the end of another": (Lack("DOT 0003", 12), Lack("DOT 0004", 0, 20.4)),
        "an end that was not reported": (Lack("DOT 0003", is_end_known=False),),
    }
    strides = {
        "enough for a spread": {Side.LEFT: 12},
        "too few of one leg": {Side.LEFT: 12, Side.RIGHT: 4},
        "too few of the only leg": {Side.LEFT: 9},
    }
    assert {
        "could not be fetched": {case: lacks_message("A Shoes", one) for case, one in lacks.items()},
        "strides": {case: few_strides_message(one) for case, one in strides.items()},
        "without one clock": loose_message(["DOT 0003"]),
        "clocks that drift": loose_message([]),
    } == snapshot


def test_who_walks_without_foot_sensors_reads_why_nothing_is_counted(
    qtbot: QtBot, looked_at: Visit, worn: dict[str, Site]
) -> None:
    visit = looked_at
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
