"""Who is in the demonstration's library, and how each of them walks at each visit.

All are simulated, and their dates are counted back from today. Each visit draws its own chance, so that sensors sit and
walks vary as they do on another day; the body stays the patient's.
"""

import datetime
from collections.abc import Mapping
from dataclasses import dataclass, field

from app.storage.stored import Limits
from app.wording.translation import tr
from core.alignment import AlignmentChange, PartChange, ProsthesisPart, net_of
from core.body import Side, Site
from core.goals import Goal, GoalOf, ordered
from core.prosthesis import AmputationLevel, FootKind, KneeKind, Prosthesis
from core.session import Patient
from core.timed.protocols import TimedProtocol
from devices.simulation.fitted_prosthesis import SPEED_M_S as PROSTHESIS_SPEED_M_S
from devices.simulation.fitted_prosthesis import setting_of
from devices.simulation.walker_body import (
    PEOPLE,
    CourseKind,
    FreeMotion,
    GaitChange,
    Manner,
    Standing,
    TimedCourse,
    Tissue,
    Walk,
    WalkerSettings,
)

DEMO = "DEMO"  # how codes begin that simulated recordings may be kept for, as the library has it
BY = "Demonstration"
STRIDES = 14
AT = datetime.time(11, 20)


@dataclass(frozen=True, slots=True)
class ReportedOfWalk:
    """What was stated about a walk: under which condition, what was changed before it, and whether it is a test."""

    condition: str
    alignment: AlignmentChange | None = None
    test: TimedProtocol | None = None


@dataclass(frozen=True, slots=True)
class SimulatedVisit:
    """One visit: how its patient moves, and what was `reported` of each walk by its name."""

    code: str
    started: datetime.datetime
    settings: WalkerSettings
    reported: Mapping[str, ReportedOfWalk]
    limits: Limits = field(default_factory=Limits)
    is_reported: bool = True


@dataclass(frozen=True, slots=True)
class SimulatedPatient:
    """A patient and the visits, in order of time."""

    details: Patient
    visits: tuple[SimulatedVisit, ...]


def simulated_patients(now: datetime.datetime) -> tuple[SimulatedPatient, ...]:
    """All of them, the most recent visit first; words are in the language of the screen."""
    return _knee_replaced(now), _after_stroke(now), _above_knee(now), _below_knee(now)


@dataclass(frozen=True, slots=True)
class _Recovery:
    """How the patient with a new knee walks, so many days ago.

    Seeds are such that all but what is meant not to be reported can be read: of walks drawn at random some would have
    to be read with care.
    """

    seed: int
    days_ago: int
    speed_m_s: float
    knee_deg: float
    stance_percent: float
    rise_s: float
    has_stick: bool = False
    lost: Mapping[Site, float] = field(default_factory=dict)
    is_reported: bool = True

    @property
    def change(self) -> GaitChange:
        return GaitChange(knee_deg=self.knee_deg, stance_percent=self.stance_percent)


_RECOVERY = (
    _Recovery(63, 149, 0.70, -22.0, -5.0, 2.1, has_stick=True),
    # a sensor at the edge of its radio's reach, so that this visit's knee may not be read
    _Recovery(62, 121, 0.84, -17.0, -4.0, 1.8, has_stick=True, lost={Site.LEFT_SHANK: 0.08}),
    _Recovery(60, 65, 1.00, -10.0, -2.5, 1.5),
    _Recovery(61, 1, 1.14, -5.0, -1.0, 1.2, is_reported=False),
)


def _knee_replaced(now: datetime.datetime) -> SimulatedPatient:
    """A left knee that was replaced: four visits in five months, goals agreed at the first."""
    code, first = f"{DEMO}-KNEE", _days_ago(now, _RECOVERY[0].days_ago).date()
    goals = (
        Goal("speed_m_s", GoalOf.WALK, 1.1, first, BY),
        Goal("knee_stance_to_swing_deg", GoalOf.LEFT, 55.0, first, BY),
        Goal("sit_to_stand_time_s", GoalOf.WALK, 15.0, first, BY, is_at_most=True),
    )
    patient = Patient(
        code=code,
        birth_year=now.year - 65,
        sex="female",
        height_m=1.66,
        mass_kg=74.0,
        device=tr("left knee replacement"),
        aids=tr("stick initially"),
        affected_side="left",
        prosthetic_side="none",
        goals=ordered(goals),
    )
    return SimulatedPatient(patient, tuple(_visit_of_knee(code, now, one) for one in _RECOVERY))


def _visit_of_knee(code: str, now: datetime.datetime, how: _Recovery) -> SimulatedVisit:
    shoes, stick = tr("Shoes"), tr("Shoes, stick")
    reported = {"walk 1": ReportedOfWalk(shoes)}
    walks = [_limping(how, "walk 1")]
    if how.has_stick:
        reported["walk 2"] = ReportedOfWalk(stick)
        walks.append(_limping(how, "walk 2", speed_m_s=how.speed_m_s + 0.06))
    ten_metres, rises = f"walk {len(walks) + 1}", f"walk {len(walks) + 2}"
    reported[ten_metres] = ReportedOfWalk(shoes, test=TimedProtocol.TEN_METRES)
    reported[rises] = ReportedOfWalk(shoes, test=TimedProtocol.SIT_TO_STAND)
    tests = (
        TimedCourse(
            CourseKind.TEN_METRES, how.seed, how.speed_m_s, name=ten_metres, change=how.change, changed_side=Side.LEFT
        ),
        TimedCourse(CourseKind.SIT_TO_STAND, how.seed, how.speed_m_s, rise_s=how.rise_s, name=rises),
    )
    settings = WalkerSettings(
        seed=how.seed,
        body_seed=2,
        tissue=Tissue.SOFT,
        variation=PEOPLE,
        site_loss_fractions=how.lost,
        recordings=(Standing(), FreeMotion(), *walks, *tests),
    )
    return SimulatedVisit(code, _days_ago(now, how.days_ago), settings, reported, is_reported=how.is_reported)


def _limping(how: _Recovery, name: str, *, speed_m_s: float | None = None) -> Walk:
    return Walk(
        name,
        speed_m_s=speed_m_s or how.speed_m_s,
        strides=STRIDES,
        change=how.change,
        changed_side=Side.LEFT,
    )


def _after_stroke(now: datetime.datetime) -> SimulatedPatient:
    """A right leg after a stroke whose foot hardly rolls: two visits with timed tests."""
    code, days_ago = f"{DEMO}-STROKE", (46, 4)
    goal = Goal("speed_m_s", GoalOf.WALK, 0.6, _days_ago(now, days_ago[0]).date(), BY)
    patient = Patient(
        code=code,
        birth_year=now.year - 71,
        sex="male",
        height_m=1.74,
        mass_kg=81.0,
        device=tr("stroke, right hemiparesis"),
        aids=tr("stick outdoors"),
        affected_side="right",
        prosthetic_side="none",
        goals=(goal,),
    )
    speeds, rises_s = (0.42, 0.60), (2.4, 1.9)
    visits = (
        _visit_after_stroke(code, _days_ago(now, days), 60 + k, speed, rise_s)
        for k, (days, speed, rise_s) in enumerate(zip(days_ago, speeds, rises_s, strict=True))
    )
    return SimulatedPatient(patient, tuple(visits))


def _visit_after_stroke(
    code: str, started: datetime.datetime, seed: int, speed_m_s: float, rise_s: float
) -> SimulatedVisit:
    manner, shoes = {Side.RIGHT: Manner.HEMIPARETIC}, tr("Shoes")
    settings = WalkerSettings(
        seed=seed,
        body_seed=31,
        tissue=Tissue.SOFT,
        variation=PEOPLE,
        recordings=(
            Standing(),
            FreeMotion(),
            Walk("walk 1", speed_m_s=speed_m_s, strides=STRIDES, manner_of_side=manner),
            TimedCourse(CourseKind.TEN_METRES, seed, speed_m_s, manner_of_side=manner, name="walk 2"),
            TimedCourse(
                CourseKind.UP_AND_GO,
                seed,
                speed_m_s,
                hesitates=True,
                rise_s=rise_s,
                manner_of_side=manner,
                name="walk 3",
            ),
        ),
    )
    reported = {
        "walk 1": ReportedOfWalk(shoes),
        "walk 2": ReportedOfWalk(shoes, test=TimedProtocol.TEN_METRES),
        "walk 3": ReportedOfWalk(shoes, test=TimedProtocol.UP_AND_GO),
    }
    return SimulatedVisit(code, started, settings, reported)


# B: a foot set more plantarflexed and further back; C, from B: the knee's valve out, so that it swings further
_CHANGES = (
    (),
    (PartChange(ProsthesisPart.FOOT_FRONT_SCREW, angle_deg=4.0, turns=0.5, shift_mm=6.0),),
    (PartChange(ProsthesisPart.KNEE_UNIT, turns=1.0),),
)


def _above_knee(now: datetime.datetime) -> SimulatedPatient:
    """A left above-knee prosthesis, walked with three alignments in one visit."""
    code, side = f"{DEMO}-AK", Side.LEFT
    fitted = Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.FLUID_CONTROLLED)
    patient = Patient(
        code=code,
        birth_year=now.year - 58,
        sex="male",
        height_m=1.80,
        mass_kg=86.0,
        affected_side=str(side),
        prosthetic_side=str(side),
        prostheses={side: fitted},
    )
    names: list[str] = []
    walks: list[Walk] = []
    reported: dict[str, ReportedOfWalk] = {}
    changed: list[PartChange] = []
    for letter, parts in zip("ABC", _CHANGES, strict=True):
        name, condition = f"walk {len(walks) + 1}", tr("Alignment {letter}").format(letter=letter)
        changed += parts
        setting = setting_of({change.part: change for change in net_of(changed)}, fitted)
        walks.append(Walk(name, speed_m_s=PROSTHESIS_SPEED_M_S, strides=STRIDES + 4, prosthesis=setting))
        reported[name] = ReportedOfWalk(condition, AlignmentChange(names[-1], parts) if parts else None)
        names.append(condition)
    settings = WalkerSettings(
        seed=61,
        tissue=Tissue.SOFT,
        prosthetic_side=side,
        fitted=fitted,
        variation=PEOPLE,
        recordings=(Standing(), FreeMotion(), *walks),
    )
    limits = Limits(without_ankle=frozenset({side}))
    return SimulatedPatient(patient, (SimulatedVisit(code, _days_ago(now, 9), settings, reported, limits),))


def _below_knee(now: datetime.datetime) -> SimulatedPatient:
    """A right below-knee prosthesis, whose foot springs back and has no joint; the knee is the patient's own."""
    code, side = f"{DEMO}-BK", Side.RIGHT
    fitted = Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)
    patient = Patient(
        code=code,
        birth_year=now.year - 44,
        sex="female",
        height_m=1.70,
        mass_kg=68.0,
        affected_side=str(side),
        prosthetic_side=str(side),
        prostheses={side: fitted},
    )
    settings = WalkerSettings(
        seed=71,
        tissue=Tissue.SOFT,
        prosthetic_side=side,
        fitted=fitted,
        variation=PEOPLE,
        recordings=(Standing(), FreeMotion(), Walk(strides=STRIDES)),
    )
    reported = {"walk 1": ReportedOfWalk(tr("Shoes"))}
    return SimulatedPatient(patient, (SimulatedVisit(code, _days_ago(now, 12), settings, reported),))


def _days_ago(now: datetime.datetime, days: int) -> datetime.datetime:
    return datetime.datetime.combine(now.date() - datetime.timedelta(days=days), AT, now.tzinfo)
