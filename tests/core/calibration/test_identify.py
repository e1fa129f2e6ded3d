"""Which doubts does the identification of a joint keep, decided on the axes it ends with?"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from core.body import Joint
from core.calibration import identify
from core.calibration.identify import Decision, Downs, Identification, identify_joint
from core.datasets import Datasets
from core.rotations import joint_frame
from core.samples import FloatArray

if TYPE_CHECKING:
    from tests.core.conftest import Person

KNEE = Joint.LEFT_KNEE


@pytest.fixture
def doubting(monkeypatch: pytest.MonkeyPatch) -> None:
    """A decision that finds its axis steep at first, on a joint that is taken for no hinge."""
    decide = identify.decide

    def doubt(data: Datasets, downs: Downs | None = None) -> Decision:
        return replace(decide(data, downs), did_flexion_dominate=False)

    monkeypatch.setattr(identify, "decide", doubt)
    monkeypatch.setattr(identify, "MAX_HINGE_RESIDUAL_RAD_S", 0.0)


def identified(person: "Person", downs: tuple[FloatArray, FloatArray]) -> Identification:
    pair = person.exact_pair(KNEE, heading_rad=0.4)
    found = identify_joint(lambda _: (pair,), lambda _: (), lambda _: (pair,), True, False, downs)
    assert found is not None
    return found


@pytest.mark.usefixtures("doubting")
def test_flexion_is_not_doubted_where_the_axis_lies_flat_in_the_end(person: "Person") -> None:
    axes = [person.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    found = identified(person, (joint_frame(axes[0])[0], joint_frame(axes[1])[0]))
    assert found.elevation_rad is not None
    assert found.elevation_rad < np.deg2rad(10.0)
    assert found.did_flexion_dominate


@pytest.mark.usefixtures("doubting")
def test_flexion_is_doubted_where_the_axis_stands_up(person: "Person") -> None:
    axes = [person.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    found = identified(person, (axes[0], axes[1]))
    assert found.elevation_rad is not None
    assert found.elevation_rad > np.deg2rad(80.0)
    assert not found.did_flexion_dominate
