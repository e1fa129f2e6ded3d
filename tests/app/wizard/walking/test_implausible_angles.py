"""An angle that no joint has is reported and not drawn: on the page and in its figures."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.wizard.losses import NOTHING
from app.wizard.walking import estimator as estimator_module
from app.wizard.walking.estimator import KEPT_S, WalkingEstimator
from app.wizard.walking.readout import LiveTrace, WalkingReadout
from app.wizard.walking.walk_notice import WalkNotice
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side
from core.gait.phases import Phase
from core.live.angle import AngleSamples
from core.live.sensors import LiveSensor
from core.live.stride_values import StrideValue, StrideValues
from core.live.walking import LiveFoot, LiveJoint, WalkingState
from core.samples import FloatArray, ImuBlock
from core.targets import TargetMeasure

STEP_S = 0.01
KNEE = Joint.LEFT_KNEE


class ReportedWalk:
    """What the angles and the feet are stated to be, in place of what follows from samples."""

    reported: Mapping[Joint, float] = {}

    def __init__(self, *_args: object) -> None:
        """Nothing is measured."""

    def update(self, worn: Mapping[Any, ImuBlock]) -> WalkingState:
        time_s = next(iter(worn.values())).time_s
        tick = np.round(time_s / STEP_S).astype(np.int64)
        still = np.zeros(len(time_s))
        joints = {
            joint: LiveJoint(AngleSamples(tick, time_s, np.full(len(time_s), np.deg2rad(deg)), still), False)
            for joint, deg in self.reported.items()
        }
        foot = LiveFoot((), (), Phase.UNKNOWN, np.nan, 0)
        return WalkingState(joints, dict.fromkeys(Side, foot))


@pytest.fixture
def walk(monkeypatch: pytest.MonkeyPatch) -> type[ReportedWalk]:
    monkeypatch.setattr(estimator_module, "LiveWalk", ReportedWalk)
    monkeypatch.setattr(
        StrideValues,
        "update",
        lambda _self, _state: tuple(
            StrideValue(measure, side, 60.0, 0.0, 0.0)
            for measure in (TargetMeasure.KNEE_SWING_PEAK, TargetMeasure.CADENCE)
            for side in Side
        ),
    )
    ReportedWalk.reported = dict.fromkeys(LEG_JOINTS, 20.0)
    return ReportedWalk


def an_estimator() -> WalkingEstimator:
    sensors = {str(site): LiveSensor(1 / STEP_S, np.zeros(3)) for site in LEG_SITES}
    calibration: Any = dict.fromkeys(LEG_JOINTS)
    return WalkingEstimator({str(site): site for site in LEG_SITES}, sensors, calibration)


def second(estimator: WalkingEstimator, from_s: float) -> WalkingReadout:
    return feed(estimator, from_s + np.arange(0.0, 1.0, STEP_S))


def feed(estimator: WalkingEstimator, time_s: FloatArray) -> WalkingReadout:
    blocks = {str(site): ImuBlock(str(site), time_s, *np.zeros((2, len(time_s), 3))) for site in LEG_SITES}
    estimator.update(blocks)
    return estimator.state


def peaks(view: WalkingReadout) -> set[Side]:
    return {one.side for one in view.stride_values if one.measure is TargetMeasure.KNEE_SWING_PEAK}


@pytest.mark.parametrize("deg", [-150.0, -41.0, 161.0])
def test_an_angle_that_no_knee_has_is_no_curve_and_no_figure(walk: type[ReportedWalk], deg: float) -> None:
    estimator = an_estimator()
    walk.reported = {**walk.reported, KNEE: deg}
    view = second(estimator, 0.0)
    assert view.implausible == (KNEE,)
    assert set(view.joints) == set(LEG_JOINTS) - {KNEE}
    assert peaks(view) == {Side.RIGHT}
    assert sum(one.measure is TargetMeasure.CADENCE for one in view.stride_values) == 2


@pytest.mark.parametrize("deg", [-39.0, 0.0, 159.0])
def test_an_angle_that_a_knee_may_have_is_drawn(walk: type[ReportedWalk], deg: float) -> None:
    walk.reported = {**walk.reported, KNEE: deg}
    view = second(an_estimator(), 0.0)
    assert (view.implausible, set(view.joints)) == ((), set(LEG_JOINTS))
    assert peaks(view) == set(Side)


def test_a_few_samples_that_cannot_be_are_left_out_of_the_curve(walk: type[ReportedWalk]) -> None:
    estimator = an_estimator()
    second(estimator, 0.0)
    walk.reported = {**walk.reported, KNEE: -48.0}
    feed(estimator, 1.0 + np.arange(0.0, 0.2, STEP_S))
    walk.reported = {**walk.reported, KNEE: 20.0}
    view = second(estimator, 1.2)
    assert view.implausible == ()
    angle_rad = view.joints[KNEE].angle_rad
    assert np.isnan(angle_rad).sum() == 20
    assert np.nanmin(angle_rad) > 0.0


def test_it_is_drawn_again_once_all_that_is_in_sight_can_be(walk: type[ReportedWalk]) -> None:
    estimator = an_estimator()
    walk.reported = {**walk.reported, KNEE: -150.0}
    assert second(estimator, 0.0).implausible == (KNEE,)
    walk.reported = {**walk.reported, KNEE: 20.0}
    assert second(estimator, 1.0).implausible == (KNEE,)
    assert second(estimator, KEPT_S + 2.0).implausible == ()


def test_it_is_stated_above_the_walks_while_one_goes_on() -> None:
    ongoing = SimpleNamespace(began_s=0.0)
    recordings = SimpleNamespace(
        ongoing=ongoing,
        is_recording=True,
        has_begun=True,
        standstill_message=lambda _worn: NOTHING,
        received_so_far=dict,
    )
    sensors = SimpleNamespace(acquisition=None, joints=[], hips=[], site_of={}, sensor_at={})
    visit: Any = SimpleNamespace(recordings=recordings, sensors=sensors)
    trace = LiveTrace(np.zeros(1), np.zeros(1))
    what, then = WalkNotice(visit).message(WalkingReadout(joints={Joint.RIGHT_KNEE: trace}, implausible=(KNEE,)))
    assert what == "Left knee: angle outside −40° to 160°, not shown."
    assert then == "Check the sensor positions, then record the free motion again."
    assert WalkNotice(visit).message(WalkingReadout(joints={KNEE: trace})) == NOTHING
