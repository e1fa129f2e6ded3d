"""A clip with the walk that it is of, and what is shown of both at a time: frame, values, stride."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.charts.axes import angle_in_words
from app.summary.request import AnalysedVisit
from app.video.player import ValueTag
from app.wording.translation import tr
from core.body import JointKind, Side
from core.results import RecordingAnalysis
from core.video.clip import Clip
from core.video.key_frames import value_deg

KINDS = (JointKind.KNEE, JointKind.ANKLE)


@dataclass(frozen=True, slots=True)
class ClipsOfVisit:
    """Clips of another visit of the patient; `called` as it is offered: "3 November"."""

    called: str
    visit: AnalysedVisit
    clips: Sequence[Clip]


def is_same_session(one: AnalysedVisit, other: AnalysedVisit) -> bool:
    """Whether both are of one session, which may have gone on meanwhile."""
    return one.session is other.session or (
        (one.session.started, one.session.patient.code) == (other.session.started, other.session.patient.code)
    )


@dataclass(frozen=True, slots=True)
class ShownClip:
    """A clip with the walk that it is of, and how that is called."""

    clip: Clip
    walk: RecordingAnalysis
    called: str

    @property
    def view(self) -> str:
        """What was entered of where the camera is, else its number."""
        return self.clip.view or tr("camera {number}").format(number=self.clip.camera)

    @property
    def what(self) -> str:
        return f"{self.called} · {self.view}"


def clips_of_walk(visit: AnalysedVisit, clips: Sequence[Clip], name: str) -> list[ShownClip]:
    """Those of one walk of a visit, by camera."""
    walk, called = visit.walk(name), str(visit.shown_names.get(name, name))
    own = sorted((clip for clip in clips if clip.recording == name), key=lambda clip: clip.camera)
    return [ShownClip(clip, walk, called) for clip in own]


def clips_beside(
    visit: AnalysedVisit, clips: Sequence[Clip], name: str, others: Sequence[ClipsOfVisit]
) -> list[tuple[str, ShownClip]]:
    """Those of other walks and of other visits, as each is offered; one that is not synchronised has no stride."""
    found = [one for other in visit.walk_names() if other != name for one in clips_of_walk(visit, clips, other)]
    offered = [(one.called, one) for one in found if one.clip.sync is not None]
    for earlier in others:
        names = earlier.visit.walk_names()
        found = [one for walk in names for one in clips_of_walk(earlier.visit, earlier.clips, walk)]
        dated = [replace(one, called=f"{earlier.called}, {one.called}") for one in found if one.clip.sync is not None]
        offered += [(one.called if len(dated) > 1 else earlier.called, one) for one in dated]
    return offered


def has_heights(walk: RecordingAnalysis, kind: JointKind) -> bool:
    """Whether each curve that is drawn of a kind of joint has absolute angles; else all are drawn about their mean."""
    verdicts = [walk.verdicts.joint(joint) for side in Side if (joint := kind.of(side)) in walk.joints]
    return all(one.height.is_reported for one in verdicts if one.shape.is_reported)


def values_at(walk: RecordingAnalysis, time_s: float) -> list[ValueTag]:
    """Knee and ankle of both legs, as the curves have them; none that is not reported."""
    words = {JointKind.KNEE: tr("knee {angle}"), JointKind.ANKLE: tr("ankle {angle}")}
    return [
        ValueTag(side, words[kind].format(angle=f"{angle_in_words(value)}°"))
        for side in Side
        for kind in KINDS
        if has_heights(walk, kind) and (value := value_deg(walk, kind.of(side), time_s)) is not None
    ]


def stride_at(walk: RecordingAnalysis, side: Side, time_s: float) -> tuple[float, float] | None:
    """Start and end of the stride of a leg that a time is in; None between strides."""
    gait = walk.gait.get(side)
    if gait is None:
        return None
    found = np.flatnonzero((gait.strides.start_s <= time_s) & (time_s < gait.strides.end_s))
    return (float(gait.strides.start_s[found[0]]), float(gait.strides.end_s[found[0]])) if len(found) else None
