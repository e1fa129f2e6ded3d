"""Strides that a person left out: they leave every mean and every count, and their number is stated.

This comes after all else: nothing is identified or measured from chosen strides, so a choice costs no new analysis.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.body import Segment, Side, Site
from core.findings import Finding, Severity
from core.gait.strides import Reason
from core.results import Analysis, RecordingAnalysis, SideGait
from core.session import Recording
from core.verdicts.gates import judged
from core.verdicts.walk_findings import about_walk


def leave_out(analysis: Analysis, recordings: Sequence[Recording]) -> Analysis:
    """Give the analysis without the strides that `recordings` leave out; none may have been left out of it before."""
    chosen = {recording.name: recording.left_out_s for recording in recordings if any(recording.left_out_s.values())}
    if not chosen:
        return analysis
    walks = tuple(
        replace(walk, gait={s: _without(g, chosen.get(walk.name, {}).get(s, ())) for s, g in walk.gait.items()})
        for walk in analysis.recordings
    )
    left = judged(replace(analysis, recordings=walks))
    findings = list(analysis.findings)
    for walk, found in zip(analysis.recordings, left.recordings, strict=True):
        noticed = [
            Finding(
                "strides_left_out_by_hand",
                Severity.INFO,
                walk.name,
                {"side": str(side), "count": count, "of": len(gait.strides)},
            )
            for side, gait in found.gait.items()
            if (count := left_out_by_hand(gait))
        ]
        if noticed:
            before, after = about_walk(walk, _sites(walk)), about_walk(found, _sites(walk))
            findings = [finding for finding in findings if finding not in before or finding in after]
            findings += [finding for finding in after if finding not in findings]
            findings += noticed
    return replace(left, findings=tuple(findings))


def left_out_by_hand(gait: SideGait) -> int:
    """How many strides a person has left out."""
    return int(np.count_nonzero([reason is Reason.BY_HAND for reason in gait.strides.reason]))


def _without(gait: SideGait, times_s: Sequence[float]) -> SideGait:
    return replace(gait, strides=gait.strides.left_out_at(times_s)) if times_s else gait


def _sites(walk: RecordingAnalysis) -> dict[Side, Site | None]:
    """Which sensor gave each side's events, as the events themselves name it."""
    return {
        side: Site(f"{side}_{Segment.SHANK if any(e.is_from_shank for e in gait.events) else Segment.FOOT}")
        for side, gait in walk.gait.items()
    }
