"""How often the gate of the axis halves closes on ankles whose axes jump, and on joints that are sound.

    python -m tests.benchmarks.axis_halves [--seeds 20] [--workers 1]

Sound: people who walk as people do, all tissues. An ankle that hardly moves, under tissue as loose as real one, jumps
where its walk, cut in two sessions that are analysed by themselves, gives axes of more than 25 deg apart; with a free
motion, where the axes in use are so far from the true one. Neither asks the gate. Required: of the jumping ankles 95 %
gated, of the sound joints under 3 %.
"""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import numpy as np

from core.analysis import analyse
from core.body import Joint
from core.results import Analysis, JointCalibration
from core.samples import FloatArray
from core.session import Session
from core.signal.rotations import angle_between
from devices.simulation.walker import (
    PEOPLE,
    FreeMotion,
    Manner,
    SimulatedSession,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)
from devices.simulation.walker_truth import JointTruth
from tests.benchmarks.cuts import cut
from tests.driver import options

JUMP_DEG = 25.0
LOOSE = (Tissue.REAL,)  # without tissue the axes of an ankle are steady, if not its own
GATES = ("axis_halves", "axis_motions")
WALK = Walk(strides=16)
SOUND = {"ordinary": WALK, "slow": replace(WALK, speed_m_s=0.6)}
HARDLY_MOVING = {f"stiff, {v} m/s": replace(WALK, speed_m_s=v, manner=Manner.STIFF) for v in (0.6, 1.0)}
BEFORE = {"walking alone": (Standing(),), "free motion": (Standing(), FreeMotion())}


@dataclass(frozen=True, slots=True)
class Judged:
    """One joint of one walk, degrees: how far its parts' axes are apart, what the gate makes of it, and the truth."""

    joint: Joint
    apart_deg: float
    verdict: str
    jump_deg: float
    axis_error_deg: float
    range_error_deg: float
    spread_deg: float


def judged(settings: WalkerSettings, has_jumps: bool) -> list[Judged]:
    """Every joint of the walk of one session."""
    made = simulate(settings)
    analysis = analyse(made.session)
    walk = analysis.recordings[-1]
    jumps = jumps_deg(made.session) if has_jumps else {}
    found = []
    for joint, halves in walk.axis_halves.items():
        closed = [reason for reason in walk.verdicts.joint(joint).shape.reasons if reason.gate in GATES]
        found.append(
            Judged(
                joint,
                float(np.rad2deg(halves.apart_rad)),
                str(closed[0].verdict) if closed else "read",
                jumps.get(joint, np.nan),
                axis_error_deg(made, analysis, joint),
                range_error_deg(made, analysis, joint),
                float(np.rad2deg(halves.spread.get(f"{joint.kind}_range_rad", np.nan))),
            )
        )
    return found


def jumps_deg(session: Session) -> dict[Joint, float]:
    """How far apart the axes are that both halves of the last walk have as sessions of their own."""
    both = cut(session, 2)
    *before, first, second = both.recordings
    one, other = (analyse(replace(both, recordings=(*before, half))).calibrations[0].joints for half in (first, second))
    return {joint: axes_apart_deg(one[joint], other[joint]) for joint in one if joint in other}


def axes_apart_deg(one: JointCalibration, other: JointCalibration | JointTruth) -> float:
    """Of the sensor at which it is more."""
    proximal = lines_apart_deg(one.axis_proximal, other.axis_proximal)
    return max(proximal, lines_apart_deg(one.axis_distal, other.axis_distal))


def axis_error_deg(made: SimulatedSession, analysis: Analysis, joint: Joint) -> float:
    walk = analysis.recordings[-1]
    return axes_apart_deg(analysis.calibrated_for(walk)[joint], made.truth.recordings[walk.name].joints[joint])


def lines_apart_deg(one: FloatArray, two: FloatArray) -> float:
    angle = angle_between(one, two)
    return float(np.rad2deg(min(angle, np.pi - angle)))


def range_error_deg(made: SimulatedSession, analysis: Analysis, joint: Joint) -> float:
    walk = analysis.recordings[-1]
    gait, truth = walk.gait[joint.side], made.truth.recordings[walk.name].joints[joint]
    used = gait.strides.is_used
    true = [
        float(np.ptp(truth.angle_rad[(truth.time_s >= start) & (truth.time_s <= end)]))
        for start, end in zip(gait.strides.start_s[used], gait.strides.end_s[used], strict=True)
    ]
    return float(np.rad2deg(np.mean(gait.parameters[f"{joint.kind}_range_rad"][used]) - np.mean(true)))


def of_seed(seed: int, tissue: Tissue, walk: Walk, before: str, has_jumps: bool = False) -> list[Judged]:
    """All joints of one session."""
    recordings = (*BEFORE[before], walk)
    return judged(WalkerSettings(seed=seed, tissue=tissue, recordings=recordings, variation=PEOPLE), has_jumps)


def line(name: str, found: list[Judged]) -> str:
    apart = np.array([one.apart_deg for one in found] or [np.nan])
    care, withheld = (sum(one.verdict == verdict for one in found) for verdict in ("care", "withheld"))
    error = float(np.sqrt(np.mean([one.range_error_deg**2 for one in found]))) if found else np.nan
    share = 100.0 * (care + withheld) / max(len(found), 1)
    return (
        f"| {name} | {len(found)} | {np.median(apart):.1f} | {apart.max():.1f} | {care} | {withheld} | {share:.0f} % |"
        f" {error:.1f} |"
    )


def lines(pool: ProcessPoolExecutor, seeds: range) -> Iterator[str]:
    yield "| walks | joints | apart, median | most | care | withheld | gated | range error, rms |"
    for before in BEFORE:
        for name, walk in SOUND.items():
            for tissue in Tissue:
                found = list(pool.map(partial(of_seed, tissue=tissue, walk=walk, before=before), seeds))
                for kind in ("knee", "ankle"):
                    some = [one for of_one in found for one in of_one if one.joint.kind == kind]
                    yield line(f"sound: {name}, {tissue}, {kind}, {before}", some)
    for before in BEFORE:
        is_free = before != "walking alone"
        for (name, walk), tissue in product(HARDLY_MOVING.items(), (Tissue.RIGID, Tissue.REAL) if is_free else LOOSE):
            one = partial(of_seed, tissue=tissue, walk=walk, before=before, has_jumps=not is_free)
            found = list(pool.map(one, seeds))
            ankles = [one for of_one in found for one in of_one if not one.joint.is_knee]
            off = [one.axis_error_deg if is_free else one.jump_deg for one in ankles]
            jumping = [one for one, deg in zip(ankles, off, strict=True) if deg > JUMP_DEG]
            steady = [one for one, deg in zip(ankles, off, strict=True) if not deg > JUMP_DEG]
            yield line(f"jumping: {name}, {tissue}, {before}", jumping)
            yield line(f"hardly moving, axes within {JUMP_DEG:.0f} deg: {name}, {tissue}, {before}", steady)


def main() -> None:
    required = options(__doc__, seeds=20, first=0, workers=1)
    with ProcessPoolExecutor(required.workers) as pool:
        for one in lines(pool, range(required.first, required.first + required.seeds)):
            print(one, flush=True)


if __name__ == "__main__":
    main()
