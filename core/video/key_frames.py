"""Key frames of a walk: one typical stride of a leg at initial contact, mid-stance, toe-off and mid-swing."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from core.body import Joint, Side, ankle_of, knee_of
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.video.clip import Clip


class KeyMoment(StrEnum):
    INITIAL_CONTACT = "initial_contact"
    MID_STANCE = "mid_stance"
    TOE_OFF = "toe_off"
    MID_SWING = "mid_swing"


@dataclass(frozen=True, slots=True)
class KeyFrame:
    """A frame and what was measured at its moment; an angle is None where none is reported."""

    jpeg: bytes
    width: int
    height: int
    moment: KeyMoment
    side: Side
    percent: float
    knee_deg: float | None
    ankle_deg: float | None


def key_frames(clip: Clip, recording: RecordingAnalysis, affected: Side | None) -> tuple[KeyFrame, ...]:
    """The four moments of the most typical stride of the affected leg, else of each leg, left before right.

    Mid-stance is halfway from contact to toe-off, mid-swing halfway from toe-off to the next contact.

    Parameters
    ----------
    clip
        Of this walk.
    recording
        The walk.
    affected
        The only leg to show; None: both.

    Returns
    -------
    tuple of KeyFrame
        Empty where the clip's times are not certain, or no used stride lies within the clip.

    Raises
    ------
    OSError
        A frame is damaged.
    """
    if not clip.is_synchronised:
        return ()
    sides = [side for side in Side if side in recording.gait and affected in (None, side)]
    return tuple(frame for side in sides for frame in _frames(clip, recording, side))


def value_deg(recording: RecordingAnalysis, joint: Joint, time_s: float) -> float | None:
    """A joint's angle at a time, between the samples beside it; None where it is not known or not reported."""
    if joint not in recording.joints or not recording.verdicts.joint(joint).height.is_reported:
        return None
    times = recording.time_s
    if not len(times) or not times[0] <= time_s <= times[-1]:
        return None
    value = float(np.interp(time_s, times, recording.joints[joint].angle_rad))
    return math.degrees(value) if math.isfinite(value) else None


def _frames(clip: Clip, recording: RecordingAnalysis, side: Side) -> Iterable[KeyFrame]:
    strides = recording.gait[side].strides
    for number in _by_likeness(recording, side):
        start_s, toe_off_s, end_s = (
            float(times[number]) for times in (strides.start_s, strides.toe_off_s, strides.end_s)
        )
        at = (start_s, (start_s + toe_off_s) / 2, toe_off_s, (toe_off_s + end_s) / 2)
        frames = [clip.frame_at(time_s) for time_s in at]
        if None in frames:
            continue
        return [
            KeyFrame(
                jpeg=clip.pictures.jpeg(frame),
                width=clip.width,
                height=clip.height,
                moment=moment,
                side=side,
                percent=100.0 * (time_s - start_s) / (end_s - start_s),
                knee_deg=value_deg(recording, knee_of(side), time_s),
                ankle_deg=value_deg(recording, ankle_of(side), time_s),
            )
            for moment, time_s, frame in zip(KeyMoment, at, frames, strict=True)
            if frame is not None
        ]
    return []


def _by_likeness(recording: RecordingAnalysis, side: Side) -> list[int]:
    """Numbers of the used strides, the one nearest to the mean curves first; without curves, as they were walked."""
    gait = recording.gait[side]
    used = np.flatnonzero(gait.strides.is_used & np.isfinite(gait.strides.toe_off_s))
    off: FloatArray = np.zeros(len(used))
    for curves in (gait.cycles[joint][used] for joint in (knee_of(side), ankle_of(side)) if joint in gait.cycles):
        is_known = np.isfinite(curves).all(axis=1)
        if is_known.any():
            apart = ((curves - curves[is_known].mean(axis=0)) ** 2).mean(axis=1)
            off = off + np.where(is_known, apart, np.inf)
    return [int(number) for number in used[np.argsort(off, kind="stable")]]
