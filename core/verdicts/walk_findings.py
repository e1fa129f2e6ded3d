"""Findings about the strides of a walk: missing, too few or doubtful ones, and missing peaks."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from core.body import LEG_JOINTS, Segment, Side, Site
from core.findings import Finding, Severity
from core.gait.strides import Reason
from core.hip.results import PelvisTurn
from core.parameters import PEAK_WINDOWS
from core.prosthesis import NOT_STATED, Prostheses
from core.results import RecordingAnalysis, SideGait
from core.timed.found import Turn
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD

QUARTER_TURN_RAD = np.deg2rad(90.0)
TURN_APART_S = 1.0  # feet turn about as much later or earlier than the pelvis


def about_walk(walk: RecordingAnalysis, sites: Mapping[Side, Site | None]) -> list[Finding]:
    """Give what the strides of both sides leave in doubt; `sites` gave each side's events in `walk.gait`."""
    if walk.gait and not any(len(gait.strides) for gait in walk.gait.values()):
        return [Finding("no_strides", Severity.WARNING, walk.name)]
    findings: list[Finding] = []
    for side, gait in walk.gait.items():
        findings += _about_events(f"{walk.name}, {sites[side]}", gait)
        findings += _about_gaps(walk.name, gait)
        findings += _about_peaks(walk, gait)
    return [*findings, *_about_counts(walk)]


def about_prosthesis(recordings: Iterable[RecordingAnalysis]) -> list[Finding]:
    """A prosthetic foot rolls on where a heel would rise: its toe-off is timed by its sole, untried on real ones."""
    late = {
        side
        for recording in recordings
        for side, gait in recording.gait.items()
        if gait.is_toe_off_biased and len(gait.strides)
    }
    return [Finding("prosthetic_toe_off", Severity.INFO, f"{side}_{Segment.FOOT}") for side in Side if side in late]


def about_rigid_feet(worn: Prostheses, recordings: Iterable[RecordingAnalysis]) -> list[Finding]:
    """A foot that is stated to have no joint bends in itself: its angle is the foot's against the shank."""
    ankles = {joint for recording in recordings for joint in recording.joints if not joint.is_knee}
    rigid = [joint for joint in LEG_JOINTS if joint in ankles and worn.get(joint.side, NOT_STATED).has_rigid_foot]
    return [Finding("foot_against_shank", Severity.INFO, str(joint)) for joint in rigid]


def _about_events(where: str, gait: SideGait) -> Iterator[Finding]:
    reasons = Counter(gait.strides.reason)
    if any(events.is_from_shank for events in gait.events):
        yield Finding("events_from_shank", Severity.INFO, where)
    if reasons[Reason.DOUBT]:
        yield Finding("doubtful_strides", Severity.WARNING, where, {"count": reasons[Reason.DOUBT]})
    if not reasons:
        yield Finding("side_without_strides", Severity.WARNING, where)
    elif not reasons[Reason.USED]:
        each = {str(reason): count for reason, count in reasons.most_common()}
        yield Finding("strides_all_left_out", Severity.WARNING, where, {"count": reasons.total(), **each})


def _about_counts(walk: RecordingAnalysis) -> Iterator[Finding]:
    """Sides with some strides, but too few for a mean or for a spread; where both have few it is stated once."""
    used = {side: int(np.count_nonzero(gait.strides.is_used)) for side, gait in walk.gait.items()}
    few = {side: count for side, count in used.items() if MIN_STRIDES_FOR_MEAN <= count < MIN_STRIDES_FOR_SD}
    for side, count in used.items():
        if 0 < count < MIN_STRIDES_FOR_MEAN:
            yield _count("no_mean", Severity.WARNING, walk, side, count, MIN_STRIDES_FOR_MEAN)
        elif side in few and len(few) < len(Side):
            yield _count("no_spread_of_side", Severity.INFO, walk, side, count, MIN_STRIDES_FOR_SD)
    if len(few) == len(Side):
        counts = {str(side): few[side] for side in Side}
        yield Finding("no_spread", Severity.INFO, walk.name, {**counts, "wanted": MIN_STRIDES_FOR_SD})


def _count(key: str, severity: Severity, walk: RecordingAnalysis, side: Side, count: int, required: int) -> Finding:
    return Finding(key, severity, walk.name, {"side": str(side), "count": count, "wanted": required})


def _about_gaps(walk: str, gait: SideGait) -> Iterator[Finding]:
    """Angles with gaps in so many of the strides used that the others make no mean."""
    used = int(np.count_nonzero(gait.strides.is_used))
    for joint, cycles in gait.cycles.items():
        whole = int(np.count_nonzero(gait.strides.is_used & np.isfinite(cycles).all(axis=1)))
        if whole < min(used, MIN_STRIDES_FOR_MEAN):
            numbers = {"count": whole, "used": used, "wanted": MIN_STRIDES_FOR_MEAN}
            yield Finding("angle_without_mean", Severity.WARNING, f"{walk}, {joint}", numbers)


def _about_peaks(walk: RecordingAnalysis, gait: SideGait) -> Iterator[Finding]:
    """Peaks that no stride has, though its angle is known: the angle only passes through the window."""
    for joint, cycles in gait.cycles.items():
        is_known = gait.strides.is_used & np.isfinite(cycles).all(axis=1)
        if np.count_nonzero(is_known) < MIN_STRIDES_FOR_MEAN or not walk.verdicts.joint(joint).sign.is_reported:
            continue
        for window in PEAK_WINDOWS[joint.kind]:
            if not np.isfinite(gait.parameters[f"{window.name}_rad"][is_known]).any():
                yield Finding("no_peak", Severity.INFO, f"{walk.name}, {joint}", {"peak": window.name})


def about_turns(walk: RecordingAnalysis) -> list[Finding]:
    """Give one finding where pelvis and feet of a timed test count other turns; none without a pelvis sensor."""
    test = walk.timed
    if test is None or walk.pelvis is None or not len(walk.time_s) or test.missing:
        return []
    by_pelvis = [turn for turn in walk.turns if test.start_s <= 0.5 * (turn.start_s + turn.end_s) <= test.end_s]
    by_feet = list(test.turns)
    if _has_lone_turn(by_feet, by_pelvis) or _has_lone_turn(by_pelvis, by_feet):
        reported = {"feet": len(by_feet), "pelvis": len(by_pelvis)}
        return [Finding("turns_contradict", Severity.WARNING, walk.name, reported)]
    return []


def _has_lone_turn(one: Sequence[Turn | PelvisTurn], other: Sequence[Turn | PelvisTurn]) -> bool:
    """Whether a turn of a quarter and more has none to the same side at its time."""
    return any(
        abs(turn.angle_rad) >= QUARTER_TURN_RAD
        and not any(
            (a.angle_rad > 0) == (turn.angle_rad > 0)
            and a.start_s < turn.end_s + TURN_APART_S
            and turn.start_s < a.end_s + TURN_APART_S
            for a in other
        )
        for turn in one
    )
