"""Curves of a log that may be looked at, and their meaning. Where each lies, by what may be stated about its joint.

A curve with a height lies at `/angles`. One without a zero is reported as its shape, its mean taken away. One that is
not reported, or whose sign is not known, lies at `/withheld`, which no view of the layout shows: it is there to be
looked for. The same holds of every angle once a strap of its leg has slipped.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from enum import StrEnum
from itertools import groupby

import numpy as np

from app.summary.status import all_that_is_stated, why
from app.wording.translation import PURPOSE
from core.body import Joint, JointKind, Side
from core.results import Analysis, RecordingAnalysis
from core.samples import BoolArray, FloatArray
from core.session import RecordingKind
from core.verdicts.status import NO_ZERO, WITH_HEIGHT, is_slipped, joint_status


class Place(StrEnum):
    """Where a curve lies, and what its name states about it."""

    HEIGHT = ""
    SHAPE = ", shape"
    NOT_REPORTED = ", withheld"

    def entity(self, joint: Joint, curve: str) -> str:
        if self is Place.NOT_REPORTED:
            return f"/withheld/{joint}/{curve}"
        return f"/angles/{joint}/{curve}_shape" if self is Place.SHAPE else f"/angles/{joint}/{curve}"


def place_of(recording: RecordingAnalysis, joint: Joint) -> Place:
    """Where a joint's curves lie as long as no strap slipped."""
    status = joint_status(recording, joint)
    if status in WITH_HEIGHT:
        return Place.HEIGHT
    return Place.SHAPE if status == NO_ZERO else Place.NOT_REPORTED


def pieces_of(recording: RecordingAnalysis, joint: Joint) -> Iterator[tuple[Place, slice]]:
    """The rows of a recording by where the joint's curves lie over them, in order of time."""
    n, slipped = len(recording.time_s), is_slipped(recording, joint.side)
    end = int(np.argmax(slipped)) if slipped.any() else n
    if end or not n:
        yield place_of(recording, joint), slice(0, end)
    if end < n:
        yield Place.NOT_REPORTED, slice(end, n)


def shown_deg(place: Place, values_rad: FloatArray) -> FloatArray:
    """A piece in degrees as it is shown: a shape has its mean taken away."""
    values_deg = np.rad2deg(values_rad)
    is_lowered = place is Place.SHAPE and np.isfinite(values_deg).any()
    return np.asarray(values_deg - np.nanmean(values_deg)) if is_lowered else values_deg


def places(analysis: Analysis, joint: Joint) -> list[Place]:
    """Where curves of a joint lie in any recording."""
    used = {p for r in analysis.recordings if joint in r.measured for p, _ in pieces_of(r, joint)}
    return [place for place in Place if place in used]


def is_pose(recording: RecordingAnalysis, joint: Joint, time_s: FloatArray) -> BoolArray:
    """At which instants (n,) the joint's angle is what a leg may be drawn by: with its height, before a strap slips."""
    has_height = joint_status(recording, joint) in WITH_HEIGHT
    return has_height & (time_s < recording.slipped_from_s.get(joint.side, np.inf))


def name_of_view(analysis: Analysis, joint: Joint) -> str:
    """What is shown above a joint's curves: its name, and what is missing where no walk has more."""
    walks = tuple(r for r in analysis.recordings if r.kind is RecordingKind.WALKING and joint in r.measured)
    found = places(replace(analysis, recordings=walks or analysis.recordings), joint)
    name = joint.replace("_", " ")
    if Place.HEIGHT in found:
        return f"{name}: {'dorsiflexion' if joint.kind is JointKind.ANKLE else 'flexion'}, °"
    return f"{name}: shape, no standing reference, °" if Place.SHAPE in found else f"{name}: not reported"


def document(analysis: Analysis, timelines: Mapping[str, str]) -> str:
    """Give every verdict with reasons as Markdown, a table per recording named as its timeline, walks first."""
    lines = ["# Data quality", "", PURPOSE]
    walks = {recording.name for recording in analysis.recordings if recording.kind is RecordingKind.WALKING}
    in_order = sorted(all_that_is_stated(analysis), key=lambda one: one.recording not in walks)
    for recording, stated in groupby(in_order, key=lambda one: one.recording):
        lines += ["", f"## {timelines[recording]}", "", "| of | what | verdict | why |", "|---|---|---|---|"]
        for one in stated:
            verdict = one.assessment.verdict.replace("_", " ")
            lines.append(f"| {one.subject} | {one.quantity} | {verdict} | {why(one.assessment)} |")
    slipped = [side for side in Side if any(is_slipped(r, side).any() for r in analysis.recordings)]
    lines += ["", *(f"Strap moved on the {side} leg: from then on its curves are not reported." for side in slipped)]
    return "\n".join([*lines, "", "Curves not reported lie under `/withheld`, grey, in no view until added to one."])
