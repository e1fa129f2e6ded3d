"""Sessions of the simulated patient with a sensor on the pelvis, and what is true of their hips."""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from core.analysis import analyse
from core.body import LEG_SITES, Joint, Side, Site, hip_of
from core.results import Analysis, RecordingAnalysis
from core.samples import FloatArray
from core.session import RecordingKind
from core.verdicts.gates import judged
from devices.simulation.walker import (
    FreeMotion,
    Motion,
    SimulatedSession,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)
from devices.simulation.walker_pelvis import HipTruth, hip_truth

SEVEN = (*LEG_SITES, Site.PELVIS)
RIGHT = tuple(site for site in LEG_SITES if site.side is Side.RIGHT)
TURNING = (Standing(), FreeMotion(motion=Motion.LUNGES), Walk(strides=22, turn_rad=np.pi))


def settings(seed: int = 1, tissue: Tissue = Tissue.RIGID, late_s: float = 0.0) -> WalkerSettings:
    """Seven sensors, a walk of 25 s with a turn; with `late_s` a clock per leg, the right one late."""
    clocks = {**dict.fromkeys(LEG_SITES, 0.0), Site.PELVIS: 0.0, **dict.fromkeys(RIGHT, late_s)} if late_s else {}
    return WalkerSettings(seed=seed, sites=SEVEN, tissue=tissue, recordings=TURNING, clock_late_s=clocks)


@lru_cache(maxsize=8)
def analysed(seed: int = 1, tissue: Tissue = Tissue.RIGID, late_s: float = 0.0) -> tuple[SimulatedSession, Analysis]:
    """One of them, analysed."""
    made = simulate(settings(seed, tissue, late_s))
    return made, analyse(made.session)


def walk_of(analysis: Analysis) -> RecordingAnalysis:
    """The only walk."""
    return analysis.recordings[-1]


def rewalked(analysis: Analysis, change: Callable[[RecordingAnalysis], RecordingAnalysis]) -> Analysis:
    """With every walk changed, and judged again."""
    walks = tuple(change(one) if one.kind is RecordingKind.WALKING else one for one in analysis.recordings)
    return judged(replace(analysis, recordings=walks))


def with_hip(analysis: Analysis, *joints: Joint, **change: Any) -> Analysis:
    """With what was identified of some hips changed, and judged again."""

    def changed(walk: RecordingAnalysis) -> RecordingAnalysis:
        hips = {
            joint: replace(hip, identification=replace(hip.identification, **change)) if joint in joints else hip
            for joint, hip in walk.hips.items()
        }
        return replace(walk, hips=hips)

    return rewalked(analysis, changed)


def truth(made: SimulatedSession, side: Side, recording: int = -1, late_s: float = 0.0) -> HipTruth:
    """What is true of one hip in a recording, zero as in the session's standing."""
    stood, moved = made.moved[0], made.moved[recording]
    assert stood.pelvis is not None
    assert moved.pelvis is not None
    zero = stood.pelvis, stood.legs[side]
    late = dict.fromkeys(RIGHT, late_s)
    found = hip_truth(moved.pelvis, zero, moved.legs[side], side, moved.mountings, moved.clocks, late)
    # on the left thigh's clock, which is on time
    return replace(found, time_s=found.time_s - (late_s if side is Side.RIGHT else 0.0))


def flexion_error_deg(walk: RecordingAnalysis, known: HipTruth, side: Side) -> FloatArray:
    """Flexion less the truth (n,), where it is known."""
    error = walk.hips[hip_of(side)].angle_rad - np.interp(walk.time_s, known.time_s, known.flexion_rad)
    return np.rad2deg(error[np.isfinite(error)])


def abduction_error_deg(walk: RecordingAnalysis, known: HipTruth, side: Side) -> FloatArray:
    """Abduction less the truth (n,), where it is known."""
    error = walk.hips[hip_of(side)].abduction_rad - np.interp(walk.time_s, known.time_s, known.abduction_rad)
    return np.rad2deg(error[np.isfinite(error)])
