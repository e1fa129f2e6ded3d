"""Which measures may be a target, by the calibration alone: one test for what closes each, one where nothing does."""

from dataclasses import replace
from typing import Any

import pytest

from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site
from core.results import ZeroKind
from core.targets import TargetMeasure
from core.verdicts.live_targets import assess_target
from core.verdicts.model import Verdict
from tests.core.verdicts.built_walk import calibration

ALL = LEG_SITES
SURE = {joint: calibration(joint) for joint in LEG_JOINTS}


@pytest.mark.parametrize("measure", TargetMeasure)
def test_with_six_sensors_and_a_sure_calibration_every_measure_may_be_a_target(measure: TargetMeasure) -> None:
    side = Side.LEFT if measure.has_side else None
    assert assess_target(measure, side, ALL, SURE, ()).verdict is Verdict.READ


@pytest.mark.parametrize(
    ("changes", "gate"),
    [
        ({"zero": ZeroKind.NONE}, "zero"),
        ({"is_sign_certain": False, "clinical_sign_margin": 0.1}, "sign"),
        ({"sign_margin": 1.1}, "pairing"),
        ({"axis_sd_rad": 0.2}, "axis"),
        ({"lag_sd_s": 0.02}, "lag"),
    ],
)
def test_a_gated_knee_is_no_target_and_the_other_knee_is(changes: dict[str, Any], gate: str) -> None:
    reported = {**SURE, Joint.LEFT_KNEE: replace(SURE[Joint.LEFT_KNEE], **changes)}
    found = assess_target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, ALL, reported, ())
    assert not found.is_reported
    assert [reason.gate for reason in found.reasons] == [gate]
    assert assess_target(TargetMeasure.KNEE_SWING_PEAK, Side.RIGHT, ALL, reported, ()).is_reported
    assert assess_target(TargetMeasure.FOOT_STRIKE, Side.LEFT, ALL, reported, ()).is_reported


def test_a_knee_without_a_calibration_or_without_a_foot_sensor_is_no_target() -> None:
    knee = TargetMeasure.KNEE_SWING_PEAK
    assert assess_target(knee, Side.LEFT, ALL, {}, ()).verdict is Verdict.NOT_MEASURED
    without = tuple(site for site in ALL if site is not Site.LEFT_FOOT)
    assert assess_target(knee, Side.LEFT, without, SURE, ()).verdict is Verdict.NOT_MEASURED
    assert assess_target(knee, Side.RIGHT, without, SURE, ()).is_reported


def test_stances_are_no_target_beside_a_prosthetic_foot_or_with_one_foot_sensor() -> None:
    found = assess_target(TargetMeasure.STANCE_RATIO, Side.RIGHT, ALL, SURE, (Side.LEFT,))
    assert found.verdict is Verdict.NOT_REPORTED
    assert [reason.gate for reason in found.reasons] == ["toe_off"]
    one = (Site.LEFT_FOOT,)
    assert assess_target(TargetMeasure.STANCE_RATIO, Side.LEFT, one, SURE, ()).verdict is Verdict.NOT_MEASURED
    assert assess_target(TargetMeasure.CADENCE, None, one, SURE, ()).is_reported
    assert assess_target(TargetMeasure.FOOT_STRIKE, Side.RIGHT, one, SURE, ()).verdict is Verdict.NOT_MEASURED
    assert assess_target(TargetMeasure.CADENCE, None, (Site.LEFT_SHANK,), SURE, ()).verdict is Verdict.NOT_MEASURED
