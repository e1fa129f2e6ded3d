"""When the patient is standing, on slow walkers and on people after a stroke; and why a target has no value."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from app.patient_screen.patient_view import PatientView
from app.wizard.losses import NOTHING
from app.wizard.walking.estimator import WalkingEstimator
from app.wizard.walking.patient_status import STANDING_AFTER_S, hindrance, is_standing, status_of
from app.wizard.walking.readout import LiveLane, LiveTrace, PhaseSpan, WalkingReadout
from core.body import LEG_SITES, Joint, Side, Site
from core.calibration.rest import rest_of
from core.calibration.strap import Slip
from core.gait.phases import Phase
from core.live.sensors import LiveSensor
from core.results import JointCalibration
from core.samples import ImuBlock
from core.session import Recording
from core.targets import Target, TargetMeasure
from devices.files.session_folder import read_session
from devices.simulation.walker import DEMONSTRATION, FreeMotion, GaitChange, Manner, Standing, Walk
from tests.core.cut_blocks import part_of
from tests.simulated import analysis_of, simulation_of

RATE_HZ, LOOK_S = 100.0, 0.2
KNEE = Target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, 55)
BEAT = Target(TargetMeasure.CADENCE, None, 110)
Looked = list[tuple[float, bool]]


def looked_at(
    blocks: Mapping[Site, ImuBlock], calibration: Mapping[Joint, JointCalibration] | None = None
) -> tuple[Looked, WalkingEstimator]:
    """Play it to an estimator; five times a second, whether the patient seems to stand."""
    sensors = {}
    for block in blocks.values():
        rest = rest_of(block)
        sensors[block.sensor] = LiveSensor(RATE_HZ, np.zeros(3) if rest is None else rest.gyr_rad_s)
    estimator = WalkingEstimator({block.sensor: site for site, block in blocks.items()}, sensors, calibration or {})
    first_s = min(float(block.time_s[0]) for block in blocks.values())
    last_s = max(float(block.time_s[-1]) for block in blocks.values())
    looked = []
    for from_s in np.arange(first_s, last_s - LOOK_S, LOOK_S).tolist():
        estimator.update({block.sensor: part_of(block, from_s, from_s + LOOK_S) for block in blocks.values()})
        looked.append((from_s - first_s + LOOK_S, is_standing(estimator.state)))
    return looked, estimator


def one_after_the_other(recordings: list[Recording]) -> tuple[dict[Site, ImuBlock], list[float]]:
    """Join them without a break; and when each ends."""
    parts: dict[Site, list[ImuBlock]] = {}
    ends_s = [0.0]
    for recording in recordings:
        first_s = min(float(block.time_s[0]) for block in recording.imu.values())
        for site, block in recording.imu.items():
            time_s = block.time_s - first_s + ends_s[-1]
            parts.setdefault(site, []).append(ImuBlock(block.sensor, time_s, block.gyr_rad_s, block.acc_m_s2))
        ends_s.append(max(float(of_site[-1].time_s[-1]) for of_site in parts.values()) + 1.0 / RATE_HZ)
    joined = {
        site: ImuBlock(
            blocks[0].sensor,
            np.concatenate([block.time_s for block in blocks]),
            np.concatenate([block.gyr_rad_s for block in blocks]),
            np.concatenate([block.acc_m_s2 for block in blocks]),
        )
        for site, blocks in parts.items()
    }
    return joined, ends_s[1:]


@pytest.mark.parametrize(
    ("manner", "slower"), [(Manner.ORDINARY, 0.25), (Manner.HEMIPARETIC, 0.5), (Manner.TOE_FIRST, 0.4)]
)
def test_a_stride_of_two_and_a_half_seconds_is_no_standing_and_half_a_minute_after_the_walk_is(
    manner: Manner, slower: float
) -> None:
    walk = Walk(speed_m_s=0.3, strides=6, manner=manner, change=GaitChange(time=slower))
    required = (Standing(duration_s=5.0), FreeMotion(), walk, Standing(name="pause", duration_s=30.0))
    made = simulation_of(replace(DEMONSTRATION, rate_hz=RATE_HZ, recordings=required))
    true_s = made.truth.recordings["walk 1"].feet[Side.LEFT].events.initial_contact_s
    assert np.mean(np.diff(true_s)) == pytest.approx(2.5, abs=0.15)
    first, _free, before, pause = made.session.recordings
    blocks, (begins_s, stops_s, ends_s) = one_after_the_other([first, before, pause])
    one_foot = {Site.LEFT_FOOT: blocks[Site.LEFT_FOOT]}  # whose stance is half of the time that two can be watched
    ways: list[tuple[dict[Site, ImuBlock], Mapping[Joint, JointCalibration]]] = [(one_foot, {})]
    if manner is Manner.ORDINARY:
        ways.append(({site: blocks[site] for site in LEG_SITES}, analysis_of(made.session).calibrations[-1].joints))
    for worn, calibration in ways:
        looked, _ = looked_at(worn, calibration)
        contacts_s = true_s - float(before.imu[Site.LEFT_FOOT].time_s[0]) + begins_s
        amid = [is_still for at_s, is_still in looked if contacts_s[0] < at_s < contacts_s[-1]]
        assert len(amid) > 25
        assert not any(amid)
        pausing = [is_still for at_s, is_still in looked if stops_s + STANDING_AFTER_S + 1.0 < at_s < ends_s]
        assert len(pausing) > 125
        assert all(pausing)


def test_nobody_who_walks_after_a_stroke_seems_to_stand(test_data: Callable[[str], Path]) -> None:
    for folder in sorted(test_data("stroke_treadmill").glob("stroke*")):
        (walk,) = read_session(folder).recordings
        first_s = min(float(block.time_s[0]) for block in walk.imu.values())
        looked, estimator = looked_at({site: part_of(one, 0.0, first_s + 12.0) for site, one in walk.imu.items()})
        assert not any(is_still for _, is_still in looked), folder.name
        assert estimator.state.values_reported > 0


def flat(since_s: float) -> LiveLane:
    return LiveLane((PhaseSpan(Phase.FOOT_FLAT, since_s, None),))


def test_who_has_not_been_seen_on_the_floor_yet_or_sends_nothing_does_not_stand() -> None:
    is_still = WalkingReadout(now_s=10.0, lanes={Side.LEFT: flat(2.0), Side.RIGHT: flat(3.0)})
    assert is_standing(is_still)
    assert not is_standing(replace(is_still, lanes={Side.LEFT: flat(2.0), Side.RIGHT: LiveLane()}))
    assert not is_standing(replace(is_still, lanes={Side.LEFT: flat(2.0), Side.RIGHT: flat(9.0)}))
    assert not is_standing(replace(is_still, lanes={}))
    silent = replace(is_still, lanes={Side.LEFT: flat(2.0), Side.RIGHT: flat(9.0)}, missing=(Site.RIGHT_FOOT,))
    assert is_standing(silent)  # by the other
    assert not is_standing(replace(silent, missing=(Site.RIGHT_FOOT, Site.LEFT_FOOT)))
    assert not is_standing(WalkingReadout())


@pytest.mark.parametrize(("sway_deg", "is_still"), [(5.0, True), (12.0, False)])
def test_who_sways_is_standing_and_who_bends_a_knee_is_not(sway_deg: float, is_still: bool) -> None:
    time_s = np.arange(0.0, 10.0, 0.01)
    angles_rad = np.deg2rad(0.5 * sway_deg * np.sin(2 * np.pi * 0.7 * time_s))
    angles_rad[-30:-20] = np.nan
    lanes = {Side.LEFT: flat(2.0), Side.RIGHT: flat(3.0)}
    view = WalkingReadout(now_s=10.0, lanes=lanes, joints={Joint.LEFT_KNEE: LiveTrace(time_s, angles_rad)})
    assert is_standing(view) is is_still


def test_what_hinders_names_the_part_of_the_leg_that_is_aimed_at_only(snapshot: SnapshotAssertion) -> None:
    silent = WalkingReadout(missing=(Site.LEFT_SHANK,), slips=(Slip(Site.LEFT_FOOT, 1.0, 0.3),))
    one = WalkingReadout(missing=(Site.LEFT_FOOT,))
    assert {
        "nothing": hindrance(KNEE, WalkingReadout(), LEG_SITES),
        "the other leg": hindrance(KNEE, WalkingReadout(missing=(Site.RIGHT_SHANK,)), LEG_SITES),
        "silent before slipped": hindrance(KNEE, silent, LEG_SITES),
        "slipped": hindrance(KNEE, replace(silent, missing=()), LEG_SITES),
        "an angle that no knee has": hindrance(KNEE, WalkingReadout(implausible=(Joint.LEFT_KNEE,)), LEG_SITES),
        "of the other knee": hindrance(KNEE, WalkingReadout(implausible=(Joint.RIGHT_KNEE,)), LEG_SITES),
        "cadence by the other foot": hindrance(BEAT, one, LEG_SITES),
        "cadence by neither": hindrance(BEAT, replace(one, doubtful=(Site.RIGHT_FOOT,)), LEG_SITES),
        "cadence without a foot sensor": hindrance(BEAT, WalkingReadout(), ()),
    } == snapshot


def test_every_state_has_its_words(snapshot: SnapshotAssertion) -> None:
    assert {
        "no target": status_of(PatientView(), NOTHING, is_recording=True),
        "no walk": status_of(PatientView(KNEE), NOTHING, is_recording=False),
        "one step": status_of(PatientView(KNEE, (54,)), NOTHING, is_recording=True),
        "standing": status_of(PatientView(KNEE, (54, 56), is_standing=True), NOTHING, is_recording=True),
        "no step yet": status_of(PatientView(BEAT), NOTHING, is_recording=True),
    } == snapshot
