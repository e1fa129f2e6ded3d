"""Tests that our port of VQF is the filter of its paper, and the same as its authors' package where that exists."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from core.body import Site
from core.samples import FloatArray
from core.signal.published_filter import PublishedFilter
from core.signal.published_offline import bias_of_both, offline_quaternions, passes_both_ways
from devices.simulation.walker import Walk, WalkerSettings
from tests.simulated import session_of

try:
    import vqf
except ImportError:
    vqf = None

needs_package = pytest.mark.skipif(vqf is None, reason="vqf has no wheel here: there is nothing to compare with")
STEP_S, G_M_S2 = 0.01, 9.81
FIELD = np.array([0.0, 20.0, -40.0])  # north and down
BIAS_RAD_S = np.array([0.01, -0.005, 0.02])
EQUAL = 1e-9  # of a quaternion's component, and of a bias in rad/s
HEADS_DOWN = Rotation.from_euler("x", 180, degrees=True)


@dataclass(frozen=True)
class Samples:
    """Rates of the intervals before them, specific forces, fields (n, 3)."""

    gyr: FloatArray
    acc: FloatArray
    mag: FloatArray
    step_s: float = STEP_S


def moved(duration_s: float = 90.0, step_s: float = STEP_S) -> Samples:
    """A sensor that lies still at the start of every 30 s, then turns about all axes, always on about the vertical."""
    noise = np.random.default_rng(3)
    time_s = step_s * np.arange(int(duration_s / step_s))
    moves = gaussian_filter1d((time_s % 30.0 > 8.0).astype(float), 0.2 / step_s)
    angles = np.column_stack(
        [np.cumsum(1.2 * moves) * step_s, 0.8 * moves * np.sin(5.0 * time_s), 0.5 * moves * np.sin(3.0 * time_s + 1.0)]
    )
    turned = Rotation.from_euler("ZXY", angles)
    gyr = np.zeros((len(time_s), 3))
    gyr[1:] = (turned[:-1].inv() * turned[1:]).as_rotvec() / step_s
    pushed = moves[:, None] * np.column_stack([np.sin(7.0 * time_s), np.cos(9.0 * time_s), np.sin(4.0 * time_s)])
    return Samples(
        gyr + BIAS_RAD_S + noise.normal(0.0, 0.002, gyr.shape),
        turned.inv().apply(2.0 * pushed + [0.0, 0.0, G_M_S2]) + noise.normal(0.0, 0.02, gyr.shape),
        turned.inv().apply(FIELD) + noise.normal(0.0, 0.2, gyr.shape),
        step_s,
    )


def with_losses() -> Samples:
    """Forces and fields of nothing, one after the other, from the start too; and iron near for ten seconds."""
    samples = moved()
    acc, mag = samples.acc.copy(), samples.mag.copy()
    for signal, first, last in ((acc, 0, 7), (acc, 3000, 3040), (mag, 0, 30), (mag, 4000, 4020)):
        signal[first:last] = 0.0
    mag[5000:6000] *= 1.6
    return replace(samples, acc=acc, mag=mag)


def heads_down() -> Samples:
    """A sensor whose z axis points to the ground from its first sample."""
    samples = moved(20.0)
    gyr, acc, mag = (HEADS_DOWN.apply(v) for v in (samples.gyr, samples.acc, samples.mag))
    return Samples(gyr, acc, mag)


def walking() -> Samples:
    """The shank of a person who walks."""
    walk = WalkerSettings(seed=1, recordings=(Walk(strides=5),), sites=(Site.LEFT_SHANK,))
    block = session_of(walk).recordings[0].imu[Site.LEFT_SHANK]
    return Samples(block.gyr_rad_s, block.acc_m_s2, np.tile(FIELD, (len(block), 1)))


MOTIONS: Mapping[str, Callable[[], Samples]] = {
    "moved and still": lambda: moved(40.0),
    "losses and iron": with_losses,
    "heads down": heads_down,
    "walking": walking,
    "still": lambda: moved(7.0),
    "less than a time constant": lambda: moved(0.4),
    "six minutes, slowly sampled": lambda: moved(360.0, 0.12),
}


def batches(samples: Samples) -> list[slice]:
    """Of 1 to 40 samples."""
    sizes = np.random.default_rng(0).integers(1, 41, len(samples.gyr))
    edges = [0, *np.cumsum(sizes).tolist()]
    return [slice(a, b) for a, b in pairwise(edges) if a < len(samples.gyr)]


def differences(samples: Samples) -> dict[str, float]:
    """The most by which port and package differ, of each result."""
    gyr, acc, mag = (np.ascontiguousarray(v) for v in (samples.gyr, samples.acc, samples.mag))
    step_s = samples.step_s
    package = {"6D": vqf.offlineVQF(gyr, acc, None, step_s), "9D": vqf.offlineVQF(gyr, acc, mag, step_s)}
    bias = bias_of_both(*passes_both_ways(gyr, acc, step_s))
    worst = {
        "6D": np.abs(offline_quaternions(gyr, acc, None, step_s) - package["6D"]["quat6D"]).max(),
        "9D": np.abs(offline_quaternions(gyr, acc, mag, step_s) - package["9D"]["quat9D"]).max(),
        "bias": np.abs(bias - package["6D"]["bias"]).max(),
    }
    theirs, ours = vqf.VQF(step_s, tauAcc=2.0, biasSigmaInit=0.4), PublishedFilter(step_s, 2.0, 0.4)
    live = []
    for part in batches(samples):
        turned = theirs.updateBatch(gyr[part], acc[part])["quat6D"]
        found, (known, sd), (our_known, our_sd) = (
            ours.update(gyr[part], acc[part]),
            theirs.getBiasEstimate(),
            ours.bias(),
        )
        live.append((np.abs(found - turned).max(), np.abs(our_known - known).max(), abs(our_sd - sd)))
        if part.start % 7 == 0:  # as after a gap
            theirs.resetState()
            theirs.setBiasEstimate(known, sd)
            ours.reset()
            ours.set_bias(our_known, our_sd)
    worst |= dict(zip(("live", "live bias", "live deviation"), np.max(live, axis=0), strict=True))
    return {name: float(value) for name, value in worst.items()}


@needs_package
@pytest.mark.parametrize("motion", MOTIONS)
def test_the_port_gives_what_the_package_gives(motion: str) -> None:
    assert {name: value for name, value in differences(MOTIONS[motion]()).items() if not value < EQUAL} == {}


@needs_package
def test_the_motions_have_rest_iron_and_its_end() -> None:
    """Otherwise the comparison would not reach all of the filter."""
    samples = with_losses()
    found = vqf.offlineVQF(samples.gyr, samples.acc, samples.mag, STEP_S)
    assert 0.1 < found["restDetected"].mean() < 0.5
    assert 0.1 < found["magDistDetected"].mean() < 0.9


@needs_package
@pytest.mark.endurance
@pytest.mark.parametrize(
    "name", ["hinge_mechanical/2D_02", "full_body_free_motion/legs_arms", "feet_mocap_events/healthy_feet"]
)
def test_the_port_gives_what_the_package_gives_on_people_and_hinges(
    test_data: Callable[[str], Path], name: str
) -> None:
    with np.load(test_data(f"{name}.npz")) as archive:
        signals = {key: np.asarray(archive[key], dtype=float) for key in archive.files}
    step_s = 1.0 / float(signals["fs"])
    sensors = [(key, key.replace("gyr", "acc")) for key in signals if "gyr" in key]
    assert sensors
    for gyr, acc in sensors:
        rates, forces = (v[np.isfinite(v).all(axis=1)] for v in (signals[gyr], signals[acc]))
        samples = Samples(rates, forces, np.roll(forces, 1, axis=1), step_s)  # any field: no recording has one
        assert {what: value for what, value in differences(samples).items() if not value < EQUAL} == {}, gyr


def test_at_rest_gravity_is_up_however_the_sensor_lies() -> None:
    """But for 0.006 deg: the causal filter takes a little of its first correction for a bias."""
    for turned in Rotation.random(8, random_state=1):
        acc = np.tile(turned.inv().apply([0.0, 0.0, G_M_S2]), (400, 1))
        for found in (
            offline_quaternions(np.zeros((400, 3)), acc, None, STEP_S),
            PublishedFilter(STEP_S).update(np.zeros((400, 3)), acc),
        ):
            up = Rotation.from_quat(found, scalar_first=True).apply(acc) / G_M_S2
            np.testing.assert_allclose(up, np.tile([0.0, 0.0, 1.0], (400, 1)), atol=1e-4)


@pytest.mark.parametrize("rate_rad_s", [-3.0, 0.4, 6.0])
def test_a_constant_rate_turns_by_its_angle(rate_rad_s: float) -> None:
    gyr, acc = np.tile([0.0, 0.0, rate_rad_s], (100, 1)), np.tile([0.0, 0.0, G_M_S2], (100, 1))
    for found in (offline_quaternions(gyr, acc, None, STEP_S), PublishedFilter(STEP_S).update(gyr, acc)):
        heading = np.unwrap(2.0 * np.arctan2(found[:, 3], found[:, 0]), period=2.0 * np.pi)
        np.testing.assert_allclose(heading, rate_rad_s * STEP_S * np.arange(1, 101), atol=1e-9)


def test_a_bias_is_found_at_rest_and_not_followed_beyond_two_degrees_a_second() -> None:
    acc = np.tile([1.0, 2.0, 9.5], (4000, 1))
    bias = np.array([0.01, -0.02, 0.015])
    running = PublishedFilter(STEP_S)
    _, first_sd = running.bias()
    running.update(np.tile(bias, (4000, 1)), acc)
    found, sd = running.bias()
    np.testing.assert_allclose(found, bias, atol=2e-5)
    assert sd < 0.1 * first_sd == pytest.approx(0.1 * np.deg2rad(0.5))
    running.reset()
    running.update(np.tile([0.0, 0.0, 0.2], (4000, 1)), acc)
    assert np.abs(running.bias()[0]).max() <= np.deg2rad(2.0) + 1e-15


def test_a_bias_about_level_axes_is_found_while_the_sensor_is_shaken() -> None:
    """About the vertical nothing shows it, and it is not claimed to be known."""
    acc = np.random.default_rng(2).normal([0.0, 0.0, G_M_S2], 3.0, (30000, 3))
    running = PublishedFilter(STEP_S)
    first_sd = running.bias()[1]
    running.update(np.tile(BIAS_RAD_S, (30000, 1)), acc)
    found, sd = running.bias()
    np.testing.assert_allclose(found[:2], BIAS_RAD_S[:2], atol=0.001)
    assert abs(found[2]) < 0.002
    assert sd > 0.9 * first_sd


def test_with_a_magnetometer_the_field_points_north() -> None:
    samples = moved()
    iron = samples.mag.copy()
    iron[5000:6000] += [30.0, 0.0, 0.0]
    for mag in (samples.mag, iron):
        found = Rotation.from_quat(offline_quaternions(samples.gyr, samples.acc, mag, STEP_S), scalar_first=True)
        field = found.apply(samples.mag)
        heading = np.rad2deg(np.arctan2(field[:, 0], field[:, 1]))
        assert np.sqrt(np.mean(heading**2)) < 2.5


def test_what_is_no_number_raises_nothing_and_no_samples_give_none() -> None:
    samples = moved(5.0)
    running = PublishedFilter(STEP_S)
    assert running.update(np.empty((0, 3)), np.empty((0, 3))).shape == (0, 4)
    for value in (np.nan, np.inf):
        gyr, acc = samples.gyr.copy(), samples.acc.copy()
        gyr[100, 1] = acc[200, 2] = value
        with np.errstate(all="ignore"):
            assert running.update(gyr, acc).shape == (len(gyr), 4)


def test_batches_of_any_size_give_the_same() -> None:
    samples = with_losses()
    whole = PublishedFilter(STEP_S).update(samples.gyr, samples.acc)
    running = PublishedFilter(STEP_S)
    parts = [running.update(samples.gyr[part], samples.acc[part]) for part in batches(samples)]
    np.testing.assert_allclose(np.concatenate(parts), whole, atol=1e-12)
