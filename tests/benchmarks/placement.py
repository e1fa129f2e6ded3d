"""Find which sensor is where, on the project's own patient.

Counts how often chains are wrong, and labels doubted or believed.

    python -m tests.benchmarks.placement --seeds 200 [--only rigid soft ...]

Every sensor is mounted anyhow, biased (1.5 deg/s, 0.1 m/s2) and up to 30 ms late. One line per condition for the
chains of six sensors, of one leg's three and of two knees' four, or of seven with one on the pelvis: wrong chains,
wrong ones called certain, right ones called uncertain, and the margin. One line per condition for the labels: doubted
though right, and swapped on purpose but not named, or not rightly.
"""

import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from core.body import LEG_SITES, Segment, Side, Site
from core.placement.chains import Chains, find_chains
from core.placement.labels import doubted_labels
from core.placement.smoothed_tracks import Tracks
from core.samples import FloatArray, RateKind
from core.session import RecordingKind, Session
from core.signal.sensors import SensorTracks
from devices.simulation.walker import FreeMotion, Motion, SensorErrors, Standing, Tissue, Walk, WalkerSettings, simulate
from tests.driver import options

MAX_LATE_S = 0.03
POOR_SENSORS = SensorErrors(gyro_bias_sd_rad_s=np.deg2rad(1.5), acc_bias_sd_m_s2=0.1)
SEED_OF_LATENESS = 77


def _settings(motion: FreeMotion | Walk, tissue: Tissue, has_standing: bool = True) -> WalkerSettings:
    recordings = (Standing(), motion) if has_standing else (motion,)
    return WalkerSettings(recordings=recordings, tissue=tissue, errors=POOR_SENSORS)


CONDITIONS = {
    "rigid": _settings(FreeMotion(), Tissue.RIGID),
    "soft": _settings(FreeMotion(), Tissue.SOFT),
    "real": _settings(FreeMotion(), Tissue.REAL),
    "rigid, 3 s": _settings(FreeMotion(duration_s=3.0), Tissue.RIGID),
    "soft, 3 s": _settings(FreeMotion(duration_s=3.0), Tissue.SOFT),
    "soft, in turn": _settings(FreeMotion(is_in_turn=True), Tissue.SOFT),
    "soft, weak": _settings(FreeMotion(motion=Motion.WEAK), Tissue.SOFT),
    "soft, sagittal": _settings(FreeMotion(motion=Motion.SAGITTAL), Tissue.SOFT),
    "soft, knee only": _settings(FreeMotion(motion=Motion.KNEE_ONLY), Tissue.SOFT),
    "soft, lying": _settings(FreeMotion(motion=Motion.SIDE_LYING), Tissue.SOFT),
    "soft, no standing": _settings(FreeMotion(), Tissue.SOFT, has_standing=False),
    "soft, lying, no standing": _settings(FreeMotion(motion=Motion.SIDE_LYING), Tissue.SOFT, has_standing=False),
    "rigid walk": _settings(Walk(), Tissue.RIGID),
    "soft walk": _settings(Walk(), Tissue.SOFT),
    "real walk": _settings(Walk(), Tissue.REAL),
    "soft walk, no standing": _settings(Walk(), Tissue.SOFT, has_standing=False),
    "soft walk, prosthesis": replace(_settings(Walk(), Tissue.SOFT), prosthetic_side=Side.LEFT),
}
SEVEN = (*LEG_SITES, Site.PELVIS)
TURNING = Walk(strides=16, turn_rad=np.pi)
CONDITIONS |= {
    f"{name}, pelvis": replace(settings, sites=SEVEN)
    for name, settings in {
        "rigid": CONDITIONS["rigid"],
        "soft": CONDITIONS["soft"],
        "soft, 3 s": CONDITIONS["soft, 3 s"],
        "real": CONDITIONS["real"],
        "soft lunges": _settings(FreeMotion(motion=Motion.LUNGES), Tissue.SOFT),
        "real lunges": _settings(FreeMotion(motion=Motion.LUNGES), Tissue.REAL),
        "soft walk": CONDITIONS["soft walk"],
        "soft walk, turn": _settings(TURNING, Tissue.SOFT),
        "real walk": CONDITIONS["real walk"],
        "real walk, turn": _settings(TURNING, Tissue.REAL),
    }.items()
}

WORN: dict[str, Callable[[Site], bool]] = {
    "six": lambda site: True,
    "one leg": lambda site: site.side is Side.LEFT,
    "two knees": lambda site: site.segment is not Segment.FOOT,
}
SWAPS = (
    (Site.LEFT_THIGH, Site.LEFT_SHANK),
    (Site.LEFT_SHANK, Site.LEFT_FOOT),
    (Site.LEFT_THIGH, Site.LEFT_FOOT),
    (Site.LEFT_THIGH, Site.RIGHT_THIGH),
    (Site.LEFT_SHANK, Site.RIGHT_SHANK),
    (Site.LEFT_FOOT, Site.RIGHT_FOOT),
)
SWAPS_WITH_PELVIS = (
    (Site.PELVIS, Site.LEFT_THIGH),
    (Site.PELVIS, Site.RIGHT_SHANK),
    (Site.PELVIS, Site.LEFT_FOOT),
    (Site.PELVIS, Site.RIGHT_THIGH),
)


def session_of(condition: str, seed: int) -> Session:
    """One patient of a condition, every clock late by a chance of its own."""
    rng = np.random.default_rng([SEED_OF_LATENESS, seed])
    late_s = {site: float(rng.uniform(-MAX_LATE_S, MAX_LATE_S)) for site in Site}
    return simulate(replace(CONDITIONS[condition], seed=seed, clock_late_s=late_s)).session


def tracks_of(session: Session) -> SensorTracks:
    return SensorTracks(session, session.recordings, frozenset(), RateKind.INSTANTANEOUS)


def unlabelled(tracks: SensorTracks) -> tuple[Tracks, dict[str, FloatArray]]:
    """Tracks of the moving recording and specific forces in standing; the names are for scoring."""
    moving = tracks.span[-1]
    block = tracks.blocks(moving)[0]
    standing = {}
    if tracks.span[0].kind is RecordingKind.STANDING:
        rests = {site: tracks.rest(tracks.span[0], site) for site in moving.imu}
        standing = {str(site): rest.acc_m_s2 for site, rest in rests.items() if rest is not None}
    return {str(site): tracks.oriented(moving, site, block) for site in moving.imu}, standing


def is_right(chains: Chains) -> bool:
    """Every sensor on its own segment, every leg of one side; which side is not asked."""
    named = chains.sites(Side.LEFT)
    is_on_segment = all(Site(sensor).segment is site.segment for sensor, site in named.items())
    return is_on_segment and all(
        len({Site(s).side for s in (leg.thigh, leg.shank, leg.foot) if s}) == 1 for leg in chains.legs
    )


@dataclass(frozen=True, slots=True)
class Found:
    is_right: bool
    is_certain: bool
    margin: float
    uprightness: float
    cpu_s: float


def arranged(tracks: Tracks, standing: Mapping[str, FloatArray]) -> Found:
    start_s = time.process_time()
    chains = find_chains(tracks, standing)
    cpu_s = time.process_time() - start_s
    assert chains is not None
    return Found(
        is_right(chains), chains.is_certain, chains.margin, min(leg.stature.uprightness for leg in chains.legs), cpu_s
    )


def doubted(session: Session) -> set[frozenset[str]]:
    """The groups of sites that the labels' check names."""
    return set(map(frozenset, doubted_labels(tracks_of(session)).groups))


def swapped(session: Session, one: Site, other: Site) -> Session:
    """The same samples with two sites exchanged."""
    exchanged = {one: other, other: one}
    recordings = [replace(r, imu={exchanged.get(s, s): b for s, b in r.imu.items()}) for r in session.recordings]
    return replace(session, recordings=tuple(recordings))


def report(condition: str, seeds: range) -> Iterator[str]:
    found: dict[str, list[Found]] = defaultdict(list)
    false_alarms, unnamed, misnamed = 0, 0, 0
    for seed in seeds:
        session = session_of(condition, seed)
        tracks, standing = unlabelled(tracks_of(session))
        has_pelvis = Site.PELVIS in tracks
        for name, is_worn in {"seven": WORN["six"]}.items() if has_pelvis else WORN.items():
            found[name].append(arranged({k: v for k, v in tracks.items() if is_worn(Site(k))}, standing))
        false_alarms += bool(doubted(session))
        swaps = SWAPS_WITH_PELVIS if has_pelvis else SWAPS
        swap = swaps[seed % len(swaps)]
        named = doubted(swapped(session, *swap))
        unnamed += not named
        misnamed += bool(named) and named != {frozenset(map(str, swap))}
    for name, each in found.items():
        wrong = [one for one in each if not one.is_right]
        margin = [one.margin for one in each]
        low, middle = np.quantile(margin, [0.05, 0.5])
        wrongs = f"{len(wrong)} wrong ({sum(one.is_certain for one in wrong)} called certain)"
        timid = f"{sum(one.is_right and not one.is_certain for one in each)} right but uncertain"
        margins = f"margin least {min(margin):.1f}, 5 % {low:.1f}, median {middle:.1f}"
        upright = f"upright least {min(one.uprightness for one in each):.2f}"
        cpu_ms = f"{1000 * np.median([one.cpu_s for one in each]):.0f} ms"
        yield f"{condition:25} {name:9} {len(each):4}: {wrongs}, {timid}, {margins}, {upright}, {cpu_ms}"
    yield (
        f"{condition:25} labels    {len(seeds):4}: {false_alarms} right ones doubted; "
        f"of as many swapped {unnamed} not named, {misnamed} named otherwise"
    )


def main() -> None:
    required = options(
        __doc__,
        seeds=(200, "patients per condition"),
        only={"nargs": "*", "default": list(CONDITIONS), "choices": list(CONDITIONS), "metavar": "CONDITION"},
    )
    for condition in required.only:
        for line in report(condition, range(required.seeds)):
            print(line, flush=True)


if __name__ == "__main__":
    main()
