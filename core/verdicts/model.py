"""The verdicts of one recording: what can be read, what with care, what is not reported, each with its reasons."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from core.body import LEG_JOINTS, Joint, Side, Site


class Verdict(StrEnum):
    """How far a quantity can be trusted. The values are the words of summary.json and the CSV files."""

    READ = "read"
    CARE = "care"
    NOT_REPORTED = "withheld"
    NOT_MEASURED = "not_measured"


TOE_OFF_GATE = "toe_off"
_ORDER = (Verdict.READ, Verdict.CARE, Verdict.NOT_REPORTED, Verdict.NOT_MEASURED)


def worst(verdicts: Iterable[Verdict]) -> Verdict:
    """The gravest of some verdicts; of none, `READ`."""
    return max(verdicts, key=_ORDER.index, default=Verdict.READ)


@dataclass(frozen=True, slots=True)
class GateReason:
    """One gate that was not passed: what was found, what would have passed, both in `unit`.

    `value` and `limit` are None where the evidence is no figure. `verdict` is what this gate alone decides. `sites` are
    the sensors it is about, where these are others than its place's, `joint` the joint that its sentence names.
    `app.wording.verdicts` has each gate's sentence.
    """

    gate: str
    verdict: Verdict
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    sites: tuple[Site, ...] = ()
    joint: Joint | None = None


@dataclass(frozen=True, slots=True)
class Assessment:
    """A verdict and the gates that led to it, the gravest first."""

    verdict: Verdict
    reasons: tuple[GateReason, ...] = ()

    @property
    def is_reported(self) -> bool:
        """Whether a figure may be printed at all."""
        return self.verdict in (Verdict.READ, Verdict.CARE)

    @property
    def is_toe_off_biased(self) -> bool:
        """Whether what rests on the toe-off is off by as much in every stride of this leg."""
        return any(reason.gate == TOE_OFF_GATE for reason in self.reasons)


READ = Assessment(Verdict.READ)
NOT_MEASURED = Assessment(Verdict.NOT_MEASURED)


def assess(reasons: Iterable[GateReason]) -> Assessment:
    """The gravest reason decides; without any, the quantity can be read."""
    ordered = tuple(sorted(reasons, key=lambda reason: -_ORDER.index(reason.verdict)))
    return Assessment(worst(reason.verdict for reason in ordered), ordered)


def together(assessments: Iterable[Assessment]) -> Assessment:
    """What holds where several assessments are needed: the gravest of them, with the reasons of all, each once."""
    some = tuple(assessments)
    reasons = tuple(dict.fromkeys(reason for one in some for reason in one.reasons))
    verdict = worst(one.verdict for one in some)
    return Assessment(verdict, assess(reasons).reasons)


@dataclass(frozen=True, slots=True)
class JointVerdicts:
    """Of one joint: its shape (range, excursions, when it peaks), its height (any absolute angle) and its sign."""

    shape: Assessment
    height: Assessment
    sign: Assessment


@dataclass(frozen=True, slots=True)
class LegVerdicts:
    """Of one leg: its timing (stance, phases, stride time) and its distances (length, speed, clearance)."""

    timing: Assessment
    distance: Assessment


@dataclass(frozen=True, slots=True)
class Verdicts:
    """Of one recording. `between` is what compares instants of both legs, which needs both clocks.

    `pelvis` is of the pelvis against the vertical and against its own mean; its rotation needs no more. `pelvis_tilt`
    is of how far its tilt moves over the stride, `abduction` of each hip's, which needs the heading between pelvis and
    thigh.

    A joint or leg that is missing was not measured.
    """

    joints: Mapping[Joint, JointVerdicts] = field(default_factory=dict)
    legs: Mapping[Side, LegVerdicts] = field(default_factory=dict)
    between: Assessment = NOT_MEASURED
    pelvis: Assessment = NOT_MEASURED
    pelvis_tilt: Assessment = NOT_MEASURED
    abduction: Mapping[Side, Assessment] = field(default_factory=dict)

    @property
    def reported_joints(self) -> tuple[Joint, ...]:
        """The joints of the legs, measured or not, and the hips that were."""
        return (*LEG_JOINTS, *(joint for joint in Joint if joint.is_hip and joint in self.joints))

    def joint(self, joint: Joint) -> JointVerdicts:
        return self.joints.get(joint, UNKNOWN_JOINT)

    def leg(self, side: Side) -> LegVerdicts:
        return self.legs.get(side, UNKNOWN_LEG)


UNKNOWN_JOINT = JointVerdicts(NOT_MEASURED, NOT_MEASURED, NOT_MEASURED)
UNKNOWN_LEG = LegVerdicts(NOT_MEASURED, NOT_MEASURED)


def pooled(many: Iterable[Verdicts]) -> Verdicts:
    """What holds of several walks whose strides are taken together: of each quantity the worst that a walk has."""
    some = tuple(many)
    joints = [joint for joint in Joint if any(joint in one.joints for one in some)]
    sides = [side for side in Side if any(side in one.legs for one in some)]
    return Verdicts(
        joints={joint: _worst_joint([one.joints[joint] for one in some if joint in one.joints]) for joint in joints},
        legs={side: _worst_leg([one.legs[side] for one in some if side in one.legs]) for side in sides},
        between=together(one.between for one in some) if some else NOT_MEASURED,
        pelvis=together(one.pelvis for one in some) if some else NOT_MEASURED,
        pelvis_tilt=together(one.pelvis_tilt for one in some) if some else NOT_MEASURED,
        abduction={
            side: together(one.abduction[side] for one in some if side in one.abduction)
            for side in Side
            if any(side in one.abduction for one in some)
        },
    )


def _worst_joint(found: list[JointVerdicts]) -> JointVerdicts:
    parts = ([getattr(one, name) for one in found] for name in ("shape", "height", "sign"))
    return JointVerdicts(*map(together, parts))


def _worst_leg(found: list[LegVerdicts]) -> LegVerdicts:
    return LegVerdicts(together(one.timing for one in found), together(one.distance for one in found))
