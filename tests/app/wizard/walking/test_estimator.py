"""The walking patient as the screen draws him: curves, lanes, strides, cadence, what is missing."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from app.wizard.walking.estimator import KEPT_S, WalkingEstimator
from app.wizard.walking.readout import WalkingReadout
from core.body import LEG_JOINTS, Joint, Side, Site
from core.gait.phases import Phase
from core.results import AxisSource
from core.samples import ImuBlock
from tests.app.wizard.dressed_patient import BEGIN_S, Worn, in_blocks, without
from tests.core.cut_blocks import part_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

ORDER = (Phase.LOADING, Phase.FOOT_FLAT, Phase.PRE_SWING, Phase.SWING)


def estimator_of(dressed: Worn) -> WalkingEstimator:
    return WalkingEstimator(dressed.site_of, dressed.live_sensors, dressed.calibration)


def fed(estimator: WalkingEstimator, streams: dict[str, ImuBlock], block_s: float = 0.03) -> list[WalkingReadout]:
    reported = []
    for block in in_blocks(streams, block_s):
        estimator.update(block)
        reported.append(estimator.state)
    return reported


@pytest.fixture(scope="module")
def usual(dressed: Worn) -> list[WalkingReadout]:
    return fed(estimator_of(dressed), dict(dressed.walk))


def test_curves_hold_the_last_seconds_of_every_joint(dressed: Worn, usual: list[WalkingReadout]) -> None:
    last = usual[-1]
    assert set(last.joints) == set(LEG_JOINTS)
    now_s = max(float(block.time_s[-1]) for block in dressed.walk.values())
    assert last.now_s == now_s
    for curve in last.joints.values():
        assert curve.time_s[0] == pytest.approx(now_s - KEPT_S, abs=0.02)
        assert curve.time_s[-1] > now_s - 0.1
        assert np.all(np.diff(curve.time_s) > 0)
        assert np.isfinite(curve.angle_rad).all()
    knee = np.rad2deg(last.joints[Joint.LEFT_KNEE].angle_rad)
    assert 50.0 < knee.max() < 75.0


def test_lanes_hold_whole_phases_in_their_order_and_the_last_one_lasts(usual: list[WalkingReadout]) -> None:
    walking = usual[len(usual) * 2 // 3]
    for side in Side:
        spans = walking.lanes[side].spans
        assert len(spans) > 12
        assert spans[-1].end_s is None
        for one, two in pairwise(spans):
            assert one.end_s == two.start_s > one.start_s
            assert two.phase is ORDER[(ORDER.index(one.phase) + 1) % len(ORDER)]
        assert spans[0].end_s is not None
        assert spans[0].end_s >= walking.now_s - KEPT_S
    assert [span.phase for span in usual[-1].lanes[Side.LEFT].spans][-1] is Phase.FOOT_FLAT  # is again


def test_a_lane_is_another_object_only_where_it_has_changed(usual: list[WalkingReadout]) -> None:
    for side in Side:
        lanes = [state.lanes[side] for state in usual]
        assert all((one is two) == (one == two) for one, two in pairwise(lanes))
        assert sum(one is not two for one, two in pairwise(lanes)) < len(lanes) / 3


def test_strides_and_cadence_are_reported_while_somebody_walks(usual: list[WalkingReadout]) -> None:
    assert math.isnan(usual[5].cadence_steps_min)
    assert usual[len(usual) // 2].cadence_steps_min == pytest.approx(112.0, abs=8.0)
    assert math.isnan(usual[-1].cadence_steps_min)
    assert all(count >= 12 for count in usual[-1].strides.values())


def test_a_walk_counts_its_own_strides(dressed: Worn, usual: list[WalkingReadout]) -> None:
    estimator = estimator_of(dressed)
    estimator.count_from(BEGIN_S + 8.0)
    last = fed(estimator, dict(dressed.walk))[-1]
    for side in Side:
        assert 3 < last.strides[side] < usual[-1].strides[side] - 3


@pytest.mark.parametrize("block_s", [60.0, pytest.param(0.017, marks=pytest.mark.endurance)])
def test_the_size_of_the_blocks_changes_nothing(dressed: Worn, usual: list[WalkingReadout], block_s: float) -> None:
    one, two = usual[-1], fed(estimator_of(dressed), dict(dressed.walk), block_s)[-1]
    for joint in LEG_JOINTS:
        np.testing.assert_array_equal(two.joints[joint].time_s, one.joints[joint].time_s)
        np.testing.assert_allclose(two.joints[joint].angle_rad, one.joints[joint].angle_rad, rtol=0, atol=1e-9)
    assert two.lanes == one.lanes
    assert (two.strides, two.missing, two.slips) == (one.strides, one.missing, one.slips)
    np.testing.assert_equal(two.cadence_steps_min, one.cadence_steps_min)


def test_a_foot_that_falls_silent_is_missing_and_leaves_a_gap(dressed: Worn) -> None:
    name, (from_s, to_s) = dressed.name_at(Site.RIGHT_FOOT), (BEGIN_S + 6.0, BEGIN_S + 8.0)
    reported = fed(estimator_of(dressed), {**dressed.walk, name: without(dressed.walk[name], from_s, to_s)})
    amid = next(state for state in reported if state.now_s > to_s - 0.2)
    assert amid.missing == (Site.RIGHT_FOOT,)
    lane = amid.lanes[Side.RIGHT]
    ((silent_from_s, silent_to_s),) = lane.silent_s
    assert silent_from_s == pytest.approx(from_s, abs=0.02)
    assert silent_to_s is None
    assert lane.spans[-1].end_s == pytest.approx(from_s, abs=0.02)
    assert amid.joints[Joint.RIGHT_ANKLE].time_s[-1] < from_s
    assert amid.joints[Joint.RIGHT_KNEE].time_s[-1] > to_s - 0.4
    assert math.isfinite(amid.cadence_steps_min)  # the other foot reports
    last = reported[-1]
    assert last.missing == ()
    ((then_from_s, then_to_s),) = last.lanes[Side.RIGHT].silent_s
    assert then_from_s == silent_from_s
    assert then_to_s == pytest.approx(to_s, abs=0.02)
    assert not any(span.start_s < to_s - 0.05 < (span.end_s or np.inf) for span in last.lanes[Side.RIGHT].spans)
    ankle = last.joints[Joint.RIGHT_ANKLE]
    in_gap = (ankle.time_s > from_s) & (ankle.time_s < to_s)
    assert in_gap.any()
    assert np.isnan(ankle.angle_rad[in_gap]).all()


def test_another_calibration_is_taken_at_the_next_update(dressed: Worn, usual: list[WalkingReadout]) -> None:
    joint = Joint.LEFT_ANKLE
    settled = dressed.calibration[joint]
    provisional = replace(settled, axis_source=AxisSource.FREE_MOTION, zero_rad=settled.zero_rad + 0.2)
    estimator = WalkingEstimator(dressed.site_of, dressed.live_sensors, {**dressed.calibration, joint: provisional})
    early = {name: part_of(block, BEGIN_S, BEGIN_S + 8.0) for name, block in dressed.walk.items()}
    late = {name: part_of(block, BEGIN_S + 8.0, BEGIN_S + 99.0) for name, block in dressed.walk.items()}
    assert fed(estimator, early)[-1].joints[joint].is_provisional
    estimator.recalibrate(joint, settled)
    assert estimator.state.joints[joint].is_provisional  # not yet
    last = fed(estimator, late)[-1].joints[joint]
    assert not last.is_provisional
    whole = usual[-1].joints[joint]
    np.testing.assert_allclose(last.angle_rad[-300:], whole.angle_rad[-300:], atol=0.02)
    assert np.max(np.abs(np.diff(last.angle_rad))) < 0.15  # no jump


def test_a_leg_of_one_joint_has_one_curve_and_no_lane(dressed: Worn) -> None:
    sites = (Site.LEFT_THIGH, Site.LEFT_SHANK)
    streams = {name: dressed.walk[name] for name, site in dressed.site_of.items() if site in sites}
    estimator = WalkingEstimator(
        {name: dressed.site_of[name] for name in streams}, dressed.live_sensors, dressed.calibration
    )
    last = fed(estimator, dict(dressed.walk))[-1]  # the others are received, and not dressed
    assert set(last.joints) == {Joint.LEFT_KNEE}
    assert not last.lanes
    assert not last.strides
    assert math.isnan(last.cadence_steps_min)


def test_a_state_that_was_read_stays_as_it_was(dressed: Worn) -> None:
    estimator, held = estimator_of(dressed), []
    for _ in range(4):  # past the arrays' room
        last_s = 0.0 if math.isnan(estimator.state.now_s) else estimator.state.now_s - BEGIN_S + 0.01
        later = {name: replace(block, time_s=block.time_s + last_s) for name, block in dressed.walk.items()}
        for block in in_blocks(later, 0.25):
            estimator.update(block)
            curve = estimator.state.joints[Joint.RIGHT_KNEE]
            held.append((curve, curve.time_s.copy(), curve.angle_rad.copy()))
    for curve, time_s, angle_rad in held:
        np.testing.assert_array_equal(curve.time_s, time_s)
        np.testing.assert_array_equal(curve.angle_rad, angle_rad)
    with pytest.raises(ValueError, match="read-only"):
        held[-1][0].angle_rad[0] = 0.0
