"""Visits of which every figure is known, for the course of a patient over them."""

from dataclasses import replace

import numpy as np

from app.summary.course import Course, course_of
from core.body import Joint, Side
from core.results import Analysis, Calibration, Method, RecordingAnalysis, SideGait
from core.session import Recording
from core.timed.protocols import TimedProtocol
from tests.core.timed.built_tests import built_test
from tests.core.verdicts.built_walk import Reported, calibrations, each, judged_walk, leg, walk

STRIDE_S = 1.1


def walked(
    name: str = "walk 1",
    *,
    knee_deg: float = 50.0,
    speed_m_s: float = 1.0,
    stance_percent: float = 60.0,
    strides: int = 12,
    reported: Reported | None = None,
) -> RecordingAnalysis:
    """A judged walk: the left knee bends by `knee_deg` from stance to swing, the right by 60; the right stance is 60 %.

    `stance_percent` is the left leg's, `strides` those of each leg.
    """
    length_m = speed_m_s * STRIDE_S
    left = leg(Side.LEFT, strides, length_m=length_m, stance_percent=stance_percent, time_s=STRIDE_S)
    right = leg(Side.RIGHT, strides, length_m=length_m, time_s=STRIDE_S)
    gait = walk(left=_with_knee(left, knee_deg), right=_with_knee(right, 60.0))
    return judged_walk(replace(gait, name=name), reported)


def timed(
    protocol: TimedProtocol,
    *,
    time_s: float = 10.0,
    distance_m: float = 10.0,
    name: str = "walk 9",
    is_end_by_key: bool = False,
    reported: Reported | None = None,
) -> RecordingAnalysis:
    """A walk that is a timed test; from a chair alone it has no stride."""
    found = built_test(protocol, time_s=time_s, distance_m=distance_m, is_end_by_key=is_end_by_key)
    made = replace(walked(name, reported=reported), timed=found)
    return replace(made, gait={}) if protocol is TimedProtocol.SIT_TO_STAND else made


def course(
    *walks: tuple[RecordingAnalysis, str], affected: Side | None = Side.LEFT, reported: Reported | None = None
) -> Course:
    """The course of a visit with these walks, each with its condition."""
    return course_of(analysis(*(one for one, _ in walks), affected=affected, reported=reported), recordings(*walks))


def analysis(
    *walks: RecordingAnalysis, affected: Side | None = Side.LEFT, reported: Reported | None = None
) -> Analysis:
    calibration = Calibration(tuple(one.name for one in walks), dict(reported or calibrations()))
    return Analysis(Method.ROBUST, True, (calibration,), walks, affected_side=affected)


def recordings(*walks: tuple[RecordingAnalysis, str]) -> list[Recording]:
    return [Recording(one.name, one.kind, one.folder, {}, condition=stated) for one, stated in walks]


def unsure(joint: Joint) -> Reported:
    """Calibrations that withhold all of one joint."""
    return calibrations(joint, axis_sd_rad=None)


def _with_knee(gait: SideGait, knee_deg: float) -> SideGait:
    n = len(gait.strides)
    knee_rad = np.deg2rad(each(knee_deg, n) + 0.5 * (np.arange(n) % 2 - 0.5))
    return replace(gait, parameters={**gait.parameters, "knee_stance_to_swing_rad": knee_rad})
