"""Accuracy and speed of finding a foot's events and strides, beside gaitmap, against optics.

    python -m tests.benchmarks.gait [--repeats 7]

The optical recordings are used where GAITWRIGHT_TEST_DATA names the shared folder. Every method is scored by
foot_scoring.py. CPU seconds of one core, for a minute of the walker, by turns.
"""

import csv
import os
import sys
import time
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.body import Side, Site
from core.calibration.rest import rest_of
from core.gait.events import gait_of
from core.gait.strides import strides_of
from core.samples import BoolArray, FloatArray, ImuBlock
from devices.simulation.walker import Standing, Walk, WalkerSettings, simulate
from tests.benchmarks.foot_scoring import (
    EventScore,
    FoundEvents,
    FoundStrides,
    OpticalFoot,
    OpticalStride,
    Stretch,
    StrideScore,
    score_events,
    score_strides,
)
from tests.benchmarks.peers.gaitmap_feet import GaitmapFeet
from tests.benchmarks.speed import ONE_CORE, machine
from tests.core.gait.feet import foot_of
from tests.driver import options

FEET = {Side.LEFT: Site.LEFT_FOOT, Side.RIGHT: Site.RIGHT_FOOT}
NO_BIAS = np.zeros(3)
OURS = "Gaitwright"
STRIDES_SHOWN = ("gravity|BarthDtw", "gravity|by hand", "gravity|optical stances")  # the others hardly differ

# from the sensors' axes to those gaitmap asks for (toes, left, up), as the makers of the recording mounted them
TOES_LEFT_UP = {
    Side.LEFT: np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
    Side.RIGHT: np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]),
}

# stages of gaitmap that make a whole, but for the alignment; the first is what its documentation shows
GAITMAP_BEFORE = ("body", "BarthDtw", "BarthDtw|Rampp")
GAITMAP_AFTER = {
    "stride by stride, gyroscope": "BarthDtw|stride, gyroscope",
    "stride by stride, Madgwick": "BarthDtw|stride, Madgwick",
    "stride by stride, RtsKalman": "BarthDtw|stride, RtsKalman",
    "in one piece, RtsKalman": "BarthDtw|region, RtsKalman",
}


def without_bias(block: ImuBlock, standing: ImuBlock) -> ImuBlock:
    rest = rest_of(standing)
    assert rest is not None
    return replace(block, gyr_rad_s=block.gyr_rad_s - rest.gyr_rad_s)


def recorded_foot(data: Path, side: Side) -> ImuBlock:
    with np.load(data / "feet_mocap_events" / "healthy_feet.npz") as arrays:
        gyr, acc = (arrays[f"{side}_foot_{kind}"].astype(np.float64) for kind in ("gyr", "acc"))
        time_s = np.arange(len(gyr)) / float(arrays["fs"])
    block = ImuBlock(f"{side} foot", time_s, gyr, acc)
    return without_bias(block, block)


def optical_foot(data: Path, side: Side) -> OpticalFoot:
    folder = data / "feet_mocap_events"
    with np.load(folder / "healthy_feet.npz") as arrays:
        rate_hz, mocap_hz = float(arrays["fs"]), float(arrays["mocap_fs"])
        heel_m = arrays[f"mocap_{side.name[0]}_FCC_m"].astype(np.float64)[:, :2]
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
                    stretch=Stretch(start_s + np.arange(len(path)) / mocap_hz, Rotation.from_quat(turned[number])),
                )
            )
    return OpticalFoot(strides, np.arange(len(heel_m)) / mocap_hz, heel_m)


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


def reported_to_gaitmap(data: Path) -> dict[str, FloatArray]:
    """The borders labelled by hand, and the optical strides, as GaitmapFeet takes them."""
    reported = {}
    for side in Side:
        for name, file in (("borders", "stride_borders_sample.csv"), ("stances", "stride_events_sample.csv")):
            columns = ["s_id", "start", "end"] + (["ic", "tc", "min_vel", "pre_ic"] if name == "stances" else [])
            rows = [row for row in _rows(data / "feet_mocap_events" / file) if row["foot"] == side]
            reported[f"{side}_{name}"] = np.array([[float(row[column]) for column in columns] for row in rows])
    return reported


def optics(data: Path, gaitmap: GaitmapFeet | None) -> Iterator[str]:
    """Tables of events and of strides, every method beside ours on the strides that both found."""
    blocks = {side: recorded_foot(data, side) for side in Side}
    truth = {side: optical_foot(data, side) for side in Side}
    events: dict[str, dict[Side, FoundEvents]] = defaultdict(dict)
    strides: dict[str, dict[Side, FoundStrides]] = defaultdict(dict)
    for side, block in blocks.items():
        foot = foot_of(block, NO_BIAS)
        found = gait_of(foot)
        turned = Stretch(foot.track.time_s, Rotation.from_quat(foot.q_earth_from_sensor, scalar_first=True))
        events[OURS][side] = FoundEvents(found.toe_off_s, found.initial_contact_s)
        strides[OURS][side] = FoundStrides(found.initial_contact_s, found.length_m, (turned,))
    if gaitmap is not None:
        mounted = {
            side: replace(b, acc_m_s2=b.acc_m_s2 @ axes.T, gyr_rad_s=b.gyr_rad_s @ axes.T)
            for side, b, axes in ((side, blocks[side], TOES_LEFT_UP[side]) for side in Side)
        }
        theirs = gaitmap.find(mounted, ("gravity", "heading"), reported_to_gaitmap(data))
        events |= theirs.events
        strides |= {name: found for name, found in theirs.strides.items() if name.startswith(STRIDES_SHOWN)}
    event_scores = {k: EventScore.joined([score_events(f[s], truth[s]) for s in Side]) for k, f in events.items()}
    stride_scores = {k: StrideScore.joined([score_strides(f[s], truth[s]) for s in Side]) for k, f in strides.items()}
    yield from event_table(event_scores)
    yield ""
    yield from stride_table(stride_scores)


def event_table(scores: Mapping[str, EventScore]) -> Iterator[str]:
    yield (
        "| method | aligned by | borders | found | more | invented | contact, ms | sd, ms | our sd there "
        "| toe-off, ms | sd, ms | our sd there |"
    )
    yield "|---" * 12 + "|"
    ours = scores[OURS]
    for name, score in scores.items():
        both = score.is_found & ours.is_found
        contact_ms, off_ms = (1000.0 * late[score.is_found] for late in (score.contact_s, score.off_s))
        beside_ms = (1000.0 * late[both] for late in (ours.contact_s, ours.off_s))
        our_contact, our_off = ("" if name == OURS else f"{_sd(late):.1f}" for late in beside_ms)
        yield (
            f"| {_named(name)} | {np.sum(score.is_found)} of {len(score.is_found)} | {score.more} | {score.invented} "
            f"| {np.mean(contact_ms):.1f} | {_sd(contact_ms):.1f} | {our_contact} "
            f"| {np.mean(off_ms):.1f} | {_sd(off_ms):.1f} | {our_off} |"
        )


def stride_table(scores: Mapping[str, StrideScore]) -> Iterator[str]:
    yield (
        "| method | borders | lengths | bias, % | sd, cm | our bias there, % | our sd there, cm "
        "| pitches | RMSE, deg | clock, ms | our RMSE there |"
    )
    yield "|---" * 11 + "|"
    ours = scores[OURS]
    for name, score in scores.items():
        long, turned = score.has_length, score.has_pitch
        pitch_rad, clock_s = score.pooled_pitch_rad(turned)
        beside = "|  | " if name == OURS else f"| {_length_cells(ours, long & ours.has_length)} "
        our_pitch_rad, _ = ours.pooled_pitch_rad(turned & ours.has_pitch)
        method, _, borders = _named(name).split(" | ")
        yield (
            f"| {method} | {borders} | {np.sum(long)} | {_length_cells(score, long)} {beside}"
            f"| {np.sum(turned)} | {np.rad2deg(pitch_rad):.2f} | {1000.0 * clock_s:.1f} "
            f"| {'' if name == OURS else f'{np.rad2deg(our_pitch_rad):.2f}'} |"
        )


def _named(name: str) -> str:
    """Method, alignment and borders as cells."""
    if name == OURS:
        return f"{OURS} |  | its own"
    alignment, borders, method = name.split("|")
    return f"gaitmap {method} | {alignment} | {borders}"


def _length_cells(score: StrideScore, which: BoolArray) -> str:
    """Bias and sd."""
    error_m = score.error_m[which]
    return f"{100.0 * np.mean(error_m) / np.mean(score.true_m[which]):.2f} | {100.0 * _sd(error_m):.2f}"


def _sd(values: FloatArray) -> float:
    return float(np.std(values, ddof=1))


def speed(gaitmap: GaitmapFeet | None, repeats: int) -> Iterator[str]:
    """A table of CPU for a minute of both feet of the walker, the methods by turns, each ratio taken within a turn.

    gaitmap is warm: its first run, in which it compiles, is not counted; nor is its alignment in its wholes.
    """
    made = simulate(WalkerSettings(recordings=(Standing(), Walk(strides=52)), sites=tuple(FEET.values())))
    standing, walk = made.session.recordings
    feet = {side: without_bias(walk.imu[site], standing.imu[site]) for side, site in FEET.items()}
    minutes = float(np.ptp(feet[Side.LEFT].time_s)) / 60.0
    if gaitmap is not None:
        swings = sum(len(reported.events.toe_off_s) for reported in made.truth.recordings["walk 1"].feet.values())
        warm = gaitmap.find(feet, ("heading",))
        ours = sum(len(gait_of(foot_of(foot, NO_BIAS))) for foot in feet.values())
        theirs = sum(len(events.toe_off_s) for events in warm.events["heading|BarthDtw|Rampp"].values())
        versions = " ".join(f"{name} {number}" for name, number in warm.versions.items())
        yield f"Of {swings} swings, {OURS} found {ours}, gaitmap (BarthDtw, Rampp) {theirs}. Its side: {versions}."
        yield ""
    turns = []
    for _ in range(repeats):
        turn = our_costs(list(feet.values()))
        if gaitmap is not None:
            turn |= gaitmap_costs(gaitmap.find(feet, ("heading",)).cpu_s)
        turns.append(turn)
    yield "| what | ms | of all of Gaitwright |"
    yield "|---|---|---|"
    whole = f"{OURS}, all"
    for name in turns[0]:
        cost_ms = 1000.0 * float(np.median([turn[name] for turn in turns])) / minutes
        yield f"| {name} | {cost_ms:.1f} | {np.median([turn[name] / turn[whole] for turn in turns]):.2f} |"


def our_costs(feet: Sequence[ImuBlock]) -> dict[str, float]:
    begun_s = time.process_time()
    tracks = [foot_of(foot, NO_BIAS) for foot in feet]
    turned_s = time.process_time()
    for track in tracks:
        strides_of([gait_of(track)])
    ended_s = time.process_time()
    return {f"{OURS}, all": ended_s - begun_s, f"{OURS}, without the orientation filter": ended_s - turned_s}


def gaitmap_costs(cpu_s: Mapping[str, float]) -> dict[str, float]:
    """CPU seconds of gaitmap's parts and wholes, from those of its stages."""
    stage_s = {name.removeprefix("heading|"): cost_s for name, cost_s in cpu_s.items()}
    before_s = sum(stage_s[name] for name in GAITMAP_BEFORE)
    after_s = {name: stage_s[key] + stage_s[f"{key}|parameters"] for name, key in GAITMAP_AFTER.items()}
    return {
        "gaitmap, alignment to gravity and heading": stage_s["gravity"] + stage_s["heading"],
        "gaitmap, BarthDtw, Rampp, no trajectory": before_s,
        "gaitmap, BarthDtw": stage_s["BarthDtw"],
        "gaitmap, ConstrainedBarthDtw": stage_s["ConstrainedBarthDtw"],
        "gaitmap, Rampp events": stage_s["BarthDtw|Rampp"],
        "gaitmap, Herzer events": stage_s["BarthDtw|Herzer"],
        **{f"gaitmap, trajectory {name}, and parameters": cost_s for name, cost_s in after_s.items()},
        **{f"gaitmap, BarthDtw, Rampp, {name}": before_s + cost_s for name, cost_s in after_s.items()},
    }


def peers_gaitmap(stack: ExitStack) -> GaitmapFeet | None:
    try:
        return stack.enter_context(GaitmapFeet())
    except RuntimeError as error:
        print(f"gaitmap is left out: {error}", file=sys.stderr)
        return None


def main() -> None:
    repeats = options(__doc__, repeats=(7, "turns of the speed comparison")).repeats
    reported = os.environ.get("GAITWRIGHT_TEST_DATA")
    with ExitStack() as stack:
        gaitmap = peers_gaitmap(stack)
        print(f"On {machine()}", end="\n\n")
        if reported:
            print("\n".join(optics(Path(reported), gaitmap)), end="\n\n", flush=True)
        else:
            print("GAITWRIGHT_TEST_DATA is not set: the optical recordings are left out.", file=sys.stderr)
        print("\n".join(speed(gaitmap, repeats)))


if __name__ == "__main__":
    if any(os.environ.get(name) != "1" for name in ONE_CORE):  # NumPy reads these when it is imported
        again = [sys.executable, "-m", "tests.benchmarks.gait", *sys.argv[1:]]
        os.execve(sys.executable, again, {**os.environ, **ONE_CORE})
    main()
