"""Compare a foot's live events with those of the whole walk looked at afterwards. Agreement, timeliness and cost.

    python -m tests.benchmarks.live_gait [--seeds 2] [--axis]
    python -m tests.benchmarks.live_gait --turns 10

Optical recordings (where GAITWRIGHT_TEST_DATA names the shared folder) and the project's own patient. For every kind of
recording and every event: how many the whole walk has, how many were reported live, how many more were reported
(invented), how far the live times are from the others, how long after it happened an event was reported, and how many
were late. With `--axis` the pitch axis is given, as a calibration would. `--turns SEEDS` makes the table of contacts
instead: legs that hang from a pelvis, half turns on arcs and on the balls of the feet, at random speeds, rates and
tissues, beside the truth and beside the whole walk; and people after a stroke.
"""

import os
import time
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from core.body import Side, Site
from core.calibration.rest import rest_of
from core.gait.events import gait_of
from core.gait.foot import follow
from core.gait.live import FootEvent, LiveEvents
from core.samples import FloatArray, ImuBlock, RateKind
from core.signal.orientation import oriented
from core.signal.pair import OrientedTrack
from core.signal.tracks import even_tracks
from devices.files.session_folder import read_session
from devices.simulation.walker import Standing, Tissue, Walk, WalkerSettings, simulate
from tests.driver import options

SITES = (Site.LEFT_FOOT, Site.RIGHT_FOOT)
SPEEDS_M_S = (0.3, 0.5, 0.8, 1.19, 1.6, 2.0)
RATES_HZ = (50.0, 60.0, 100.0, 200.0)
SAME_S = 0.25  # two times of one event are no further apart; a foot's steps are further than twice that
BOUND_S = 0.030
TURNS = (  # name, turn, radius of its arc, share on the ball of the foot
    ("straight", 0.0, 0.8, 0.0),
    ("U-turn of 0.8 m", np.pi, 0.8, 0.0),
    ("U-turn of 0.3 m", np.pi, 0.3, 0.0),
    ("pivot, half of the turn", np.pi, 0.3, 0.5),
    ("pivot, most of the turn", np.pi, 0.15, 0.8),
)


@dataclass(slots=True)
class Score:
    """One event over the recordings of one kind; times in s."""

    offline: int = 0
    invented: int = 0
    late: int = 0
    differences: list[float] = field(default_factory=list)
    delays: list[float] = field(default_factory=list)


def add(scores: dict[FootEvent, Score], foot: OrientedTrack, is_axis_given: bool) -> None:
    track, offline = foot.track, gait_of(foot)
    live = LiveEvents(follow(foot).pitch_axis if is_axis_given else None)
    reported = live.update(track.time_s, track.gyr_rad_s, track.acc_m_s2)
    for event in FootEvent:
        score = scores[event]
        mine = [e for e in reported if e.event is event]
        score.delays += [e.reported_s - e.time_s for e in mine]
        score.late += sum(e.is_late for e in mine)
        match(score, np.array([e.time_s for e in mine]), getattr(offline, f"{event}_s"))


def match(score: Score, at_s: FloatArray, expected_s: FloatArray) -> None:
    """Count which of the expected instants were reported, and what was reported besides."""
    free = np.ones(len(at_s), dtype=bool)
    score.offline += len(expected_s)
    for expected in expected_s:
        away = np.where(free, np.abs(at_s - expected), np.inf)
        if len(away) and away.min() < SAME_S:
            free[np.argmin(away)] = False
            score.differences.append(float(away.min()))
    score.invented += int(free.sum())


def show_message(kind: str, scores: dict[FootEvent, Score]) -> None:
    for event, score in scores.items():
        away, delay = 1000.0 * np.array(score.differences), 1000.0 * np.array(score.delays)
        if not len(away):
            continue
        print(
            f"{kind:28s} {event:15s} | whole walk {score.offline:4d} told {len(away):4d} invented {score.invented:3d}"
            f" | apart p95 {np.percentile(away, 95):5.1f} worst {away.max():4.0f} ms,"
            f" over {1000 * BOUND_S:.0f}: {int(np.sum(away > 1000 * BOUND_S)):3d}"
            f" | after p50 {np.median(delay):3.0f} p95 {np.percentile(delay, 95):4.0f} worst {delay.max():4.0f} ms,"
            f" late {score.late}",
            flush=True,
        )


def feet_of(standing: Mapping[Site, ImuBlock], walking: Mapping[Site, ImuBlock]) -> list[OrientedTrack]:
    feet = []
    for site, block in walking.items():
        rest = rest_of(standing[site])
        assert rest is not None
        (track,) = even_tracks(block)
        feet.append(oriented(track, RateKind.INSTANTANEOUS, rest.gyr_rad_s))
    return feet


def optical_feet(data: Path) -> list[OrientedTrack]:
    """The recording begins in standing."""
    blocks = {}
    with np.load(data / "feet_mocap_events" / "healthy_feet.npz") as arrays:
        for side, site in zip(Side, SITES, strict=True):
            gyr, acc = (arrays[f"{side}_foot_{kind}"].astype(np.float64) for kind in ("gyr", "acc"))
            blocks[site] = ImuBlock(f"{side} foot", np.arange(len(gyr)) / float(arrays["fs"]), gyr, acc)
    return feet_of(blocks, blocks)


def walker_feet(settings: WalkerSettings) -> list[OrientedTrack]:
    standing, walk = simulate(settings).session.recordings
    return feet_of(standing.imu, walk.imu)


def walking(speed_m_s: float, rate_hz: float, tissue: Tissue, seed: int, turn_rad: float = 0.0) -> WalkerSettings:
    recordings = (Standing(), Walk(speed_m_s=speed_m_s, turn_rad=turn_rad))
    return WalkerSettings(seed=seed, recordings=recordings, sites=SITES, rate_hz=rate_hz, tissue=tissue)


def cost(block: int, rate_hz: float = 200.0) -> None:
    """Share of one core that both feet take, in blocks as a radio delivers them."""
    feet = walker_feet(replace(walking(1.19, rate_hz, Tissue.SOFT, 1), recordings=(Standing(), Walk(strides=30))))
    blocks = []
    for foot in feet:
        track = foot.track
        columns = (track.time_s, track.gyr_rad_s, track.acc_m_s2)
        blocks.append([[column[k : k + block] for column in columns] for k in range(0, len(track), block)])
    lasts_s = min(foot.track.end_s - foot.track.start_s for foot in feet)
    shares = []
    for _ in range(5):
        begun = time.process_time()
        for blocks_of_foot in blocks:
            live = LiveEvents()
            for time_s, gyr, acc in blocks_of_foot:
                live.update(time_s, gyr, acc)
        shares.append((time.process_time() - begun) / lasts_s)
    print(f"both feet at {rate_hz:.0f} Hz in blocks of {block}: {100.0 * min(shares):.2f} % of a core")


def kinds_of_turns(seeds: int) -> dict[str, list[WalkerSettings]]:
    """Walks of 12 strides, half of them with both feet's sensors alone."""
    kinds: dict[str, list[WalkerSettings]] = defaultdict(list)
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        for name, turn_rad, radius_m, pivot_share in TURNS:
            for hung, sites in (("feet", SITES), ("seven sensors", (*SITES, Site.PELVIS))):
                walk = Walk(
                    strides=12,
                    speed_m_s=float(rng.choice([0.5, 0.8, 1.19, 1.6])),
                    turn_rad=float(rng.choice([-1.0, 1.0])) * turn_rad,
                    turn_radius_m=radius_m,
                    pivot_share=pivot_share,
                )
                rate_hz, tissue = float(rng.choice([60.0, 100.0, 200.0])), list(Tissue)[int(rng.integers(3))]
                kinds[f"{hung}, {name}"].append(
                    WalkerSettings(
                        seed=seed, recordings=(Standing(), walk), sites=sites, rate_hz=rate_hz, tissue=tissue
                    )
                )
    return kinds


def show_turns(seeds: int) -> None:
    print("| walks | of the truth | invented | of the whole walk | more than it |\n|---|---|---|---|---|")
    for name, required in kinds_of_turns(seeds).items():
        true, whole = Score(), Score()
        for settings in required:
            made = simulate(settings)
            standing, walk = made.session.recordings
            feet = feet_of({site: standing.imu[site] for site in SITES}, {site: walk.imu[site] for site in SITES})
            for side, foot in zip(Side, feet, strict=True):
                reported_s = contacts_of(foot)
                match(true, reported_s, made.truth.recordings[walk.name].feet[side].events.initial_contact_s)
                match(whole, reported_s, gait_of(foot).initial_contact_s)
        show_row(name, true, whole)
    reported = os.environ.get("GAITWRIGHT_TEST_DATA")
    for folder in sorted((Path(reported) / "stroke_treadmill").glob("stroke*")) if reported else []:
        whole = Score()
        (walk,) = read_session(folder).recordings
        for site in SITES:
            rest, (track,) = rest_of(walk.imu[site]), even_tracks(walk.imu[site])
            foot = oriented(track, RateKind.INSTANTANEOUS, np.zeros(3) if rest is None else rest.gyr_rad_s)
            match(whole, contacts_of(foot), gait_of(foot).initial_contact_s)
        show_row(folder.name, None, whole)


def contacts_of(foot: OrientedTrack) -> FloatArray:
    reported = LiveEvents().update(foot.track.time_s, foot.track.gyr_rad_s, foot.track.acc_m_s2)
    return np.array([e.time_s for e in reported if e.event is FootEvent.INITIAL_CONTACT])


def show_row(name: str, true: Score | None, whole: Score) -> None:
    of_truth = "- | -" if true is None else f"{len(true.differences)} of {true.offline} | {true.invented}"
    print(f"| {name} | {of_truth} | {len(whole.differences)} of {whole.offline} | {whole.invented} |", flush=True)


def main() -> None:
    args = options(
        __doc__,
        seeds=2,
        axis=(False, "give the pitch axis"),
        turns={"type": int, "metavar": "SEEDS", "help": "the table of contacts in turns instead"},
    )
    if args.turns:
        show_turns(args.turns)
        return
    for block in (1, 4, 40):
        cost(block)
    reported = os.environ.get("GAITWRIGHT_TEST_DATA")
    if reported:
        scores: dict[FootEvent, Score] = defaultdict(Score)
        for foot in optical_feet(Path(reported)):
            add(scores, foot, args.axis)
        show_message("optics, both feet", scores)
    else:
        print("GAITWRIGHT_TEST_DATA is not set: the optical recordings are left out.")
    kinds: dict[str, list[WalkerSettings]] = defaultdict(list)
    for seed in range(args.seeds):
        for speed_m_s in SPEEDS_M_S:
            for tissue in Tissue:
                for rate_hz in RATES_HZ:
                    name = f"{tissue}, {'50-60' if rate_hz < 100 else '100-200'} Hz"
                    kinds[name].append(walking(speed_m_s, rate_hz, tissue, seed))
            ordinary = walking(speed_m_s, 100.0, Tissue.SOFT, seed)
            kinds["prosthesis, 100 Hz"].append(replace(ordinary, prosthetic_side=Side.LEFT))
            kinds["stiff knee, 100 Hz"].append(replace(ordinary, stiff_knee_side=Side.LEFT))
            kinds["turning round, 100 Hz"].append(walking(speed_m_s, 100.0, Tissue.SOFT, seed, np.pi))
    for name, required in kinds.items():
        scores = defaultdict(Score)
        for settings in required:
            for foot in walker_feet(settings):
                add(scores, foot, args.axis)
        show_message(name, scores)


if __name__ == "__main__":
    main()
