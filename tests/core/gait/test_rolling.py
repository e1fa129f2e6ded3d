"""Heel rise and full contact scatter little, however a foot is put down."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest

from core.body import Side
from core.gait.events import gait_of
from core.gait.rolling import landing_marks, leaving_marks, sharpest, timed_by
from devices.simulation.walker import PEOPLE, Manner, Standing, Tissue, Walk, WalkerSettings
from tests.benchmarks.gait_simulated import walks_of
from tests.core.gait.test_stroke_walks import events_of

PITCH = np.concatenate([[0.0], -np.arange(11.0), np.arange(-9.0, 9.0), np.arange(8.0, -1.0, -1.0)])
SPAN = (0, 14, len(PITCH) - 1)
# full contact was 84, 20 and 29 ms apart here, heel rise 189, 2 and 24
LANDINGS = [(Manner.TOES, 0.3, Tissue.REAL), (Manner.SHUFFLING, 0.8, Tissue.SOFT), (Manner.FLAT, 0.8, Tissue.REAL)]
MOST_S: Mapping[str, float] = {"full_contact_s": 0.012, "heel_rise_s": 0.035}


def test_marks_are_where_the_pitch_passes_its_share() -> None:
    assert leaving_marks(PITCH, [SPAN]).tolist() == [3.0]  # a fifth of -10
    heel, toes = (landing_marks(PITCH, [SPAN], 0.25, [lowered])[0] for lowered in (None, 10))
    assert PITCH[int(heel)] == pytest.approx(2.0)  # of 8
    assert heel > 29
    assert PITCH[int(np.floor(toes))] == pytest.approx(-3.0)  # of -10
    assert 11 < toes < 29


def test_instants_are_as_far_from_their_marks_as_they_mostly_are() -> None:
    instants, spread = timed_by(np.array([10.0, 20.0, 31.0]), np.array([12.0, 22.0, 40.0]))
    assert instants.tolist() == [12.0, 22.0, 33.0]
    assert spread == 0.0


def test_the_marks_that_scatter_least_are_taken_and_none_that_scatter_more_than_the_instants() -> None:
    beside = 100.0 * np.arange(6.0)
    instants, all_of_them = beside + np.array([20, 21, 45, 20, 19, 20]), np.ones(6, dtype=bool)
    good, fair, bad = (
        beside + np.array([5, 6, 5, 5, 4, 5]),
        beside + np.array([5, 9, 2, 5, 4, 5]),
        beside + np.array([5, 60, 5, 5, 5, 5]),
    )
    found = sharpest([bad, fair, good], instants, beside, all_of_them)
    assert found is not None
    assert found.tolist() == good.tolist()
    assert sharpest([bad], instants, beside, all_of_them) is None
    assert sharpest([good], instants, beside, np.arange(6) < 3) is None  # too few
    before = np.where(np.arange(6) == 2, beside - 5.0, good)  # no full contact before the contact
    found = sharpest([before], beside + np.array([20, 21, 45, 28, 11, 20]), beside, all_of_them)
    assert found is not None
    assert np.flatnonzero(np.isnan(found)).tolist() == [2]


@pytest.mark.parametrize(("manner", "speed_m_s", "tissue"), LANDINGS)
def test_full_contact_and_heel_rise_scatter_little_on_feet_that_are_not_put_down_on_their_heels(
    manner: Manner, speed_m_s: float, tissue: Tissue
) -> None:
    walk = Walk(speed_m_s=speed_m_s, strides=8, manner=manner)
    settings = WalkerSettings(seed=0, recordings=(Standing(), walk), tissue=tissue, variation=PEOPLE)
    apart_s: dict[str, list[float]] = {name: [] for name in MOST_S}
    for foot, truth in walks_of(settings).values():
        found = gait_of(foot)
        for name, values in apart_s.items():
            late_s = (getattr(found, name) - getattr(truth.events, name))[1:-1]
            values += (late_s - np.median(late_s)).tolist()
    for name, most_s in MOST_S.items():
        assert np.std(apart_s[name]) < most_s, name


@pytest.mark.parametrize("side", list(Side))
@pytest.mark.parametrize("name", ["stroke01", "stroke03"])
def test_full_contact_follows_contact_alike_in_a_slow_persons_strides(
    test_data: Callable[[str], Path], name: str, side: Side
) -> None:
    """On a treadmill at 0.36 m/s they were 60 and 85 ms apart."""
    found, _ = events_of(test_data("stroke_treadmill") / name, side)
    assert np.std((found.full_contact_s - found.initial_contact_s)[1:-1]) < 0.030
