"""What may be stated about hips and pelvis: every gate closes where it must and nothing where it need not."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint, Side, Site
from core.gait.clocks import ClockTie
from core.hip.results import ClockStatus, LegClock
from core.results import Analysis, RecordingAnalysis
from core.verdicts.gates import HIP_NOT_FOUND, LIMITS, judged
from core.verdicts.model import NOT_MEASURED, Assessment, Verdict
from core.verdicts.quantities import OF_HIPS, abduction_curve, assessment_of, hip_peaks_percent, side_mean
from tests.core.hip.hip_sessions import analysed, rewalked, walk_of, with_hip


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return analysed(late_s=0.04)[1]


def gates(found: Assessment) -> list[str]:
    return [reason.gate for reason in found.reasons]


def scaled(analysis: Analysis, name: str, factor: float) -> Analysis:
    """With one figure of every stride of both legs changed."""

    def changed(walk: RecordingAnalysis) -> RecordingAnalysis:
        gait = {
            side: replace(one, parameters={**one.parameters, name: factor * one.parameters[name]})
            for side, one in walk.gait.items()
        }
        return replace(walk, gait=gait)

    return rewalked(analysis, changed)


def test_where_nothing_is_wrong_hips_and_pelvis_are_read(analysis: Analysis) -> None:
    walk = walk_of(analysis)
    for side in Side:
        for name in OF_HIPS:
            required = (
                Verdict.NOT_REPORTED if name == "pelvis_tilt_range_deg" else Verdict.READ
            )  # the walker's is 4 deg
            assert assessment_of(walk.verdicts, side, name).verdict is required


@pytest.mark.parametrize(
    ("change", "gate"),
    [
        ({"margin": 1.4}, "pairing"),
        ({"disagreement": 0.21}, "hip_disagreement"),
        ({"centre_distal_m": np.array([0.0, 0.0, 0.45])}, "hip_centre"),
        ({"centre_proximal_m": np.array([0.0, 0.0, 0.04])}, "hip_centre"),
        ({"centres_apart_m": -0.17}, "hips_apart"),
    ],
)
def test_a_hip_that_is_none_is_not_reported_with_its_reason_and_the_other_is_read(
    analysis: Analysis, change: dict[str, object], gate: str
) -> None:
    verdicts = walk_of(with_hip(analysis, Joint.LEFT_HIP, **change)).verdicts
    assert gates(verdicts.joint(Joint.LEFT_HIP).shape) == [gate]
    assert verdicts.joint(Joint.LEFT_HIP).height.verdict is Verdict.NOT_REPORTED
    assert assessment_of(verdicts, Side.LEFT, "hip_abduction_peak_deg").verdict is Verdict.NOT_REPORTED
    assert verdicts.joint(Joint.RIGHT_HIP).shape.verdict is Verdict.READ
    assert verdicts.joint(Joint.LEFT_KNEE).shape.verdict is Verdict.READ
    assert verdicts.pelvis.verdict is Verdict.READ  # the other hip gives its frame


def test_without_any_hip_the_pelvis_has_no_frame(analysis: Analysis) -> None:
    walk = walk_of(with_hip(analysis, Joint.LEFT_HIP, Joint.RIGHT_HIP, margin=1.2))
    assert gates(walk.verdicts.pelvis) == ["pairing"]
    assert np.isnan(side_mean(walk, Side.LEFT, "pelvis_obliquity_range_deg").found.mean)


def test_abduction_needs_a_sure_heading_and_flexion_does_not(analysis: Analysis) -> None:
    walk = walk_of(with_hip(analysis, Joint.LEFT_HIP, heading_sd_rad=np.deg2rad(7.0), is_3d=False))
    (reason,) = walk.verdicts.abduction[Side.LEFT].reasons
    assert (reason.gate, reason.limit) == ("hip_heading", 6.0)
    assert reason.value == pytest.approx(7.0)
    assert walk.verdicts.joint(Joint.LEFT_HIP).height.verdict is Verdict.READ
    assert np.isnan(side_mean(walk, Side.LEFT, "hip_abduction_range_deg").found.mean)
    assert np.isfinite(side_mean(walk, Side.LEFT, "hip_range_deg").found.mean)
    assert np.isnan(abduction_curve(walk, Side.LEFT).mean).all()
    assert np.isfinite(abduction_curve(walk, Side.RIGHT).mean).all()


def test_a_hip_that_leans_on_a_knee_of_unknown_sign_has_no_height(analysis: Analysis) -> None:
    spans = tuple(
        replace(
            span,
            joints={
                joint: replace(one, is_sign_certain=False, clinical_sign_margin=0.2)
                if joint is Joint.RIGHT_KNEE
                else one
                for joint, one in span.joints.items()
            },
        )
        for span in analysis.calibrations
    )
    walk = walk_of(judged(replace(analysis, calibrations=spans)))
    assert gates(walk.verdicts.joint(Joint.RIGHT_HIP).height) == ["sign"]
    assert walk.verdicts.joint(Joint.RIGHT_HIP).shape.verdict is Verdict.READ
    assert np.isnan(hip_peaks_percent(walk, Side.RIGHT)).all()
    used = walk.gait[Side.LEFT].strides.is_used
    assert np.isfinite(np.array(hip_peaks_percent(walk, Side.LEFT))[:, used]).all()


def test_a_tilt_is_reported_over_five_degrees_alone(analysis: Analysis) -> None:
    found = walk_of(analysis).verdicts.pelvis_tilt
    assert gates(found) == ["pelvis_tilt"]
    assert found.reasons[0].limit == LIMITS.pelvis_tilt_deg
    large = walk_of(scaled(analysis, "pelvis_tilt_range_rad", 2.0))
    assert large.verdicts.pelvis_tilt.verdict is Verdict.READ
    assert side_mean(large, Side.LEFT, "pelvis_tilt_range_deg").found.mean > LIMITS.pelvis_tilt_deg


@pytest.mark.parametrize(("deepest_deg", "required"), [(79.0, Verdict.READ), (81.0, Verdict.CARE)])
def test_of_a_deep_hip_the_pelvis_is_read_with_care(analysis: Analysis, deepest_deg: float, required: Verdict) -> None:
    def bent(walk: RecordingAnalysis) -> RecordingAnalysis:
        hip = walk.hips[Joint.LEFT_HIP]
        angle = hip.angle_rad.copy()
        angle[len(angle) // 2] = np.deg2rad(deepest_deg)
        return replace(walk, hips={**walk.hips, Joint.LEFT_HIP: replace(hip, angle_rad=angle)})

    found = walk_of(rewalked(analysis, bent)).verdicts.pelvis
    assert found.verdict is required
    assert gates(found) == (["hip_deep"] if required is Verdict.CARE else [])


def test_a_hip_that_was_worn_and_not_found_states_so_and_one_not_worn_states_nothing(analysis: Analysis) -> None:
    walk = walk_of(rewalked(analysis, lambda one: replace(one, hips={})))
    assert walk.verdicts.joint(Joint.LEFT_HIP) == HIP_NOT_FOUND
    without = rewalked(
        analysis,
        lambda one: replace(
            one, hips={}, pelvis=None, received={s: r for s, r in one.received.items() if s is not Site.PELVIS}
        ),
    )
    assert Joint.LEFT_HIP not in walk_of(without).verdicts.joints
    assert walk_of(without).verdicts.pelvis == walk_of(without).verdicts.pelvis_tilt == NOT_MEASURED


def test_clocks_the_hips_do_not_show_are_not_reported_with_what_that_takes(analysis: Analysis) -> None:
    def unknown(walk: RecordingAnalysis) -> RecordingAnalysis:
        assert walk.clocks is not None
        not_reported = LegClock(float("nan"), float("nan"), ClockStatus.NOT_REPORTED)
        clocks = replace(walk.clocks, tie=ClockTie.UNKNOWN, residual_s=float("nan"))
        return replace(walk, clocks=clocks, leg_clock=not_reported)

    not_reported = rewalked(analysis, unknown)
    assert gates(walk_of(not_reported).verdicts.between) == ["leg_clock"]
    without = rewalked(not_reported, lambda one: replace(one, leg_clock=None))
    assert gates(walk_of(without).verdicts.between) == ["clocks"]
    assert walk_of(analysis).verdicts.between.verdict is Verdict.READ
