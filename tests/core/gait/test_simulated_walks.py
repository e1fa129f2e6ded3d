"""Tests that events, phases, time and distance of simulated walks reach what is asked of them. A benchmark in small."""

import numpy as np
import pytest

from devices.simulation.walker import Tissue, Walk, WalkerSettings
from tests.benchmarks.gait_simulated import Score, score_walks

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

SUPPORT = "double_support_percent"
MAX_SUPPORT_PERCENT = 3.0  # of itself: contact or toe-off are 2 ms off


def scored(speed_m_s: float, rate_hz: float, tissue: Tissue, seeds: int = 1) -> Score:
    return score_walks(WalkerSettings(rate_hz=rate_hz, tissue=tissue), Walk(speed_m_s=speed_m_s), range(3, 3 + seeds))


@pytest.mark.parametrize("tissue", [Tissue.RIGID, Tissue.SOFT])
@pytest.mark.parametrize(
    ("speed_m_s", "rate_hz"), [(0.3, 100.0), (0.3, 60.0), (1.19, 50.0), (1.19, 200.0), (2.0, 60.0)]
)
def test_a_walk_reaches_every_target_but_that_of_double_support(
    speed_m_s: float, rate_hz: float, tissue: Tissue
) -> None:
    score = scored(speed_m_s, rate_hz, tissue)
    assert score.used > 10
    assert [name for name in score.missed() if name != SUPPORT] == []
    assert abs(float(np.mean(score.percent[SUPPORT]))) < MAX_SUPPORT_PERCENT


def test_a_sensor_that_shakes_on_its_foot_reaches_them_too() -> None:
    score = scored(1.19, 100.0, Tissue.REAL, seeds=2)
    assert [name for name in score.missed() if name != SUPPORT] == []


def test_a_slow_foot_whose_sensor_shakes_has_all_its_events_and_its_stride_length() -> None:
    score = scored(0.5, 100.0, Tissue.REAL, seeds=2)
    assert (score.found, score.invented) == (score.expected, 0)
    assert max(score.mean_and_sd_s(name)[1] for name in ("IC", "FC", "HR", "TO")) < 0.020
    assert "stride_length_m" not in score.missed()


def test_a_score_names_what_is_missed() -> None:
    score = Score(100.0, expected=3, found=2)
    for name in ("IC", "FC", "HR", "TO"):
        score.errors_s[name].append(np.array([-0.02, 0.02]) if name == "HR" else np.zeros(2))
    for name in ("loading", "foot flat", "pre-swing", "swing"):
        score.errors_s[name].append(np.full(2, 0.012) if name == "swing" else np.zeros(2))
    for name in ("stride_time_s", "step_time_s", "stance_percent", "swing_percent", SUPPORT, "stride_length_m"):
        score.percent[name].append(1.5)
    assert score.missed() == [
        "found",
        "HR",
        "swing",
        "stride_time_s",
        "step_time_s",
        "stance_percent",
        "swing_percent",
        SUPPORT,
    ]
