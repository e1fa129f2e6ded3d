"""What other programs are given of an update: samples under the verdict of their joint, events of feet that hold."""

import math
from dataclasses import replace

import numpy as np
import pytest

from app.live_output.chunks import LiveChunk
from app.wizard.walking.estimator import WalkingEstimator
from app.wizard.walking.live_chunk import chunk_of, verdict_by
from core.body import LEG_JOINTS, Joint, Side, Site
from core.calibration.strap import Slip
from core.gait.live import FootEvent, LiveEvent
from core.gait.phases import Phase
from core.live.angle import AngleSamples
from core.live.walking import LiveFoot, LiveJoint, WalkingState
from core.results import ZeroKind
from core.verdicts.model import Verdict
from tests.app.wizard.dressed_patient import Worn, in_blocks

KNEE = Joint.LEFT_KNEE
GOOD = dict.fromkeys(LEG_JOINTS, Verdict.READ)


def joint_of(*degrees: float, is_provisional: bool = False) -> LiveJoint:
    count = len(degrees)
    tick = np.arange(count)
    angles = AngleSamples(tick, tick / 100.0, np.deg2rad(degrees), np.deg2rad(np.full(count, 2.0)))
    return LiveJoint(angles, is_provisional)


def given(
    joint: LiveJoint,
    verdict: Verdict = Verdict.READ,
    slips: tuple[Slip, ...] = (),
    implausible: tuple[Joint, ...] = (),
) -> tuple[list[float], list[int]]:
    """Angles and statuses of the left knee as they leave."""
    reported = WalkingState({KNEE: joint}, slips=slips)
    chunk = chunk_of(reported, {KNEE: joint}, {**GOOD, KNEE: verdict}, implausible, ()).angles[KNEE]
    return chunk.angle_deg.tolist(), chunk.status.tolist()


@pytest.mark.parametrize(("verdict", "status"), [(Verdict.READ, 0), (Verdict.CARE, 1)])
def test_an_angle_leaves_under_the_verdict_of_its_joint(verdict: Verdict, status: int) -> None:
    angles, statuses = given(joint_of(10.0, 20.0), verdict)
    assert angles == pytest.approx([10.0, 20.0])
    assert statuses == [status, status]


@pytest.mark.parametrize("verdict", [Verdict.NOT_REPORTED, Verdict.NOT_MEASURED])
def test_an_angle_that_is_not_reported_leaves_without_its_number(verdict: Verdict) -> None:
    angles, statuses = given(joint_of(10.0, 20.0), verdict)
    assert all(map(math.isnan, angles))
    assert statuses == [2, 2]


def test_a_gap_has_no_number_and_the_samples_beside_it_stay() -> None:
    angles, statuses = given(joint_of(10.0, math.nan, 20.0))
    assert statuses == [0, 2, 0]
    assert math.isnan(angles[1])
    assert [angles[0], angles[2]] == pytest.approx([10.0, 20.0])


def test_what_is_provisional_needs_care_and_is_not_made_better_by_it() -> None:
    assert given(joint_of(10.0, is_provisional=True))[1] == [1]
    assert given(joint_of(10.0, is_provisional=True), Verdict.NOT_REPORTED)[1] == [2]


def test_a_joint_that_cannot_be_is_not_reported() -> None:
    assert given(joint_of(10.0), implausible=(KNEE,))[1] == [2]
    assert given(joint_of(10.0), implausible=(Joint.RIGHT_KNEE,))[1] == [0]


@pytest.mark.parametrize(("site", "status"), [(Site.LEFT_SHANK, 2), (Site.LEFT_THIGH, 2), (Site.LEFT_FOOT, 0)])
def test_a_strap_that_moved_takes_the_joints_beside_it(site: Site, status: int) -> None:
    assert given(joint_of(10.0), slips=(Slip(site, 5.0, 0.2),))[1] == [status]


def foot(*events: LiveEvent, is_doubtful: bool = False) -> LiveFoot:
    return LiveFoot(events, (), Phase.SWING, 100.0, 3, is_doubtful=is_doubtful)


def test_contacts_and_toe_offs_leave_and_nothing_of_a_foot_in_doubt() -> None:
    contact, rise, off = (
        LiveEvent(event, time_s, time_s + 0.05)
        for event, time_s in (
            (FootEvent.INITIAL_CONTACT, 1.0),
            (FootEvent.HEEL_RISE, 1.4),
            (FootEvent.TOE_OFF, 1.6),
        )
    )
    feet = {Side.LEFT: foot(contact, rise, off), Side.RIGHT: foot(replace(contact, time_s=1.2, reported_s=1.25))}
    chunk = chunk_of(WalkingState(feet=feet), {}, GOOD, (), ())
    assert [(mark.side, mark.event, mark.time_s) for mark in chunk.events] == [
        (Side.LEFT, FootEvent.INITIAL_CONTACT, 1.0),
        (Side.RIGHT, FootEvent.INITIAL_CONTACT, 1.2),
        (Side.LEFT, FootEvent.TOE_OFF, 1.6),
    ]
    assert chunk.doubtful == ()
    doubted = chunk_of(WalkingState(feet={**feet, Side.LEFT: foot(contact, is_doubtful=True)}), {}, GOOD, (), ())
    assert [mark.side for mark in doubted.events] == [Side.RIGHT]
    assert doubted.doubtful == (Side.LEFT,)


def test_without_a_zero_no_absolute_angle_may_leave(dressed: Worn) -> None:
    knee = dressed.calibration[KNEE]
    assert verdict_by(knee) in (Verdict.READ, Verdict.CARE)
    assert verdict_by(replace(knee, zero=ZeroKind.NONE)) is Verdict.NOT_REPORTED


@pytest.mark.endurance  # a whole walk
def test_every_sample_that_is_drawn_leaves_once(dressed: Worn) -> None:
    estimator = WalkingEstimator(dressed.site_of, dressed.live_sensors, dressed.calibration)
    chunks: list[LiveChunk] = []
    estimator.on_chunk = chunks.append
    for block in in_blocks(dict(dressed.walk), 0.03):
        estimator.update(block)
    for joint in LEG_JOINTS:
        time_s = np.concatenate([chunk.angles[joint].time_s for chunk in chunks if joint in chunk.angles])
        angle_deg = np.concatenate([chunk.angles[joint].angle_deg for chunk in chunks if joint in chunk.angles])
        assert np.diff(time_s) == pytest.approx(1 / estimator.rates_hz[joint], abs=1e-6)
        drawn = estimator.state.joints[joint]
        last = len(drawn.time_s)
        assert time_s[-last:].tolist() == drawn.time_s.tolist()
        assert np.deg2rad(angle_deg[-last:]) == pytest.approx(drawn.angle_rad)
    contacts = {
        side: [m.time_s for chunk in chunks for m in chunk.events if (m.side, m.event) == (side, "initial_contact")]
        for side in Side
    }
    for side, times_s in contacts.items():
        assert len(times_s) - 1 == estimator.state.strides[side]
        assert np.all(np.diff(times_s) > 0)
