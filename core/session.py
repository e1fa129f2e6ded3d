"""What was measured at one visit: its recordings, who was measured, and what people stated about them."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from core.alignment import AlignmentChange, condition_returned_to
from core.body import Joint, Side, Site
from core.findings import Finding
from core.goals import Goal
from core.prosthesis import NOT_STATED, JointNature, Prostheses, stated_only
from core.samples import ImuBlock, SensorInfo
from core.timed.protocols import PlannedTest


class RecordingKind(StrEnum):
    """What the patient did in a recording."""

    STANDING = "standing"
    FREE_MOTION = "free_motion"
    WALKING = "walking"


@dataclass(frozen=True, slots=True)
class Patient:
    """What the clinic typed. Sides are left, right, both, none or empty; `goals` are those that ended, too.

    `prostheses` is what was stated of a side's prosthesis; of a side that is not prosthetic it means nothing.
    """

    code: str = ""
    birth_year: int | None = None
    sex: str = ""
    height_m: float | None = None
    mass_kg: float | None = None
    device: str = ""
    aids: str = ""
    affected_side: str = ""
    prosthetic_side: str = ""
    unknown: Mapping[str, object] = field(default_factory=dict)
    goals: tuple[Goal, ...] = ()
    prostheses: Prostheses = field(default_factory=dict)

    @property
    def prosthetic_sides(self) -> frozenset[Side]:
        """The sides that wear a prosthesis, of whatever level."""
        return frozenset(side for side in Side if self.prosthetic_side in (side, "both"))

    @property
    def worn(self) -> Prostheses:
        """What is stated of the prostheses of prosthetic sides; a side of which nothing is stated is missing."""
        return {side: one for side, one in stated_only(self.prostheses).items() if side in self.prosthetic_sides}

    def nature_of(self, joint: Joint) -> JointNature:
        """What a joint is, for all that is stated."""
        if joint.side not in self.prosthetic_sides:
            return JointNature.NOT_STATED
        return self.worn.get(joint.side, NOT_STATED).nature_of(joint)

    def without_ankle(self, answered: Collection[Side]) -> frozenset[Side]:
        """Sides whose foot has no ankle joint: by its kind, or where that is not stated as was `answered`."""
        feet = {side: self.worn.get(side, NOT_STATED) for side in Side}
        return frozenset(s for s, one in feet.items() if (s in answered if one.foot is None else one.has_rigid_foot))


@dataclass(frozen=True, slots=True)
class Recording:
    """All sensors from one start to one stop.

    `imu` names the site that each block of samples was worn at; the sites share one clock up to a small lag.
    `left_out_s` holds, for each side, one time inside of each stride that a person has left out, ascending, seconds on
    the recording's clock: a time goes on naming the same stride when its events are found a little earlier or later.
    `alignment` is what was changed at the prosthesis before the walk; None where nobody has entered anything.
    `test` is the timed test that the walk is, with the instants of its keys; None of other walks.
    """

    name: str
    kind: RecordingKind
    folder: str
    imu: Mapping[Site, ImuBlock]
    condition: str = ""
    started: str = ""
    is_kept: bool = True
    note: str = ""
    is_restrapped_before: bool = False
    left_out_s: Mapping[Side, tuple[float, ...]] = field(default_factory=dict)
    alignment: AlignmentChange | None = None
    test: PlannedTest | None = None
    unknown: Mapping[str, object] = field(default_factory=dict)

    @property
    def returned_to(self) -> str:
        """The condition that it is: as stated, or the earlier one that it returns to; empty where none was stated."""
        return condition_returned_to(self.condition, self.alignment)

    def holds(self, *sites: Site) -> bool:
        return all(site in self.imu for site in sites)


@dataclass(frozen=True, slots=True)
class Session:
    """One visit of one patient: its recordings in order of time, and what was stated about them.

    `zero_rad` holds goniometer values while standing in the clinical sign, `turned_sign` the user's word on a joint's
    sign: -1 turns the sign that was found, 1 confirms it. `findings` is what the reader noticed.
    """

    recordings: tuple[Recording, ...]
    patient: Patient = Patient()
    sensors: Mapping[Site, SensorInfo] = field(default_factory=dict)
    zero_rad: Mapping[Joint, float] = field(default_factory=dict)
    turned_sign: Mapping[Joint, int] = field(default_factory=dict)
    started: str = ""
    operator: str = ""
    surface: str = ""
    notes: str = ""
    software: str = ""
    is_simulated: bool = False
    findings: tuple[Finding, ...] = ()
    unknown: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = [recording.name for recording in self.recordings]
        if len(set(names)) < len(names):
            raise ValueError(f"recordings need names of their own, got {names}")
