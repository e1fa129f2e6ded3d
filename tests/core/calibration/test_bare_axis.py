"""Tests that the axes of a joint without tissue are found from its bare rates. Only of such a joint."""

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Site
from core.calibration.bare_axis import bare_axes
from core.calibration.joint_axis import moved
from core.signal.datasets import gather
from core.signal.rotations import angle_between
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings
from tests.core.hinges import PERSON
from tests.simulated import session_of

KNEE = Joint.LEFT_KNEE
FOOT_ALONE = (Site.LEFT_SHANK, Site.LEFT_FOOT)


def test_axes_that_are_off_come_nearer_by_half_and_more() -> None:
    pair = PERSON.exact_pair(KNEE, heading_rad=0.3)
    data = gather((pair,), [np.arange(5, 590)])
    true = [PERSON.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    start = [moved(axis[None], np.deg2rad([[4.0, -3.0]]))[0] for axis in true]
    found = bare_axes(data, (start[0], start[1]))
    assert found is not None
    for axis, other in zip(found, true, strict=True):
        assert np.rad2deg(angle_between(axis, other)) < 2.5  # of five


@pytest.mark.parametrize(("tissue", "is_bare"), [(Tissue.RIGID, True), (Tissue.REAL, False)])
def test_it_is_reported_which_way_an_ankle_s_axis_was_found(tissue: Tissue, is_bare: bool) -> None:
    recordings = (Standing(duration_s=2.0), FreeMotion(duration_s=6.0), Walk(strides=6))
    found = analyse(session_of(WalkerSettings(seed=2, tissue=tissue, recordings=recordings, sites=FOOT_ALONE)))
    reported = {(f.key, f.where) for f in found.findings}
    assert (("ankle_axis_from_rates", "left_ankle") in reported) is is_bare


def test_a_knee_is_never_found_so() -> None:
    assert "ankle_axis_from_rates" not in {f.key for f in analyse(PERSON.visit()).findings}
