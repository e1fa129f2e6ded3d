"""People, scenes and clocks that the synchronisation of videos is tried on."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from core.body import LEG_SITES, Side
from devices.simulation.walker import (
    PEOPLE,
    CourseKind,
    Manner,
    SimulatedSession,
    Standing,
    TimedCourse,
    Tissue,
    Treadmill,
    Walk,
    WalkerSettings,
    simulate,
)
from devices.simulation.walker_courses import draw_course
from tests.walking_video import Scene, WalkingVideo, render

PEOPLE_BY_NAME = (
    "straight",
    "there and back",
    "up and go",
    "shuffling",
    "hemiparetic",
    "treadmill",
    "very slow",
    "prosthesis",
)
TROUBLES = ("none", "flicker", "passer-by", "shaken", "third lost", "dim", "late start")
VIEWS = ("side", "behind", "oblique", "front")
LIVE_S = (-0.4, 0.0)  # what a webcam's offset is: 30 to 250 ms late, of a telephone up to 450, less what sensors are
BEYOND_S = (-0.9, -0.5)  # of one that is later than what is searched


@dataclass(frozen=True, slots=True)
class VideoCase:
    """One walk and its video. `offset_s` is what has to be found; `is_right` is False of a video of something else."""

    number: int
    person: str
    trouble: str
    view: str
    is_imported: bool
    offset_s: float
    is_right: bool


def draw_case(number: int, *, is_imported: bool) -> VideoCase:
    """Every combination comes in turn. Every tenth person is standing still; every tenth file is of another walk."""
    rng = np.random.default_rng([number, int(is_imported), 5])
    offset_s = float(rng.uniform(-30.0, 30.0) if is_imported else rng.uniform(*LIVE_S))
    person = PEOPLE_BY_NAME[number % len(PEOPLE_BY_NAME)]
    trouble = TROUBLES[(number // 2) % len(TROUBLES)]
    if number % 10 == 9:
        return VideoCase(number, "standing", trouble, VIEWS[number % 4], is_imported, offset_s, is_right=False)
    is_right = not is_imported or number % 10 != 4
    return VideoCase(number, person, trouble, VIEWS[(number // 3) % 4], is_imported, offset_s, is_right)


@cache
def walked(person: str, seed: int) -> SimulatedSession:
    """The person's session, of one recording."""
    rng = np.random.default_rng([seed, 6])
    before_s, after_s = rng.uniform(0.5, 3.0, 2).tolist()
    speed_m_s = float(rng.uniform(0.7, 1.5))
    recording: Standing | Walk | TimedCourse
    match person:
        case "standing":
            recording = Standing(duration_s=15.0)
        case "there and back":
            recording = Walk(
                speed_m_s=speed_m_s,
                strides=8,
                turn_rad=float(np.pi),
                standing_before_s=before_s,
                standing_after_s=after_s,
            )
        case "up and go":
            recording = replace(draw_course(CourseKind.UP_AND_GO, seed), sites=LEG_SITES)
        case "shuffling":
            recording = Walk(
                speed_m_s=0.5, strides=10, manner=Manner.SHUFFLING, standing_before_s=before_s, standing_after_s=after_s
            )
        case "hemiparetic":
            side = list(Side)[int(rng.integers(2))]
            recording = Walk(
                speed_m_s=0.6,
                strides=8,
                manner_of_side={side: Manner.HEMIPARETIC},
                standing_before_s=before_s,
                standing_after_s=after_s,
            )
        case "treadmill":
            recording = Walk(
                speed_m_s=speed_m_s,
                strides=16,
                treadmill=Treadmill(ripple=0.03),
                standing_before_s=before_s,
                standing_after_s=after_s,
            )
        case "very slow":
            recording = Walk(speed_m_s=0.35, strides=7, standing_before_s=before_s, standing_after_s=after_s)
        case _:
            recording = Walk(speed_m_s=speed_m_s, strides=7, standing_before_s=before_s, standing_after_s=after_s)
    prosthetic = Side.RIGHT if person == "prosthesis" else None
    return simulate(
        WalkerSettings(
            seed=seed, tissue=Tissue.REAL, recordings=(recording,), variation=PEOPLE, prosthetic_side=prosthetic
        )
    )


def video_of(case: VideoCase) -> WalkingVideo:
    """The video, stamped by its own clock."""
    rng = np.random.default_rng([case.number, 8])
    moved = walked(
        case.person, case.number if case.is_right or case.person == "standing" else case.number + 1000
    ).moved[0]
    end_s = float(moved.legs[Side.LEFT].time_s[-1])
    scene = Scene(
        case.view,
        case.number,
        is_on_treadmill=case.person == "treadmill",
        contrast=float(rng.uniform(0.35, 0.9)),
        noise=float(rng.uniform(1.0, 5.0)),
        jitter_s=float(rng.uniform(0.0, 0.005)),
    )
    match case.trouble:
        case "flicker":
            scene = replace(scene, flicker=0.06)
        case "passer-by":
            scene = replace(scene, is_passed=True)
        case "shaken":
            scene = replace(scene, shake_m=0.02)
        case "third lost":
            scene = replace(scene, lost=0.33)
        case "dim":
            scene = replace(scene, rate_hz=15.0, noise=8.0, contrast=0.3, exposure_s=0.04)
    from_s, to_s = (rng.uniform(-4.0, 3.0), end_s + rng.uniform(-3.0, 4.0)) if case.is_imported else (0.0, end_s)
    if case.trouble == "late start":
        from_s = max(from_s, 3.0)
    video = render(moved, scene, from_s, to_s)
    return replace(video, time_s=video.time_s - case.offset_s)
