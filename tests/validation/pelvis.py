"""Hips, headings and the clock of both legs on simulated sessions with a sensor on the pelvis.

`python -m tests.validation.pelvis [SESSIONS] [WORKERS]` prints for rigid, soft and real tissue: flexion and abduction
after removing the mean, the heading's error, its claimed sd, the clock's error where it was found, and what was
not reported. Every session has a clock per leg, up to 100 ms apart, and a walk of 20 strides and more with a turn.
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context

import numpy as np

from core.analysis import analyse
from core.angles.measure import pairs_of
from core.body import LEG_SITES, Side, Site, hip_of
from core.calibration.rate_kind import tracks_of_kind
from core.calibration.validity import spans_of_validity
from core.hip.clocks import HipClocks
from core.hip.measure import fits_of
from core.hip.results import ClockStatus
from core.samples import FloatArray
from core.signal.rotations import wrap
from core.verdicts.quality import look_at
from devices.simulation.walker import SimulatedSession, Standing, Tissue, Walk, WalkerSettings, simulate
from devices.simulation.walker_pelvis import hip_truth

MOST_LATE_S = 0.1
WRONG_DEG = 45.0


@dataclass(frozen=True, slots=True)
class HipScore:
    """One hip of one session; degrees and seconds, NaN where there is none."""

    flexion_deg: float
    abduction_deg: float
    heading_deg: float
    heading_sd_deg: float
    held_share: float
    margin: float
    disagreement: float
    is_3d: bool
    is_reported: bool
    gates: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SessionScore:
    """`clock_ms` is the error of the offset, NaN where it is not reported."""

    hips: tuple[HipScore, ...]
    clock_ms: float
    raw_clock_ms: float


def score(tissue: Tissue, seed: int) -> SessionScore:
    """Simulate one session and hold what is found against what is true."""
    rng = np.random.default_rng([seed, 77])
    late_s = float(rng.uniform(-MOST_LATE_S, MOST_LATE_S))
    late = {site: late_s if site.side is Side.RIGHT else 0.0 for site in LEG_SITES}
    settings = WalkerSettings(
        seed=seed,
        sites=(*LEG_SITES, Site.PELVIS),
        tissue=tissue,
        clock_late_s=late,
        recordings=(
            Standing(),
            Walk(strides=int(rng.integers(21, 26)), turn_rad=float(rng.choice([-1.0, 1.0])) * np.pi),
        ),
    )
    made = simulate(settings)
    walk = analyse(made.session).recordings[-1]
    clock = walk.leg_clock
    raw_ms = 1000 * (clock.offset_s - late_s) if clock is not None else float("nan")
    is_found = clock is not None and clock.status is ClockStatus.FOUND
    hips = []
    for side in Side:
        if hip_of(side) not in walk.hips:
            continue
        stood, moved = made.moved[0], made.moved[-1]
        assert stood.pelvis is not None
        assert moved.pelvis is not None
        known = hip_truth(
            moved.pelvis, (stood.pelvis, stood.legs[side]), moved.legs[side], side, moved.mountings, moved.clocks, late
        )
        on_clock_s = known.time_s - late[hip_of(side).distal]
        hip = walk.hips[hip_of(side)]
        flexion, abduction = (
            np.rad2deg(found - np.interp(walk.time_s, on_clock_s, true))
            for found, true in ((hip.angle_rad, known.flexion_rad), (hip.abduction_rad, known.abduction_rad))
        )
        received = np.isfinite(flexion)
        about = np.abs(flexion - np.nanmean(flexion))[received]
        stated = walk.verdicts.joint(hip_of(side)).shape
        hips.append(
            HipScore(
                flexion_deg=float(np.nanstd(flexion)),
                abduction_deg=float(np.nanstd(abduction)) if np.isfinite(abduction).any() else float("nan"),
                heading_deg=_heading_error_deg(made, side, hip.identification.lag_s),
                heading_sd_deg=float(np.rad2deg(hip.identification.heading_sd_rad)),
                held_share=float(np.mean(about < 2 * np.rad2deg(hip.sd_rad[received]))),
                margin=hip.identification.margin,
                disagreement=hip.identification.disagreement,
                is_3d=hip.identification.is_3d,
                is_reported=stated.is_reported,
                gates=tuple(reason.gate for reason in stated.reasons),
            )
        )
    return SessionScore(tuple(hips), raw_ms if is_found else float("nan"), raw_ms)


def _heading_error_deg(made: SimulatedSession, side: Side, lag_s: float) -> float:
    """The mean error of the heading over the walk, with the filters' own headings taken from the true poses."""
    session, moved = made.session, made.moved[-1]
    assert moved.pelvis is not None
    span = spans_of_validity(session)[0]
    tracks, _ = tracks_of_kind(session, span, look_at(session).unusable)
    recording = session.recordings[-1]
    clocks = HipClocks(None, {side: lag_s})
    (fit,) = fits_of(tracks, recording, clocks, side)
    (pair,) = pairs_of(tracks, recording, hip_of(side), tracks.blocks(recording)[0], lag_s)
    assert fit is not None
    fine_s = moved.pelvis.time_s
    index = np.round((pair.time_s - fine_s[0]) / (fine_s[1] - fine_s[0])).astype(int)
    bones = moved.pelvis.rotations[index], moved.legs[side].rotations[0][index]
    sites = Site.PELVIS, hip_of(side).distal
    true = [bone @ moved.mountings[site].segment_from_sensor for bone, site in zip(bones, sites, strict=True)]
    error = wrap(fit.heading(pair) - _turn(pair.earth_from_1, true[0]) + _turn(pair.earth_from_2, true[1]))
    return float(np.rad2deg(np.angle(np.mean(np.exp(1j * error)))))


def _turn(found: FloatArray, true: FloatArray) -> FloatArray:
    """By how much found poses (n, 3, 3) are turned about the vertical against true ones (n,), rad."""
    turned = found @ np.swapaxes(true, 1, 2)
    return np.arctan2(turned[:, 1, 0] - turned[:, 0, 1], turned[:, 0, 0] + turned[:, 1, 1])


def report(tissue: Tissue, scores: list[SessionScore]) -> None:
    """Print the figures of one kind of tissue."""
    hips = [hip for one in scores for hip in one.hips]
    clocks = np.abs([one.clock_ms for one in scores])
    found = clocks[np.isfinite(clocks)]
    heading = np.abs([hip.heading_deg for hip in hips])
    sd = np.array([hip.heading_sd_deg for hip in hips])
    gates = [gate for hip in hips for gate in hip.gates]
    print(f"\n{tissue.value}: {len(scores)} sessions, {len(hips)} hips")
    for name in ("flexion_deg", "abduction_deg", "margin", "disagreement", "heading_sd_deg", "held_share"):
        values = np.array([getattr(hip, name) for hip in hips])
        values = values[np.isfinite(values)]
        if len(values):
            low, middle, high = np.percentile(values, [10, 50, 90])
            print(f"  {name:16s} p10 {low:8.3f}  median {middle:8.3f}  p90 {high:8.3f}  n {len(values)}")
    print(f"  heading error    median {np.median(heading):.2f}  p90 {np.percentile(heading, 90):.2f}")
    print(
        f"  headings wrong by over 45 deg: {np.sum(heading > WRONG_DEG)}; within 2 sd: {np.mean(heading < 2 * sd):.3f}"
    )
    worst = f"{found.max():.2f}" if len(found) else "-"
    usual = f"{np.median(found):.2f}" if len(found) else "-"
    print(f"  clock found in {len(found)}, error median {usual} worst {worst} ms")
    raw = np.abs([one.raw_clock_ms for one in scores])
    print(f"  offset whether told or not: median {np.nanmedian(raw):.2f} worst {np.nanmax(raw):.2f} ms")
    reported, by_angles = np.mean([hip.is_reported for hip in hips]), np.mean([hip.is_3d for hip in hips])
    print(
        f"  hips reported {reported:.2f}, by Cardan angles {by_angles:.2f}; "
        f"gates { {g: gates.count(g) for g in set(gates)} }"
    )


def main(sessions: int, workers: int) -> None:
    """Print the figures of `sessions` sessions of each tissue."""
    with ProcessPoolExecutor(workers, mp_context=get_context("forkserver")) as pool:
        for tissue in Tissue:
            report(tissue, list(pool.map(partial(score, tissue), range(100, 100 + sessions))))


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:]]
    main(*(numbers + [200, 2][len(numbers) :]))
