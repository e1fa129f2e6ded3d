"""Tests of the measures for fitting against the simulated patient's bones, on rigid legs and on soft tissue."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Site
from core.verdicts.quantities import FITTING
from devices.simulation.walker import Tissue, simulate
from tests.validation.fitting import errors_of, settings_of
from tests.validation.fitting_optics import hinge_leans

# some half more than nine of ten of 48 legs have, `python -m tests.validation.fitting --people 24`
RIGID, SOFT = 2.3, 3.0
SOFT_AT_TOE_OFF = 6.0  # the knee bends by 35 deg there, and tissue lags behind


LATE = {Site.LEFT_SHANK: 0.04, Site.LEFT_FOOT: -0.03}  # of the thigh's clock, on which everything is reported


@pytest.mark.endurance
@pytest.mark.parametrize(
    ("tissue", "most", "late_s"), [(Tissue.RIGID, RIGID, {}), (Tissue.RIGID, RIGID, LATE), (Tissue.SOFT, SOFT, {})]
)
def test_the_means_of_a_walk_lie_by_the_bones(tissue: Tissue, most: float, late_s: dict[Site, float]) -> None:
    made = simulate(replace(settings_of(3, tissue), clock_late_s=late_s))
    legs = list(errors_of(made, analyse(made.session).recordings[-1]))
    assert [one.strides >= 8 for one in legs] == [True, True]
    for one in legs:
        for name in FITTING:
            is_at_toe_off = tissue is Tissue.SOFT and ("toe_off" in name or "forefoot" in name)
            assert np.isfinite(one.of_mean[name]), name
            assert abs(one.of_mean[name]) < (SOFT_AT_TOE_OFF if is_at_toe_off else most), (name, one.of_mean[name])


def test_both_parts_of_a_mechanical_hinge_lean_as_optics_say(test_data: Callable[[str], Path]) -> None:
    """0.37 to 0.42 deg were found."""
    found = list(hinge_leans(test_data("hinge_mechanical").parent))
    assert len(found) == 4
    for name, samples, rms_deg in found:
        assert samples > 2500, name
        assert rms_deg < 0.6, (name, rms_deg)
