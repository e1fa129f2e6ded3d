"""Match each trial of a reference with its walk, and compute what both differ by.

A trial named as a walk is that walk's. Else every trial is tried on every walk, by the rates of all joints, and the
best fits go first. No instant of a reference is used for two walks: a trial of a walk that was not kept is left over.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path

import numpy as np

from app.wording.recordings import shown_names
from app.wording.translation import later
from core.agreement.clock import APART_S, MIN_OVERLAP_S, Alignment, FoundOffset, Misfit, align, find_offset
from core.agreement.curves import ComparedTrial, TimedAngle, angle_at
from core.agreement.events import (
    EventAgreement,
    EventKey,
    Events,
    compare_events,
    compare_lengths,
    event_offset,
    joined,
)
from core.agreement.figures import Agreement, AgreementOverWalks, agreement_of, over_walks
from core.body import Joint, Side
from core.hip.results import HipAngle
from core.results import Analysis, JointAngle, RecordingAnalysis, ZeroKind
from core.samples import BoolArray, FloatArray, IntArray
from core.session import Recording, RecordingKind
from devices.files.references.trial import EVENTS, ReferenceFile, ReferenceTrial
from devices.files.refusal import FileRefusedError


class AngleKind(StrEnum):
    """Which of our angles is compared: the result, eq (15), or eq (10) of the sensors' orientations."""

    RESULT = "result"
    PUBLISHED = "published"
    ORIENTATION = "orientation"


CLEARLY = 1.1  # of the score: a leg is like itself with 0.99 and more, like the other with 0.97 and less

JointAndKind = tuple[Joint, AngleKind]


@dataclass(frozen=True, slots=True)
class NamedTrial:
    """A trial and the file that it is from."""

    file: str
    source: str
    trial: ReferenceTrial

    @property
    def names(self) -> set[str]:
        """What it may be called by: its own name, else its file's."""
        return {self.trial.name} if self.trial.name else {Path(self.file).stem}


@dataclass(frozen=True, slots=True)
class UsedSamples:
    """How many of a walk's samples of one joint a comparison uses, and why it does not use the others."""

    recorded: int
    used: int
    outside: int
    after_slip: int

    @property
    def in_gaps(self) -> int:
        """Those that one of both systems has not."""
        return self.recorded - self.used - self.outside - self.after_slip


@dataclass(frozen=True, slots=True)
class ComparedWalk:
    """One walk beside its reference. `reference_rad` (n,) by joint, at the walk's instants and in its sign.

    `reference`, `alignment`: of the trial that fits best; `more`: of other trials of other times of this walk.
    `is_exchanged`: the reference fits clearly better with left and right exchanged.
    """

    recording: RecordingAnalysis
    reference: NamedTrial | None
    alignment: Alignment | None
    more: tuple[tuple[NamedTrial, Alignment], ...] = ()
    used: Mapping[Joint, UsedSamples] = field(default_factory=dict)
    reference_rad: Mapping[Joint, FloatArray] = field(default_factory=dict)
    figures: Mapping[JointAndKind, Agreement] = field(default_factory=dict)
    events: Mapping[EventKey, EventAgreement] = field(default_factory=dict)
    events_later_s: float = 0.0
    lengths_m: Mapping[Side, FloatArray] = field(default_factory=dict)
    is_exchanged: bool = False

    @property
    def trials(self) -> tuple[tuple[NamedTrial, Alignment], ...]:
        """Every trial whose angles are compared."""
        if self.reference is None or self.alignment is None:
            return ()
        return ((self.reference, self.alignment), *self.more)


@dataclass(frozen=True, slots=True)
class AgreementStudy:
    """All walks of a session that a reference covers; `left_over` are trials and walks that found no partner."""

    walks: tuple[ComparedWalk, ...]
    left_over: tuple[str, ...]
    is_simulated: bool

    @property
    def joints(self) -> tuple[Joint, ...]:
        return tuple(joint for joint in Joint if any((joint, AngleKind.RESULT) in walk.figures for walk in self.walks))

    @property
    def with_angles(self) -> tuple[ComparedWalk, ...]:
        return tuple(walk for walk in self.walks if walk.figures)

    def over_walks(self, joint: Joint, kind: AngleKind = AngleKind.RESULT) -> AgreementOverWalks | None:
        return over_walks([walk.figures[joint, kind] for walk in self.walks if (joint, kind) in walk.figures])


def as_shown(study: AgreementStudy, recordings: Sequence[Recording]) -> AgreementStudy:
    """Rename the study's walks as on screen and paper; `recordings` are in time order."""
    names = {name: str(shown) for name, shown in shown_names(recordings).items()}
    walks = tuple(
        replace(walk, recording=replace(walk.recording, name=names.get(walk.recording.name, walk.recording.name)))
        for walk in study.walks
    )
    return replace(study, walks=walks, left_over=tuple(names.get(name, name) for name in study.left_over))


def study_of(analysis: Analysis, files: Sequence[tuple[str, ReferenceFile]]) -> AgreementStudy:
    """Compare walks (else other recordings) with named references; raises FileRefusedError if none fits."""
    trials = [NamedTrial(name, file.source, trial) for name, file in files for trial in file.trials]
    walks = [one for one in analysis.recordings if one.kind is RecordingKind.WALKING] or list(analysis.recordings)
    if not walks:
        raise FileRefusedError("SESSION", "it contains no walk to compare", "Record a walk first")
    with_angles = [one for one in trials if one.trial.angles]
    pairs, misfits = _paired(walks, with_angles)
    order = sorted(pairs, key=lambda pair: (pair[0], -pairs[pair].score))
    aligned = align([_trial(walks[w], with_angles[t]) for w, t in order], [pairs[p] for p in order])
    of_walks: dict[int, list[tuple[NamedTrial, Alignment]]] = {}
    for (w, t), alignment in zip(order, aligned, strict=True):
        of_walks.setdefault(w, []).append((with_angles[t], alignment))
    compared: dict[int, ComparedWalk] = {
        w: replace(
            _angles_compared(analysis, walks[w], trials_of_walk),
            is_exchanged=any(_is_exchanged(walks[w], with_angles[t], fit) for (v, t), fit in pairs.items() if v == w),
        )
        for w, trials_of_walk in of_walks.items()
    }
    for one in trials:
        for w, found in _events_compared(walks, compared, one):
            compared[w] = found
    if not compared:
        raise _refusal(walks, trials, misfits)
    used = {id(trial) for walk in compared.values() for trial in (walk.reference, *(one for one, _ in walk.more))}
    left = [f"{one.file}{', ' * bool(one.trial.name)}{one.trial.name}" for one in with_angles if id(one) not in used]
    left += [walk.name for w, walk in enumerate(walks) if w not in compared]
    is_simulated = analysis.is_simulated or any(file.is_simulated for _, file in files)
    return AgreementStudy(tuple(compared[w] for w in sorted(compared)), tuple(left), is_simulated)


def _paired(
    walks: Sequence[RecordingAnalysis], trials: Sequence[NamedTrial]
) -> tuple[dict[tuple[int, int], FoundOffset], list[Misfit]]:
    """Walks and trials that belong together by their indices, and why the others do not."""
    called = [{walk.name, walk.folder} for walk in walks]
    found: dict[tuple[int, int], FoundOffset] = {}
    misfits = []
    for t, trial in enumerate(trials):
        own = [w for w, names in enumerate(called) if names & trial.names]
        for w in own or range(len(walks)):
            fit = find_offset(_trial(walks[w], trial))
            if isinstance(fit, Misfit):
                misfits.append(fit)
            else:
                found[w, t] = fit
    taken: dict[tuple[int, int], FoundOffset] = {}
    for (w, t), fit in sorted(found.items(), key=lambda one: -one[1].score):
        rivals = [other for (v, u), other in taken.items() if v != w and u == t and _overlap(walks, w, fit, v, other)]
        beside = [(trials[u], other) for (v, u), other in taken.items() if v == w]
        if not rivals and (not beside or (fit.is_certain and _is_of_other_times(trials[t], fit, beside))):
            taken[w, t] = fit
    return taken, misfits


def _overlap(walks: Sequence[RecordingAnalysis], one: int, its: FoundOffset, other: int, others: FoundOffset) -> bool:
    """Whether two walks lie on the same instants of a reference."""
    (a, b), (c, d) = (
        (walks[w].time_s[0] + fit.offset_s, walks[w].time_s[-1] + fit.offset_s)
        for w, fit in ((one, its), (other, others))
    )
    return bool(min(b, d) - max(a, c) > MIN_OVERLAP_S)


def _is_of_other_times(one: NamedTrial, its: FoundOffset, others: Sequence[tuple[NamedTrial, FoundOffset]]) -> bool:
    """Whether a trial lies on instants of a walk that no other trial covers, as passes through one volume do."""
    first_s, last_s = _span_of(one, its.offset_s)
    spans = [_span_of(other, fit.offset_s) for other, fit in others]
    return all(last_s <= first + APART_S or last <= first_s + APART_S for first, last in spans)


def _span_of(one: NamedTrial, offset_s: float) -> tuple[float, float]:
    """First and last known instant of a trial, on the walk's clock."""
    known = [time_s[np.isfinite(angle)] for time_s, angle in one.trial.angles.values()]
    stamps = np.concatenate(known) - offset_s
    return float(stamps.min()), float(stamps.max())


def _trial(walk: RecordingAnalysis, named: NamedTrial) -> ComparedTrial:
    return ComparedTrial(
        {joint: TimedAngle(walk.time_s, angle.angle_rad) for joint, angle in walk.measured.items()},
        {joint: TimedAngle(time_s, angle) for joint, (time_s, angle) in named.trial.angles.items()},
    )


def _is_exchanged(walk: RecordingAnalysis, named: NamedTrial, fit: FoundOffset) -> bool:
    """Half a stride away, each leg looks like the other, but not as much as like itself."""
    trial = _trial(walk, named)
    if len({joint.side for joint in trial.joints}) < len(Side):
        return False
    other = {Joint(joint.replace(joint.side, joint.side.other)): curve for joint, curve in trial.reference.items()}
    found = find_offset(replace(trial, reference=other))
    return isinstance(found, FoundOffset) and found.score > CLEARLY * fit.score


def _angles_compared(
    analysis: Analysis, walk: RecordingAnalysis, pairs: Sequence[tuple[NamedTrial, Alignment]]
) -> ComparedWalk:
    references, figures, used = {}, {}, {}
    joints = [joint for joint in Joint if any(joint in _trial(walk, named).joints for named, _ in pairs)]
    for joint in joints:
        reference, is_within = _reference_of(walk, joint, pairs)
        is_sure = walk.time_s < walk.slipped_from_s.get(joint.side, np.inf)
        references[joint] = np.where(is_sure, reference, np.nan)
        angle_rad = walk.measured[joint].angle_rad
        used[joint] = UsedSamples(
            recorded=len(walk.time_s),
            used=int(np.count_nonzero(np.isfinite(angle_rad) & np.isfinite(references[joint]))),
            outside=int(np.count_nonzero(~is_within)),
            after_slip=int(np.count_nonzero(is_within & ~is_sure)),
        )
        calibration = analysis.calibrated_for(walk).get(joint)
        has_zero = joint.is_hip or (calibration is not None and calibration.zero is not ZeroKind.NONE)
        for kind, angle in _angles_of(walk.measured[joint]):
            sd = walk.measured[joint].sd_rad if kind is AngleKind.RESULT else None
            phase = walk.gait[joint.side].phase if joint.side in walk.gait else None
            strides = _rows_of_strides(walk, joint.side)
            found = agreement_of(angle, references[joint], sd, phase, strides, has_zero=has_zero)
            if found is not None:
                figures[joint, kind] = found
    (best, alignment), *more = pairs
    return ComparedWalk(walk, best, alignment, tuple(more), used, references, figures)


def _reference_of(
    walk: RecordingAnalysis, joint: Joint, pairs: Sequence[tuple[NamedTrial, Alignment]]
) -> tuple[FloatArray, BoolArray]:
    """The reference's angle (n,) at the walk's instants, from whichever trial gives it, and where any trial lies."""
    reference, is_within = np.full(len(walk.time_s), np.nan), np.zeros(len(walk.time_s), dtype=bool)
    for named, alignment in pairs:
        if joint not in named.trial.angles:
            continue
        time_s, angle_rad = named.trial.angles[joint]
        known_s, at_s = time_s[np.isfinite(angle_rad)], alignment.clock.at(walk.time_s)
        if not len(known_s):
            continue
        # a joint that took no part in the alignment has no sign of its own: its likelier one is 1
        found = alignment.sign.get(joint, 1) * angle_at(TimedAngle(time_s, angle_rad), at_s)
        reference = np.where(np.isfinite(reference), reference, found)
        is_within |= (at_s >= known_s[0]) & (at_s <= known_s[-1])
    return reference, is_within


def _angles_of(angle: JointAngle | HipAngle) -> Iterator[tuple[AngleKind, FloatArray]]:
    yield AngleKind.RESULT, angle.angle_rad
    if isinstance(angle, HipAngle):
        return
    yield AngleKind.PUBLISHED, angle.published_rad
    if angle.orientation_rad is not None:
        yield AngleKind.ORIENTATION, angle.orientation_rad


def _rows_of_strides(walk: RecordingAnalysis, side: Side) -> IntArray | None:
    """First and last row (k, 2) of each stride used; None where the walk has no gait of this side."""
    if side not in walk.gait:
        return None
    strides = walk.gait[side].strides
    used = strides.is_used
    ends = [np.searchsorted(walk.time_s, at_s[used]) for at_s in (strides.start_s, strides.end_s)]
    return np.minimum(np.stack(ends, axis=1), len(walk.time_s) - 1)


def _events_compared(
    walks: Sequence[RecordingAnalysis], compared: Mapping[int, ComparedWalk], one: NamedTrial
) -> list[tuple[int, ComparedWalk]]:
    """The walk that a trial's events or strides describe, with them: its own, that of its name, else the likeliest."""
    if not one.trial.events and not one.trial.strides:
        return []
    with_gait = [w for w, walk in enumerate(walks) if walk.gait]
    own = [w for w in with_gait if w in compared and _alignment_of(compared[w], one) is not None]
    if not own and one.trial.angles:
        return []  # its angles fit no walk
    named = [w for w in with_gait if {walks[w].name, walks[w].folder} & one.names]
    found = [(w, _with_events(walks[w], compared.get(w), one)) for w in own or named or with_gait]
    return sorted(found, key=lambda pair: -_likely(pair[1]))[:1]


def _likely(walk: ComparedWalk) -> int:
    """How many events and strides of a reference this walk has."""
    return sum(found.found - found.more for found in walk.events.values()) + sum(map(len, walk.lengths_m.values()))


def _with_events(walk: RecordingAnalysis, before: ComparedWalk | None, one: NamedTrial) -> ComparedWalk:
    base = before or ComparedWalk(walk, one, None)
    reported = {(side, event): at_s for side, by_event in one.trial.events.items() for event, at_s in by_event.items()}
    ours = _events_of(walk)
    own = _alignment_of(base, one)
    clock_of = own or (base.alignment if not reported else None)
    if clock_of is not None:
        later_s = clock_of.clock.offset_s
    elif reported:
        later_s = event_offset(ours, reported)
    else:
        later_s = base.events_later_s
    within = {key: at_s - later_s for key, at_s in reported.items() if key[0] in walk.gait}
    lengths = {
        side: compare_lengths(walk.gait[side].strides, strides - [later_s, later_s, 0.0])
        for side, strides in one.trial.strides.items()
        if side in walk.gait
    }
    found = dict(compare_events(ours, within))
    if own is not None and base.more:  # of other times than what is there already
        found |= {key: joined([base.events[key], found[key]]) for key in found if key in base.events}
        others = {side: pairs for side, pairs in base.lengths_m.items() if side in lengths}
        lengths |= {side: np.concatenate([pairs, lengths[side]]) for side, pairs in others.items()}
    return replace(
        base,
        events={**base.events, **found},
        events_later_s=later_s,
        lengths_m={**base.lengths_m, **lengths},
    )


def _alignment_of(walk: ComparedWalk, one: NamedTrial) -> Alignment | None:
    """How a trial was brought to a walk; None where its angles are not compared with it."""
    return next((alignment for trial, alignment in walk.trials if trial is one), None)


def _events_of(walk: RecordingAnalysis) -> Events:
    found: dict[EventKey, FloatArray] = {}
    for side, gait in walk.gait.items():
        for event in EVENTS:
            times = [getattr(stretch, f"{event}_s") for stretch in gait.events]
            known = np.sort(np.concatenate(times)) if times else np.empty(0)
            found[side, event] = known[np.isfinite(known)]
    return found


def _refusal(
    walks: Sequence[RecordingAnalysis], trials: Sequence[NamedTrial], misfits: Sequence[Misfit]
) -> FileRefusedError:
    """Say the reason that came nearest to a comparison."""
    where = ", ".join(dict.fromkeys(one.file for one in trials))
    theirs = sorted({str(joint) for one in trials for joint in one.trial.angles})
    ours = sorted({str(joint) for walk in walks for joint in walk.measured})
    if Misfit.NOT_ALIKE in misfits:
        what = later("its angles match no walk of the session")
        return FileRefusedError(
            where, what, "Give the reference of this session, and check that left and right are not swapped in it"
        )
    if Misfit.TOO_LITTLE_MOTION in misfits:
        what = later("the joints hardly move in it, so its time offset cannot be found")
        return FileRefusedError(where, what, "Give the reference of a walk, not of standing, with angles in degrees")
    if Misfit.TOO_SHORT in misfits:
        what = later("both systems recorded less than two seconds of the same motion without gaps")
        return FileRefusedError(where, what, "Give the reference of a whole walk, at 20 or more samples a second")
    return FileRefusedError(
        where,
        "it contains {theirs} and the session contains {ours}, so there is nothing to compare",
        "Give the reference of a joint at which both sensors were worn",
        theirs=", ".join(theirs) or "no joint",
        ours=", ".join(ours) or "no joint",
    )
