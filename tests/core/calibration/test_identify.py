"""Tests of the doubts that the identification of a joint keeps, decided on the axes it ends with."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint
from core.calibration import identify
from core.calibration.identify import Decision, Downs, Identification, identify_joint, moving_data
from core.samples import FloatArray
from core.signal.datasets import Datasets
from core.signal.pair import OrientedTrack, Pair, pair_up
from core.signal.rotations import joint_frame
from tests.core.hinges import PERSON

KNEE = Joint.LEFT_KNEE


@pytest.fixture
def doubting(monkeypatch: pytest.MonkeyPatch) -> None:
    """A decision that finds its axis steep at first, on a joint that is taken for no hinge."""
    decide = identify.decide

    def doubt(data: Datasets, downs: Downs | None = None) -> Decision:
        return replace(decide(data, downs), did_flexion_dominate=False)

    monkeypatch.setattr(identify, "decide", doubt)
    monkeypatch.setattr(identify, "MAX_HINGE_RESIDUAL_RAD_S", 0.0)


def identified(downs: tuple[FloatArray, FloatArray]) -> Identification:
    pair = PERSON.exact_pair(KNEE, heading_rad=0.4)
    found = identify_joint(lambda _: (pair,), lambda _: (), lambda _: (pair,), True, False, downs)
    assert found is not None
    return found


@pytest.mark.usefixtures("doubting")
def test_flexion_is_not_doubted_where_the_axis_lies_flat_in_the_end() -> None:
    axes = [PERSON.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    found = identified((joint_frame(axes[0])[0], joint_frame(axes[1])[0]))
    assert found.elevation_rad is not None
    assert found.elevation_rad < np.deg2rad(10.0)
    assert found.did_flexion_dominate


@pytest.mark.usefixtures("doubting")
def test_flexion_is_doubted_where_the_axis_is_up() -> None:
    axes = [PERSON.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    found = identified((axes[0], axes[1]))
    assert found.elevation_rad is not None
    assert found.elevation_rad > np.deg2rad(80.0)
    assert not found.did_flexion_dominate


def test_a_lag_of_a_hinge_is_found_to_a_fraction_of_a_sample_without_walks() -> None:
    """The distal stamps are 20 ms early and then some: the second look finds what the first correction left."""
    pair = PERSON.exact_pair(KNEE, duration_s=12.0, heading_rad=0.4)
    one, two = pair.tracks
    early = OrientedTrack(replace(two.track, start_s=two.track.start_s - 0.0234), two.q_earth_from_sensor)

    def pairs_at(lag_s: float) -> tuple[Pair, ...]:
        found = pair_up(one, early, lag_s)
        assert found is not None
        return (found,)

    found = identify_joint(pairs_at, lambda _: (), pairs_at, True, False, None)
    assert found is not None
    assert found.is_hinge
    assert found.lag.lag_s == pytest.approx(0.0234, abs=1e-4)


@pytest.mark.parametrize(("samples", "is_used"), [(50, True), (49, False)])
def test_half_a_second_of_movement_is_a_stretch(samples: int, is_used: bool) -> None:
    pair = PERSON.exact_pair(KNEE)
    is_received = np.zeros(len(pair), dtype=bool)
    is_received[200 : 200 + samples] = True
    data = moving_data((pair, replace(pair, is_known=is_received)))
    assert data is not None
    assert len(data.pairs) == 1 + is_used
    assert np.sum(data.stretch == 1) == (samples if is_used else 0)
