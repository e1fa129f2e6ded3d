"""Tests that a foot's landings and leavings are found, in any mounting, and none where there is none."""

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import core.gait.events as events_module
from core.body import Side, Site
from core.gait.crossings import crossing, onset
from core.gait.events import SOURCES, EventSource, FootEvents, Timing, gait_of, without_stray_toe_offs
from core.gait.foot import FootMotion
from core.gait.sole import SoleTravel, travel_of
from core.samples import BoolArray, FloatArray, ImuBlock
from devices.simulation.walker import FootTruth, FreeMotion, Manner, Standing, Tissue, Walk, WalkerSettings
from tests.core.cut_blocks import turned as turned_block
from tests.core.gait.feet import foot_of
from tests.core.standing import bias_of
from tests.simulated import simulation_of

FOOT = Site.LEFT_FOOT
EVENTS = ("heel_rise_s", "toe_off_s", "initial_contact_s", "full_contact_s")


def walk_of(settings: WalkerSettings, turn: Rotation | None = None) -> tuple[FootEvents, FootTruth]:
    """Events and truth of the left foot in the second recording; `turn` turns the sensor in its mounting."""
    made = simulation_of(replace(settings, sites=(FOOT,)))
    blocks = [recording.imu[FOOT] for recording in made.session.recordings]
    if turn is not None:
        blocks = [turned_block(block, turn) for block in blocks]
    return gait_of(foot_of(blocks[1], bias_of(blocks[0]))), made.truth.recordings["walk 1"].feet[Side.LEFT]


def walking(
    speed_m_s: float = 1.19, rate_hz: float = 100.0, tissue: Tissue = Tissue.RIGID, seed: int = 0
) -> WalkerSettings:
    recordings = (Standing(), Walk(speed_m_s=speed_m_s))
    return WalkerSettings(seed=seed, recordings=recordings, rate_hz=rate_hz, tissue=tissue)


def test_turning_the_sensor_in_its_mounting_changes_no_event() -> None:
    found, _ = walk_of(walking())
    turned, _ = walk_of(walking(), Rotation.from_rotvec([1.0, -2.0, 0.7]))
    for name in EVENTS:
        np.testing.assert_allclose(getattr(turned, name), getattr(found, name), atol=1e-3)
    np.testing.assert_allclose(turned.length_m, found.length_m, atol=0.002)


def test_a_swing_whose_sole_never_ceases_to_travel_has_no_contact_and_leaves_the_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As where a recording begins while a leg still circles; it was met so, and ended the analysis."""
    usual, _ = walk_of(walking())

    def travelling(motion: FootMotion) -> SoleTravel:
        found = travel_of(motion)
        swing = motion.swings
        share, lands = found.speed_share.copy(), found.lands.copy()
        share[swing.anchor_before[3] : swing.anchor_after[3] + 1], lands[3] = 1.0, np.nan
        return replace(found, speed_share=share, lands=lands)

    monkeypatch.setattr(events_module, "travel_of", travelling)
    found, _ = walk_of(walking())
    assert np.isnan(found.initial_contact_s[3])
    assert np.isnan(found.full_contact_s[3])
    others = np.arange(len(usual.initial_contact_s)) != 3
    np.testing.assert_allclose(found.initial_contact_s[others], usual.initial_contact_s[others], atol=0.03)


@pytest.mark.parametrize(
    "settings",
    [
        replace(walking(), prosthetic_side=Side.LEFT),
        replace(walking(0.3), prosthetic_side=Side.LEFT),
        replace(walking(), stiff_knee_side=Side.LEFT),
        replace(walking(0.3), stiff_knee_side=Side.LEFT),
    ],
    ids=["prosthesis", "slow prosthesis", "stiff knee", "slow stiff knee"],
)
def test_a_prosthesis_and_a_stiff_knee_gain_and_lose_no_event(settings: WalkerSettings) -> None:
    found, truth = walk_of(settings)
    assert len(found) == len(truth.events.toe_off_s)
    late = (found.initial_contact_s - truth.events.initial_contact_s)[1:-1]
    assert np.abs(late).max() < 0.02
    assert np.std(late) < 0.01


@pytest.mark.endurance
@pytest.mark.parametrize(
    ("manner", "speed_m_s"), [(Manner.SHUFFLING, 0.3), (Manner.SHUFFLING, 1.0), (Manner.TOES, 0.8)]
)
@pytest.mark.parametrize("tissue", list(Tissue))
def test_shuffling_and_walking_on_toes_gain_and_lose_no_event(manner: Manner, speed_m_s: float, tissue: Tissue) -> None:
    walk = Walk(speed_m_s=speed_m_s, manner=manner)
    found, truth = walk_of(WalkerSettings(seed=1, recordings=(Standing(), walk), tissue=tissue))
    assert len(found) == len(truth.events.toe_off_s)
    late = (found.initial_contact_s - truth.events.initial_contact_s)[1:-1]
    assert np.abs(late).max() < 0.05
    # a sensor that trembles on its foot reports a single stride's length less well than their mean
    single, mean = (0.2, 0.05) if tissue is Tissue.REAL else (0.05, 0.05)
    np.testing.assert_allclose(found.length_m[1:-1], truth.stride_lengths_m[1:-1], rtol=single)
    assert np.mean(found.length_m[1:-1]) == pytest.approx(np.mean(truth.stride_lengths_m[1:-1]), rel=mean)


def late_s(found: FootEvents, truth: FootTruth, name: str) -> FloatArray:
    """Of all but the first and the last swing, which begin and end in standing."""
    assert len(found) == len(truth.events.toe_off_s)
    return np.asarray((getattr(found, name) - getattr(truth.events, name))[1:-1])


def test_a_foot_that_comes_down_flat_while_it_goes_on_is_timed_by_its_sole() -> None:
    walk = Walk(speed_m_s=1.0, manner=Manner.SHUFFLING)
    found, truth = walk_of(WalkerSettings(seed=1, recordings=(Standing(), walk)))
    assert found.is_certain.all()
    assert np.abs(late_s(found, truth, "initial_contact_s")).max() < 0.015
    assert np.abs(late_s(found, truth, "toe_off_s")).max() < 0.015
    by_sole = SOURCES.index(EventSource.SOLE)
    assert (found.source[1:-1, [1, 2]] == by_sole).all()
    assert (found.sd_s[1:-1, [1, 2]] >= 0.02).all()


def test_a_foot_that_rolls_is_timed_by_its_pitch_and_is_surer() -> None:
    found, _ = walk_of(walking())
    assert (found.source[:-1] == SOURCES.index(EventSource.PITCH)).all()  # the last lands flat, beside the other foot
    assert (found.sd_s[:-1, [1, 2]] < 0.015).all()
    assert np.isfinite(found.sd_s).all()


@pytest.mark.parametrize("speed_m_s", [0.3, 1.19])
def test_a_prosthetic_foots_toe_off_is_timed_by_its_sole(speed_m_s: float) -> None:
    settings = replace(walking(speed_m_s), prosthetic_side=Side.LEFT)
    made = simulation_of(replace(settings, sites=(FOOT,)))
    standing, walk = (recording.imu[FOOT] for recording in made.session.recordings)
    track = foot_of(walk, bias_of(standing))
    truth = made.truth.recordings["walk 1"].feet[Side.LEFT]
    assert np.abs(late_s(gait_of(track, is_rigid=True), truth, "toe_off_s")).max() < 0.020
    assert late_s(gait_of(track), truth, "toe_off_s").min() > 0.025  # the pitch reports it late


def test_a_forefoot_that_lands_first_is_turned_up_by_the_floor() -> None:
    walk = Walk(speed_m_s=0.8, manner=Manner.TOES)
    found, truth = walk_of(WalkerSettings(seed=1, recordings=(Standing(), walk)))
    for name in EVENTS:
        late = (getattr(found, name) - getattr(truth.events, name))[1:-1]
        assert np.abs(late).max() < 0.010, name


@pytest.mark.parametrize("manner", [Manner.FLAT, Manner.DRAGGING, Manner.TOE_FIRST])
@pytest.mark.parametrize(
    "tissue", [Tissue.RIGID, *(pytest.param(one, marks=pytest.mark.endurance) for one in (Tissue.SOFT, Tissue.REAL))]
)
def test_flat_and_dragging_feet_are_timed_within_25_ms(manner: Manner, tissue: Tissue) -> None:
    walk = Walk(speed_m_s=0.6, manner=manner)
    found, truth = walk_of(WalkerSettings(seed=3, recordings=(Standing(), walk), tissue=tissue))
    for name in ("initial_contact_s", "toe_off_s"):
        late = late_s(found, truth, name)
        assert abs(float(np.mean(late))) < 0.015, name
        assert np.sqrt(np.mean(late**2)) < 0.025, name
    if tissue is Tissue.RIGID:
        np.testing.assert_allclose(found.length_m[1:-1], truth.stride_lengths_m[1:-1], rtol=0.05)


def test_two_standard_deviations_hold_most_events() -> None:
    inside: list[BoolArray] = []
    for seed, (manner, speed_m_s) in enumerate([(Manner.ORDINARY, 0.5), (Manner.ORDINARY, 1.4), (Manner.FLAT, 0.6)]):
        walk = Walk(speed_m_s=speed_m_s, manner=manner)
        found, truth = walk_of(WalkerSettings(seed=seed, recordings=(Standing(), walk), tissue=Tissue.REAL))
        late = np.stack([late_s(found, truth, name) for name in EVENTS], axis=1)
        inside.append(np.abs(late) < 2.0 * found.sd_s[1:-1])
    share = np.mean(np.concatenate(inside), axis=0)
    assert (share > 0.8).all(), share


def test_a_toe_off_where_no_other_is_goes_where_the_others_are() -> None:
    index = np.tile(np.array([20.0, 60.0, 100.0, 110.0]), (8, 1)) + 120.0 * np.arange(8)[:, None]
    timing = Timing(index.copy(), np.ones((8, 4), dtype=np.int64), np.zeros((8, 4)))
    timing.index[4, 1] -= 30.0
    timing.index[5, 1] += 2.0
    without_stray_toe_offs(timing, np.arange(8) * 120 + 80, 0.01)
    expected = index[:, 1] + np.where(np.arange(8) == 5, 2.0, 0.0)
    np.testing.assert_allclose(timing.index[:, 1], expected)
    assert timing.reach[4, 1] == pytest.approx(30.0)


def test_standing_and_free_motion_hold_no_strides() -> None:
    made = simulation_of(
        WalkerSettings(recordings=(Standing(duration_s=10.0), FreeMotion(duration_s=20.0)), sites=(FOOT,))
    )
    blocks = [recording.imu[FOOT] for recording in made.session.recordings]
    standing, free = (gait_of(foot_of(block, bias_of(blocks[0]))) for block in blocks)
    assert len(standing) == 0
    assert len(free) <= 1  # a foot set down somewhere else; no stride


def test_a_turn_is_measured() -> None:
    settings = WalkerSettings(recordings=(Standing(), Walk(turn_rad=np.pi / 2, strides=12)))
    found, _ = walk_of(settings)
    assert np.sum(found.turn_rad) == pytest.approx(np.pi / 2, abs=0.05)


def test_the_first_crossing_lies_between_samples() -> None:
    assert crossing(np.array([0.0, 1.0, 3.0]), 0, 2, 2.0) == pytest.approx(1.5)
    assert np.isnan(crossing(np.array([0.0, 1.0, 3.0]), 0, 2, 5.0))


@pytest.mark.parametrize("is_reversed", [False, True])
def test_a_growth_is_followed_back_to_where_it_began(is_reversed: bool) -> None:
    signal = np.maximum(np.arange(60) - 20.0, 0.0) ** 1.75
    signal = signal[::-1] if is_reversed else signal
    found = onset(signal, 0 if is_reversed else 59, 59 if is_reversed else 0, 20.0)
    assert found.index == pytest.approx(39.0 if is_reversed else 20.0, abs=0.3)
    assert found.reach == pytest.approx(20.0 ** (1.0 / 1.75), abs=0.3)


def test_optics_and_events_agree(test_data: Callable[[str], Path]) -> None:
    folder = test_data("feet_mocap_events")
    contact, off, length = [], [], []
    with np.load(folder / "healthy_feet.npz") as arrays:
        rate_hz = float(arrays["fs"])
        feet = {s: [arrays[f"{s}_foot_{k}"].astype(np.float64) for k in ("gyr", "acc")] for s in Side}
    with (folder / "stride_events_sample.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    paths = _lengths(folder / "position_sample.csv")
    for side, (gyr, acc) in feet.items():
        block = ImuBlock("foot", np.arange(len(gyr)) / rate_hz, gyr, acc)
        found = gait_of(foot_of(block, bias_of(block)))
        here = [row for row in rows if row["foot"] == side]
        nearest = [int(np.argmin(np.abs(found.initial_contact_s - float(r["ic"]) / rate_hz))) for r in here]
        assert len(set(nearest)) == len(here)
        # the list leaves out first and last steps, and runs two swings of a turn together
        assert len(found) - len(here) <= 4
        contact += [found.initial_contact_s[k] - float(r["ic"]) / rate_hz for r, k in zip(here, nearest, strict=True)]
        late = [found.toe_off_s - float(r["tc"]) / rate_hz for r in here]
        off += [float(values[np.argmin(np.abs(values))]) for values in late]
        length += [found.length_m[k] - paths[int(r["s_id"])] for r, k in zip(here, nearest, strict=True)]
    assert len(contact) == 57
    assert np.std(contact) < 0.010
    # the optics call it contact before the floor turns the foot
    assert np.mean(contact) == pytest.approx(0.024, abs=0.003)
    assert np.std(off) < 0.010
    assert abs(float(np.mean(off))) < 0.003
    assert abs(float(np.mean(length))) < 0.01 * sum(paths.values()) / len(paths)
    assert np.std(length) < 0.03


def _lengths(path: Path) -> dict[int, float]:
    ends: dict[int, list[float]] = {}
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            ends[int(row["s_id"])] = [float(row["pos_x"]), float(row["pos_y"])]
    return {number: float(np.linalg.norm(end)) for number, end in ends.items()}
