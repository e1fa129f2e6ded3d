"""What other programs are given of an update: samples under the verdict of their joint, events of feet that hold."""

import math
from dataclasses import replace

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

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
LEFT_LEG = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)
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
) -> str:
    """Angles and statuses of the left knee as they leave."""
    reported = WalkingState({KNEE: joint}, slips=slips)
    chunk = chunk_of(reported, {KNEE: joint}, {**GOOD, KNEE: verdict}, implausible, ()).angles[KNEE]
    return f"{chunk.angle_deg.round(6).tolist()} {chunk.status.tolist()}"


def test_an_angle_leaves_under_the_verdict_of_its_joint(snapshot: SnapshotAssertion) -> None:
    """Angles and statuses: 0 is good, 1 needs care, and 2 is not reported and has no number."""
    two, one, provisional = joint_of(10.0, 20.0), joint_of(10.0), joint_of(10.0, is_provisional=True)
    slipped = {f"{site}: its strap moved": given(one, slips=(Slip(site, 5.0, 0.2),)) for site in LEFT_LEG}
    assert {str(verdict): given(two, verdict) for verdict in Verdict} | slipped | {
        "a gap, and the samples beside it stay": given(joint_of(10.0, math.nan, 20.0)),
        "provisional": given(provisional),
        "provisional makes nothing better": given(provisional, Verdict.NOT_REPORTED),
        "it cannot be": given(one, implausible=(KNEE,)),
        "another cannot be": given(one, implausible=(Joint.RIGHT_KNEE,)),
    } == snapshot


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
