"""The axis of an ankle between its own and its knee's."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.analysis import analyse
from core.body import LEG_SITES, Joint, Side
from core.calibration import knees_help
from core.calibration.knees_help import helped_by_knee
from core.samples import FloatArray
from core.signal.rotations import angle_between
from devices.simulation.walker import FreeMotion, SimulatedSession, Standing, Tissue, Walk, WalkerSettings
from tests.simulated import simulation_of

KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)
DOWN, LEVEL = np.array([0.0, 0.0, 9.81]), np.array([0.0, 1.0, 0.0])
TURNING = WalkerSettings(sites=LEFT, tissue=Tissue.SOFT, tissue_turn_rad=np.deg2rad(2.0))


def tilted(deg: float) -> FloatArray:
    return Rotation.from_euler("x", deg, degrees=True).apply(LEVEL)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_new_axis_lies_half_way_and_is_one_axis_in_both_sensors(sign: float) -> None:
    turn = Rotation.random(rng=np.random.default_rng(0))
    found = helped_by_knee((tilted(10.0), turn.apply(tilted(10.0))), sign * tilted(-4.0), (DOWN, turn.apply(DOWN)))
    assert found is not None
    np.testing.assert_allclose(found[0], tilted(3.0), atol=1e-9)
    np.testing.assert_allclose(found[1], turn.apply(tilted(3.0)), atol=1e-9)


def test_a_knee_of_another_direction_is_no_help() -> None:
    assert helped_by_knee((LEVEL, LEVEL), tilted(61.0), (DOWN, DOWN)) is None


def distance_from_knee(made: SimulatedSession) -> float:
    found = analyse(made.session).calibrations[-1].joints
    apart = angle_between(found[ANKLE].axis_proximal, found[KNEE].axis_distal)
    return float(np.rad2deg(min(apart, np.pi - apart)))


@pytest.mark.parametrize(
    ("changes", "is_helped"),
    [
        ({"recordings": (Standing(), Walk(strides=5))}, True),
        ({"recordings": (Standing(), Walk(strides=5)), "tissue": Tissue.RIGID}, False),
        ({"recordings": (Standing(), FreeMotion(), Walk(strides=5))}, False),
        ({"recordings": (Walk(strides=5),)}, False),
    ],
    ids=["walk", "without tissue", "free motion", "no standing"],
)
def test_a_person_s_ankle_that_only_walked_is_helped(
    changes: dict[str, object], is_helped: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = simulation_of(replace(TURNING, **changes))  # type: ignore[arg-type]  # names of fields
    helped = distance_from_knee(made)
    monkeypatch.setattr(knees_help, "SHARE", 0.0)
    assert helped == pytest.approx(distance_from_knee(made) * (0.5 if is_helped else 1.0), rel=0.02)


@pytest.mark.endurance
def test_under_tissue_that_turns_in_step_the_help_makes_ankles_truer(monkeypatch: pytest.MonkeyPatch) -> None:
    walks = [simulation_of(replace(TURNING, seed=seed, recordings=(Standing(), Walk()))) for seed in range(10)]
    helped = np.median([error_deg(made) for made in walks])
    monkeypatch.setattr(knees_help, "SHARE", 0.0)
    assert helped < 0.98 * np.median([error_deg(made) for made in walks])


def error_deg(made: SimulatedSession) -> float:
    walk = analyse(made.session).recordings[-1]
    truth = made.truth.recordings[walk.name].joints[ANKLE]
    error = walk.joints[ANKLE].angle_rad - np.interp(walk.time_s, truth.time_s, truth.angle_rad)
    return float(np.rad2deg(np.nanstd(error)))
