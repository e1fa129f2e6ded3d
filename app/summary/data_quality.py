"""Which parts of a walk can be read, what speaks against the others, and what to do: as shown on the screen."""

from dataclasses import dataclass

from app.summary import quality
from app.summary.facts import Facts
from app.summary.quality import Cause
from app.summary.request import AnalysedVisit
from app.wording.body import name_of, side_name
from app.wording.findings import place, sentence
from app.wording.recordings import with_shown_names
from app.wording.translation import capitalised, joined, later, tr
from core.body import Joint, Side
from core.findings import Finding, Severity
from core.gait.clocks import ClockTie
from core.results import RecordingAnalysis
from core.verdicts.model import Verdict, worst
from core.verdicts.quality import MIN_LOSS_PERCENT

# findings that a gate of the verdicts states with its own figure
GATES_OF_FINDINGS = {
    "axis_uncertain": ("axis",),
    "axis_from_walking": ("axis",),
    "too_little_motion": ("axis",),
    "sign_in_doubt": ("pairing", "sign"),
    "not_the_same_joint": ("pairing", "disagreement", "lag"),
    "clinical_sign_uncertain": ("sign",),
    "clock_moved": ("lag", "clocks"),
    "clock_drifts": ("clock_drift",),
    "zero_unknown": ("zero",),
    "no_standing": ("zero",),
    "strap_slipped": ("strap",),
    "no_mean": ("strides",),
    "no_spread": ("strides",),
    "no_spread_of_side": ("strides",),
}
# gates that a new free motion may open
FREE_MOTION_MENDS = frozenset({"axis", "axis_halves", "axis_motions", "pairing", "disagreement", "strap"})
ALL_READ = {
    1: later("The {joint} is reported."),
    2: later("Both joints are reported."),
    3: later("All three joints are reported."),
    4: later("All four joints are reported."),
    5: later("All five joints are reported."),
    6: later("All six joints are reported."),
}


@dataclass(frozen=True, slots=True)
class QualityLine:
    """One thing that speaks against a figure: `where` it is, `why`, and what `to_do`, which may be empty.

    `side` is the leg whose free motion mends it, None where that does not. `is_aside`: each leg can be read.
    """

    verdict: Verdict
    where: str
    why: str
    to_do: str
    side: Side | None = None
    is_aside: bool = False

    @property
    def is_grave(self) -> bool:
        """Whether it takes a joint or a leg away."""
        return self.verdict is Verdict.NOT_REPORTED and not self.is_aside


@dataclass(frozen=True, slots=True)
class DataQuality:
    """What may be read of a walk.

    `first`, `then`: the sentence that states it, and one beside it.
    """

    verdict: Verdict  # the gravest of all
    first: str
    then: str
    lines: tuple[QualityLine, ...]  # what speaks against it, the gravest first
    in_order: str  # what was looked at and found in order; empty where nothing was


def data_quality(facts: Facts) -> DataQuality:
    """Look at the verdicts of a walk and at what was noticed about it."""
    found = quality.causes(facts)
    names = {walk.name for walk in facts.part.walks}
    findings = _noticed(facts.visit, names, {cause.gate for cause in found})
    first, then = _in_words(facts)
    return _quality(first, then, [*map(_of_cause, found), *map(_of_finding, findings)], _in_order(facts))


def quality_without_walk(visit: AnalysedVisit, recording: str) -> DataQuality:
    """What was noticed about a recording of which nothing is judged; empty: about the whole session."""
    lines = [_of_finding(finding) for finding in _noticed(visit, {recording} - {""}, set())]
    first = tr("No data quality findings.") if not lines else tr("There are data quality findings.")
    return _quality(first, "", lines, "")


def _quality(first: str, then: str, lines: list[QualityLine], in_order: str) -> DataQuality:
    ordered = sorted(lines, key=lambda line: (not line.is_grave, line.verdict is not Verdict.NOT_REPORTED))
    return DataQuality(worst(line.verdict for line in ordered), first, then, tuple(ordered), in_order)


def _of_cause(cause: Cause) -> QualityLine:
    sides = {place.side for place in cause.places if isinstance(place, Joint) and not place.is_hip}
    side = sides.pop() if cause.gate in FREE_MOTION_MENDS and len(sides) == 1 else None
    return QualityLine(cause.verdict, cause.where, cause.words.why, cause.words.to_do, side, cause.is_aside)


def _of_finding(finding: Finding) -> QualityLine:
    """A finding withholds nothing by itself: what it withholds is stated by a verdict."""
    stated = sentence(finding)
    where = capitalised(place(finding.where))
    where, rest = (where, stated.removeprefix(f"{where}: ")) if stated.startswith(f"{where}: ") else ("", stated)
    why, stop, to_do = rest.partition(". ")
    return QualityLine(Verdict.CARE, where, capitalised(why + "." if stop else why), to_do)


def _noticed(visit: AnalysedVisit, names: set[str], gates: set[str]) -> list[Finding]:
    """Give findings of the recordings or the session that no verdict states, gravest first, in user's names."""
    others = {one.name for one in visit.session.recordings} - names if names else set()
    found = [
        finding
        for finding in visit.analysis.findings
        if finding.severity is not Severity.INFO
        and gates.isdisjoint(GATES_OF_FINDINGS.get(finding.key, ()))
        and others.isdisjoint(finding.where.split(", "))
    ]
    shown = visit.shown_names
    return [
        with_shown_names(finding, shown)
        for finding in sorted(found, key=lambda finding: finding.severity is not Severity.GRAVE)
    ]


def _in_words(facts: Facts) -> tuple[str, str]:
    joints = {joint: facts.verdicts.joint(joint).shape.verdict for joint in Joint if facts.is_measured(joint)}
    if not joints:
        return tr("No joint was measured in this walk."), ""
    care, out = (
        [name_of(joint) for joint, verdict in joints.items() if verdict is required]
        for required in (Verdict.CARE, Verdict.NOT_REPORTED)
    )
    if len(out) == len(joints):
        return tr("No joint is reported for this walk."), ""
    first = _readable(list(map(name_of, joints)), care, out)
    heights = [name_of(joint) for joint in joints if facts.verdicts.joint(joint).height.verdict is Verdict.NOT_REPORTED]
    if out or not heights:
        return first, ""
    if len(heights) == len(joints):
        return first, tr("Range of motion and curve shape are valid. Absolute angles are not reported.")
    return first, tr("Absolute angle not reported: {joints}.").format(joints=joined(heights))


def _readable(joints: list[str], care: list[str], out: list[str]) -> str:
    """How many joints can be read, and which are read with care or not reported."""
    read = len(joints) - len(care) - len(out)
    if read == len(joints):
        return tr(ALL_READ[read]).format(joint=joints[0])
    if len(care) == len(joints):
        return tr("All joints: Caution.") if len(joints) > 1 else tr("Caution: {joints}.").format(joints=care[0])
    stated = [tr("{count} of {all} joints: Good.").format(count=read, all=len(joints))] if read else []
    stated += [tr("Caution: {joints}.").format(joints=joined(care))] if care else []
    stated += [tr("Not reported: {joints}.").format(joints=joined(out))] if out else []
    return " ".join(stated)


def one_time_in_words(walk: RecordingAnalysis) -> str:
    """What ties the clocks of both legs, inside a sentence: where the hips do, by how much they are apart."""
    clock = walk.leg_clock
    if clock is None or walk.clocks is None or walk.clocks.tie is not ClockTie.PELVIS:
        return tr("left and right sensors synchronised")
    sd = f"{1000 * clock.sd_s:.0f}"
    if clock.applied_s == 0.0:
        return tr("left and right sensors synchronised from hip movement to ± {sd} ms").format(sd=sd)
    late = f"{1000 * abs(clock.applied_s):.0f}"
    side = side_name(Side.RIGHT if clock.applied_s > 0 else Side.LEFT)
    stated = tr("left and right sensors synchronised from hip movement: the {side} leg was {late} ms late, ± {sd} ms")
    return stated.format(side=side, late=late, sd=sd)


def _in_order(facts: Facts) -> str:
    """What was looked at without finding anything."""
    stated = []
    if not quality.slipped_straps(facts):
        stated.append(tr("no strap moved"))
    if max((lost for walk in facts.part.walks for lost in walk.lost_percent.values()), default=0.0) < MIN_LOSS_PERCENT:
        stated.append(tr("hardly any samples lost"))
    if facts.verdicts.between.verdict is Verdict.READ:
        stated.append(one_time_in_words(facts.walk))
    return tr("Checked: {what}.").format(what=joined(stated)) if stated else ""
