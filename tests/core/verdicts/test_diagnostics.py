"""Tests that what is shown of a joint's finding agrees with the analysis.

Where all of the truth is known, it agrees with that too.
"""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import LEG_SITES, Joint, Side
from core.results import Analysis, Method
from core.session import Session
from core.verdicts.diagnostics import diagnostics_of
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings
from tests.core.recorded_joints import TestData, mechanism, session_of_mechanism
from tests.simulated import simulation_of

KNEE = Joint.LEFT_KNEE


@pytest.fixture(scope="module")
def analysis(knee_visit: Session) -> Analysis:
    return analyse(knee_visit)


def test_figures_are_those_of_the_analysis(knee_visit: Session, analysis: Analysis) -> None:
    calibration = analysis.calibrations[0].joints[KNEE]
    found = diagnostics_of(knee_visit, calibration, "walk")
    assert found is not None
    assert found.from_recordings == ("free motion",)
    np.testing.assert_allclose(found.costs[0].axis, calibration.axis_proximal, atol=1e-12)
    np.testing.assert_allclose(found.costs[1].axis, calibration.axis_distal, atol=1e-12)
    walk = analysis.recordings[-1]
    np.testing.assert_allclose(found.ways.time_s, walk.time_s, atol=1e-9)
    np.testing.assert_allclose(found.clinical(found.ways.fused_rad), walk.joints[KNEE].published_rad, atol=1e-9)
    assert found.published_apart_rad < np.deg2rad(1.0)  # a perfect hinge
    assert found.excitation.moving_s == pytest.approx(10.0, abs=0.5)
    assert found.excitation.sets == pytest.approx(100, abs=5)


def test_a_recording_without_the_joint_shows_nothing(knee_visit: Session, analysis: Analysis) -> None:
    calibration = analysis.calibrations[0].joints[KNEE]
    assert diagnostics_of(knee_visit, calibration, "no such walk") is None
    assert diagnostics_of(knee_visit, replace(calibration, joint=Joint.RIGHT_KNEE), "walk") is None


@pytest.mark.endurance  # a second of a real hinge
def test_on_a_real_hinge_the_pictures_agree_with_optics(test_data: TestData) -> None:
    data = mechanism(test_data, "1D_02")
    session = session_of_mechanism(data)
    found = diagnostics_of(session, analyse(session).calibrations[0].joints[KNEE], "hinge")
    assert found is not None
    assert abs(found.costs[0].lowest @ data["j1_ref"]) > np.cos(np.deg2rad(1.0))
    assert found.off_axis_rate_rad_s < np.deg2rad(3.0)
    assert found.projected is not None
    assert found.projected.congruence - found.projected.reversed_congruence > 0.5


@pytest.mark.endurance  # seconds for every kind of tissue
@pytest.mark.parametrize("method", list(Method))
@pytest.mark.parametrize("tissue", [Tissue.RIGID, Tissue.REAL])
def test_a_walking_patient_of_known_truth_is_shown_as_he_is(tissue: Tissue, method: Method) -> None:
    sites = tuple(site for site in LEG_SITES if site.side is Side.LEFT)
    settings = WalkerSettings(seed=5, tissue=tissue, sites=sites, recordings=(Standing(), FreeMotion(), Walk()))
    walked = simulation_of(settings)
    analysis = analyse(walked.session, method)
    walk = analysis.recordings[-1]
    for joint, calibration in analysis.calibrations[0].joints.items():
        found = diagnostics_of(walked.session, calibration, walk.name)
        assert found is not None
        truth = walked.truth.recordings[walk.name].joints[joint]
        if tissue is Tissue.RIGID and joint.is_knee:
            for cost, axis in zip(found.costs, (truth.axis_proximal, truth.axis_distal), strict=True):
                assert abs(cost.lowest @ axis) > np.cos(np.deg2rad(1.0))
            assert found.off_axis_rate_rad_s < np.deg2rad(2.0)
        late_s = 0.0 if joint.is_knee else walked.truth.recordings[walk.name].joints[KNEE].lag_s
        shown = np.interp(walk.time_s - late_s, found.ways.time_s, found.clinical(found.ways.fused_rad))
        np.testing.assert_allclose(shown, walk.joints[joint].published_rad, atol=np.deg2rad(0.01))
