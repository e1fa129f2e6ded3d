"""How well are a foot's events, phases and strides found, against optics and on the project's own patient?

    python tests/benchmarks/gait.py [--seeds 3]

The optical recordings are used where GAITWRIGHT_TEST_DATA names the shared folder. Errors of events and phases in ms,
mean and standard deviation; of lengths in percent and cm.
"""

import argparse
import csv
import os
import time
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.body import Side, Site
from core.calibration.rest import rest_of
from core.gait.events import FootEvents, gait_of
from core.gait.foot import follow
from core.gait.spatiotemporal import both_feet
from core.gait.strides import strides_of
from core.orientation import oriented
from core.pair import OrientedTrack
from core.rotations import matrix_from_quaternion
from core.samples import FloatArray, ImuBlock, RateKind
from core.tracks import even_tracks
from devices.walker import FootTruth, Standing, Tissue, Walk, WalkerSettings, simulate

FEET = {Side.LEFT: Site.LEFT_FOOT, Side.RIGHT: Site.RIGHT_FOOT}
EVENTS = ("initial_contact_s", "full_contact_s", "heel_rise_s", "toe_off_s")
PHASES = ("loading", "foot flat", "pre-swing", "swing")
SPEEDS_M_S = (0.3, 0.5, 0.8, 1.19, 1.6, 2.0)
RATES_HZ = (50.0, 60.0, 100.0, 200.0)
SAME_S = 0.15  # an event further than this from every true one is invented


@dataclass(frozen=True, slots=True)
class OpticalStride:
    """One stride of the optical recording, seconds and metres; the foot stands at `start_s` and `end_s`."""

    start_s: float
    end_s: float
    initial_contact_s: float
    toe_off_s: float
    length_m: float
    pitch_time_s: FloatArray
    rotations: Rotation


def foot_of(block: ImuBlock, bias_rad_s: FloatArray) -> OrientedTrack:
    (track,) = even_tracks(block)
    return oriented(track, RateKind.INSTANTANEOUS, bias_rad_s)


def optical_foot(data: Path, side: Side) -> tuple[OrientedTrack, list[OpticalStride]]:
    folder = data / "feet_mocap_events"
    with np.load(folder / "healthy_feet.npz") as arrays:
        rate_hz, mocap_hz = float(arrays["fs"]), float(arrays["mocap_fs"])
        gyr, acc = (arrays[f"{side}_foot_{kind}"].astype(np.float64) for kind in ("gyr", "acc"))
    block = ImuBlock(f"{side} foot", np.arange(len(gyr)) / rate_hz, gyr, acc)
    rest = rest_of(block)
    assert rest is not None
    place, turned = (_by_stride(folder / f"{name}_sample.csv", side) for name in ("position", "orientation"))
    strides = []
    for row in _rows(folder / "stride_events_sample.csv"):
        if row["foot"] == side:
            number, start_s = int(row["s_id"]), float(row["start"]) / rate_hz
            path = place[number]
            strides.append(
                OpticalStride(
                    start_s=start_s,
                    end_s=float(row["end"]) / rate_hz,
                    initial_contact_s=float(row["ic"]) / rate_hz,
                    toe_off_s=float(row["tc"]) / rate_hz,
                    length_m=float(np.linalg.norm(path[-1, :2] - path[0, :2])),
                    pitch_time_s=start_s + np.arange(len(path)) / mocap_hz,
                    rotations=Rotation.from_quat(turned[number]),
                )
            )
    return foot_of(block, rest.gyr_rad_s), strides


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def _by_stride(path: Path, side: Side) -> dict[int, FloatArray]:
    found: dict[int, list[list[float]]] = defaultdict(list)
    for row in _rows(path):
        sensor, number, _, *values = row.values()
        if sensor == f"{side}_sensor":
            found[int(number)].append([float(value) for value in values])
    return {number: np.array(values) for number, values in found.items()}


def heel_travel_m(data: Path, side: Side, from_s: FloatArray, to_s: FloatArray) -> FloatArray:
    """How far the heel's marker went over the floor (k,) between instants (k,)."""
    with np.load(data / "feet_mocap_events" / "healthy_feet.npz") as arrays:
        marker, rate_hz = arrays[f"mocap_{side.name[0]}_FCC_m"].astype(np.float64), float(arrays["mocap_fs"])
    at = [np.clip(np.round(t * rate_hz).astype(int), 0, len(marker) - 1) for t in (from_s, to_s)]
    return np.linalg.norm(marker[at[1], :2] - marker[at[0], :2], axis=1)


def optics(data: Path) -> None:
    """The optical list leaves out first and last steps, and runs two swings of a turn together as one stride.

    A swing that is not in it is therefore invented only if the heel's marker did not travel.
    """
    errors: dict[str, list[float]] = defaultdict(list)
    for side in Side:
        foot, strides = optical_foot(data, side)
        events = gait_of(foot)
        nearest = [int(np.argmin(np.abs(events.initial_contact_s - s.initial_contact_s))) for s in strides]
        travel_m = heel_travel_m(data, side, events.heel_rise_s, events.full_contact_s)
        more = sorted(set(range(len(events))) - set(nearest))
        is_invented = [travel_m[k] < 0.5 * events.length_m[k] for k in more]
        for stride, k in zip(strides, nearest, strict=True):
            errors["initial contact"].append(1000.0 * (events.initial_contact_s[k] - stride.initial_contact_s))
            offs = 1000.0 * (events.toe_off_s - stride.toe_off_s)
            errors["toe-off"].append(float(offs[np.argmin(np.abs(offs))]))
            errors["length"].append(float(events.length_m[k] - stride.length_m))
            errors["true length"].append(stride.length_m)
        found = sum(abs(ms) < 1000.0 * SAME_S for ms in errors["initial contact"][-len(strides) :])
        print(f"optics {side}: {found} of {len(strides)} found, {len(more)} more, {sum(is_invented)} of them invented")
        errors["pitch"] += _pitch_errors_deg(foot, strides)
    for name in ("initial contact", "toe-off"):
        ms = np.array(errors[name])
        worst = np.max(np.abs(ms - ms.mean()))
        print(f"optics {name:15s} offset {ms.mean():6.1f} ms, sd {ms.std(ddof=1):4.1f}, worst {worst:.0f}")
    error, mean = np.array(errors["length"]), float(np.mean(errors["true length"]))
    print(f"optics stride length   bias {100 * error.mean() / mean:6.2f} %, sd {100 * error.std(ddof=1):4.2f} cm")
    pitch = np.array(errors["pitch"])
    pooled = float(np.sqrt(np.mean(pitch**2)))
    print(
        f"optics pitch           RMSE {pooled:.2f} deg, median {np.median(pitch):.2f}, worst stride {pitch.max():.2f}"
    )


def _pitch_errors_deg(foot: OrientedTrack, strides: list[OpticalStride]) -> list[float]:
    """RMSE of each stride of the turn about the foot's pitch axis since the stride began, both less their means."""
    motion = follow(foot)
    turned = Rotation.from_matrix(matrix_from_quaternion(foot.q_earth_from_sensor))
    errors = []
    for stride in strides:
        at = np.clip((stride.pitch_time_s - motion.start_s) / motion.step_s, 0, len(turned) - 1)
        ours = turned[np.round(at).astype(int)]
        angles = []
        for rotations in (ours, stride.rotations):
            since = (rotations[0].inv() * rotations).as_rotvec()
            main = np.linalg.eigh(since.T @ since)[1][:, -1]
            angle = since @ main
            angles.append(np.rad2deg(angle * np.sign(angle[np.argmax(np.abs(angle))])))
        difference = angles[0] - angles[1]
        errors.append(float(np.std(difference)))
    return errors


def phases_of(events: FootEvents | FootTruth) -> list[FloatArray]:
    """Durations of loading, foot flat, pre-swing and swing, the swing last, as in PHASES."""
    told = events.events if isinstance(events, FootTruth) else events
    return [
        told.full_contact_s[:-1] - told.initial_contact_s[:-1],
        told.heel_rise_s[1:] - told.full_contact_s[:-1],
        told.toe_off_s[1:] - told.heel_rise_s[1:],
        told.initial_contact_s[1:] - told.toe_off_s[1:],
    ]


def walker(speed_m_s: float, rate_hz: float, tissue: Tissue, seeds: int) -> None:
    """The first swing leaves standing and the last arrives there: counted as found, but not timed."""
    errors: dict[str, list[FloatArray]] = defaultdict(list)
    found, expected, speeds, times = 0, 0, [], []
    for seed in range(seeds):
        recordings = (Standing(), Walk(speed_m_s=speed_m_s))
        made = simulate(
            WalkerSettings(seed=seed, recordings=recordings, sites=tuple(FEET.values()), tissue=tissue, rate_hz=rate_hz)
        )
        standing, walk = made.session.recordings
        told = made.truth.recordings["walk 1"]
        strides = {}
        for side, site in FEET.items():
            rest, truth = rest_of(standing.imu[site]), told.feet[side]
            assert rest is not None
            events = gait_of(foot_of(walk.imu[site], rest.gyr_rad_s))
            strides[side] = strides_of([events])
            expected += len(truth.events.toe_off_s)
            found += len(events)
            if len(events) != len(truth.events.toe_off_s):
                continue
            for name in EVENTS:
                errors[name].append((getattr(events, name) - getattr(truth.events, name))[1:-1])
            for name, ours, true in zip(PHASES, phases_of(events), phases_of(truth), strict=True):
                errors[name].append((ours - true)[:-1])
            errors["length"].append((events.length_m / truth.stride_lengths_m - 1.0)[1:-1])
            contact = truth.events.initial_contact_s
            ours_s, is_used = strides[side].time_s, strides[side].is_used
            if len(ours_s) == len(contact) - 1 and is_used.any():
                times.append(float(ours_s[is_used].mean() / np.diff(contact)[is_used].mean() - 1.0))
        speeds.append(both_feet(strides[Side.LEFT], strides[Side.RIGHT]).speed_m_s / told.speed_m_s - 1.0)
    figures = [f"{found}/{expected}"]
    for name in (*EVENTS, *PHASES):
        ms = 1000.0 * np.concatenate([np.empty(0), *errors[name]])
        label = "".join(word[0] for word in name.removesuffix("_s").replace("-", " ").replace("_", " ").split())
        figures.append(f"{label} {ms.mean():4.0f}±{ms.std():3.0f}")
    length = 100.0 * np.concatenate([np.empty(0), *errors["length"]])
    figures.append(f"length {length.mean():5.2f}±{length.std():4.2f} %")
    figures.append(f"speed {100 * np.mean(speeds):5.2f}, stride time {100 * np.mean(times):5.2f} %")
    print(f"{speed_m_s:4.2f} m/s {rate_hz:3.0f} Hz {tissue:5s} | " + " | ".join(figures), flush=True)


def speed() -> None:
    """CPU of one core for a minute of both feet, the orientation filter apart."""
    made = simulate(WalkerSettings(recordings=(Standing(), Walk(strides=52)), sites=tuple(FEET.values())))
    feet = []
    for site in FEET.values():
        rest = rest_of(made.session.recordings[0].imu[site])
        assert rest is not None
        feet.append((made.session.recordings[1].imu[site], rest.gyr_rad_s))
    tracks = [foot_of(*foot) for foot in feet]
    minutes = float(np.ptp(feet[0][0].time_s)) / 60.0

    costs = []
    for _ in range(7):
        begun = time.process_time()
        for track in tracks:
            strides_of([gait_of(track)])
        costs.append(time.process_time() - begun)
    print(f"a minute of both feet at 100 Hz: {1000.0 * min(costs) / minutes:.1f} ms of CPU")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=2)
    seeds = parser.parse_args().seeds
    told = os.environ.get("GAITWRIGHT_TEST_DATA")
    if told:
        optics(Path(told))
    else:
        print("GAITWRIGHT_TEST_DATA is not set: the optical recordings are left out.")
    speed()
    for tissue in Tissue:
        for speed_m_s in SPEEDS_M_S:
            for rate_hz in RATES_HZ:
                walker(speed_m_s, rate_hz, tissue, seeds)


if __name__ == "__main__":
    main()
