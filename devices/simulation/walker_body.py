"""Settings of the simulated patient, and the body that a seed gives."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from core.body import LEG_SITES, Segment, Side, Site
from core.prosthesis import NOT_STATED, KneeKind, Prosthesis
from core.samples import FloatArray, RateKind
from devices.simulation.walker_prosthesis import (
    AS_BUILT,
    ProsthesisSetting,
    ProstheticFoot,
    built,
    foot_of,
    with_own_knee,
)


class Tissue(StrEnum):
    """How a sensor moves against its bone, and a knee against a hinge.

    RIGID: not at all. SOFT: thigh about 2 deg and 5 mm, and 6 deg of knee rotation per 60 deg of flexion. REAL: more,
    ringing at 5-12 Hz after contacts and trembling, so that the relative rate off the axis is that of people walking:
    0.55-1.05 rad/s, 0.5-0.7 of it (rms) above 3 Hz.
    """

    RIGID = "rigid"
    SOFT = "soft"
    REAL = "real"


class Motion(StrEnum):
    """How a leg is moved to identify its joints.

    SIDE_LYING: knee and ankle bend, the thigh hardly moves, the knee axis is near vertical. LUNGES: left and right
    in turn, the body turning round between them.
    """

    FULL = "full"
    WEAK = "weak"
    SAGITTAL = "sagittal"
    KNEE_ONLY = "knee_only"
    SIDE_LYING = "side_lying"
    LUNGES = "lunges"


class Manner(StrEnum):
    """How the feet are used in walking.

    SHUFFLING: short steps, the foot put down and lifted nearly flat. TOES: the heels never touch the floor. FLAT: the
    foot lands and lifts flat, with a pitch of a few degrees. STIFF: foot and shank roll as one piece, as in an
    ankle-foot orthosis. DRAGGING: a foot that hangs, its toes on the floor in early swing, landing on the toes or flat;
    toe-off is where the toes begin to slide. TOE_FIRST: lands on the toes, then lowers the heel. HEMIPARETIC: of one
    side, after a stroke: the foot lands and lifts nearly flat, the knee bends little in swing, and the leg lands late
    and is in stance for a shorter time than the other.
    """

    ORDINARY = "ordinary"
    SHUFFLING = "shuffling"
    TOES = "toes"
    FLAT = "flat"
    STIFF = "stiff"
    DRAGGING = "dragging"
    TOE_FIRST = "toe_first"
    HEMIPARETIC = "hemiparetic"


@dataclass(frozen=True, slots=True)
class GaitChange:
    """A change of gait, or standard deviations of one.

    `ankle_deg`: added to the range, by more plantarflexion at toe-off. Beyond -3 deg the range has other ends.
    `time`, `length`: of a stride, as shares: 0.02 is 2 % more.
    """

    knee_deg: float = 0.0  # added to the knee's peak in swing, and so to its range
    ankle_deg: float = 0.0
    stance_percent: float = 0.0  # points of the stride
    time: float = 0.0
    length: float = 0.0


NO_CHANGE = GaitChange()


@dataclass(frozen=True, slots=True)
class Variation:
    """Standard deviations beyond the walker's own small ones.

    From stride to stride, where `correlation` is that of successive strides; from walk to walk; and from strapping to
    strapping, whose `knee_deg` and `ankle_deg` are of what the sensors show, the joints themselves staying as they
    are.
    """

    strides: GaitChange = NO_CHANGE
    walks: GaitChange = NO_CHANGE
    strappings: GaitChange = NO_CHANGE
    correlation: float = 0.0


# as people vary: with the walker's own 0.9 deg and 0.8 % the strides of the knee spread by 1.7 deg, the time by 2 %
PEOPLE = Variation(
    strides=GaitChange(knee_deg=1.5, ankle_deg=1.5, stance_percent=1.0, time=0.018, length=0.027),
    walks=GaitChange(knee_deg=1.0, ankle_deg=1.0, stance_percent=0.5, time=0.02, length=0.025),
    correlation=0.3,
)


@dataclass(frozen=True, slots=True)
class Standing:
    """Standing still for `duration_s`."""

    name: str = "standing"
    duration_s: float = 3.0
    is_restrapped_before: bool = False


@dataclass(frozen=True, slots=True)
class FreeMotion:
    """Circling of thigh, shank and foot, by both legs at once or, with `is_in_turn`, by the left, then the right.

    `duration_s` is one leg's. `axis_from_vertical_rad` is for side-lying only.
    """

    name: str = "free motion"
    duration_s: float = 12.0
    motion: Motion = Motion.FULL
    is_in_turn: bool = False
    axis_from_vertical_rad: float = np.deg2rad(10.0)
    is_restrapped_before: bool = False


@dataclass(frozen=True, slots=True)
class Treadmill:
    """The belt that a walk is on."""

    ripple: float = 0.0  # by what share of its speed each landing slows the belt, which then makes up for it
    slope: float = 0.0  # rise over run


@dataclass(frozen=True, slots=True)
class Walk:
    """Standing, `strides` steps of each foot, standing. `turn_rad` (positive to the left) is made half-way.

    Attributes
    ----------
    turn_radius_m
        Of the arc on which the patient turns.
    pivot_share
        Of what a foot turns from one stance to the next it turns so much on its ball, before its toes leave the floor.
    manner_of_side
        Sides that walk in another manner than `manner`.
    change, changed_side
        How this walk differs from the person's others, in both legs or, for joints and stance, in one.
    drift, is_drift_random
        How gait changes from the first to the last stride: evenly, or as a random walk that ends by `drift` (a standard
        deviation) away.
    prosthesis
        What was set at the prosthesis before this walk; of who wears none it means nothing.
    treadmill
        None: over ground. On a belt the walk is as over ground, seen from the belt; it begins and ends there.
    """

    name: str = "walk 1"
    speed_m_s: float = 1.19
    strides: int = 9
    standing_before_s: float = 0.5
    standing_after_s: float = 0.5
    turn_rad: float = 0.0
    turn_radius_m: float = 0.8
    pivot_share: float = 0.0
    manner: Manner = Manner.ORDINARY
    is_restrapped_before: bool = False
    manner_of_side: Mapping[Side, Manner] = field(default_factory=dict)
    change: GaitChange = NO_CHANGE
    changed_side: Side | None = None
    drift: GaitChange = NO_CHANGE
    is_drift_random: bool = False
    prosthesis: ProsthesisSetting = AS_BUILT
    treadmill: Treadmill | None = None


@dataclass(frozen=True, slots=True)
class SensorErrors:
    """Densities per root hertz (of the half sample rate), standard deviations of what is constant in one session.

    `..._step_...` is the least difference between two values that the sensor can report (0: any), `..._range_...` the
    largest value, positive or negative; `COARSE` and `VERY_COARSE` are those of real sensors.
    """

    gyro_noise_rad_s: float = np.deg2rad(0.01)
    gyro_bias_sd_rad_s: float = np.deg2rad(0.3)
    gyro_bias_walk_rad_s: float = np.deg2rad(0.003)
    gyro_scale_sd: float = 0.003
    acc_noise_m_s2: float = 150e-6 * 9.81
    acc_bias_sd_m_s2: float = 0.03
    acc_scale_sd: float = 0.003
    gyro_step_rad_s: float = 0.0
    acc_step_m_s2: float = 0.0
    gyro_range_rad_s: float = np.inf
    acc_range_m_s2: float = np.inf


NO_ERRORS = SensorErrors(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
# 16 bits over +-2000 deg/s and +-16 g; and an older one of 0.07 deg/s and 0.004 g, whose noise is below its steps
COARSE = SensorErrors(
    gyro_step_rad_s=np.deg2rad(4000.0 / 65536),
    acc_step_m_s2=32 * 9.81 / 65536,
    gyro_range_rad_s=np.deg2rad(2000.0),
    acc_range_m_s2=16 * 9.81,
)
VERY_COARSE = SensorErrors(
    gyro_noise_rad_s=np.deg2rad(0.003),
    gyro_step_rad_s=np.deg2rad(0.07),
    acc_step_m_s2=0.004 * 9.81,
    gyro_range_rad_s=np.deg2rad(2000.0),
    acc_range_m_s2=8 * 9.81,
)


class CourseKind(StrEnum):
    """Which timed test the patient walks."""

    TEN_METRES = "10 m"
    TWO_MINUTES = "2 min"
    SIX_MINUTES = "6 min"
    UP_AND_GO = "up and go"
    SIT_TO_STAND = "sit to stand 5"
    STAIRS = "stairs"


class CourseFlaw(StrEnum):
    """By what an up and go is not the test, but for its lengths.

    SIDEWAYS: sat down with hardly a turn. ONE_WAY: sat down on a chair at the cone. OTHER_CHAIR: on one on the way
    back. TWICE: went round the cone twice. STANDING_START: stood at first. FALSE_START: rose, sat down, began again.
    """

    NONE = "none"
    SIDEWAYS = "sideways"
    ONE_WAY = "one way"
    OTHER_CHAIR = "other chair"
    TWICE = "twice"
    STANDING_START = "standing start"
    FALSE_START = "false start"


@dataclass(frozen=True, slots=True)
class UpAndGo:
    """How an up and go is laid out and gone. Places are from the chair's front edge, in metres.

    Attributes
    ----------
    cone_m, clearance_m
        Where the cone is, and how far from its middle the body goes round it. A line is turned on closely.
    overshoot_m
        So much further the patient goes before the turn; below zero, the turn is before the cone.
    before_chair_m
        Where the body is when it has risen.
    first_step_s
        From the end of the rise to the first toe-off; below zero the patient walks off before being upright.
    sits_after_s
        From the last step to sitting down; below zero the patient sits down while still turning.
    turn_s, sit_turn_s
        At least so long the steps of the turn round the cone, and of the one before the chair, take.
    sit_arc_m
        How long the body's way is in the turn before the chair.
    early
        Of each turn, as `Bend.early`.
    is_unwound
        The second turn is to the other side than the first.
    """

    cone_m: float = 3.0
    clearance_m: float = 0.35
    overshoot_m: float = 0.0
    before_chair_m: float = 0.15
    first_step_s: float = 0.4
    sits_after_s: float = 0.3
    turn_s: float = 2.5
    sit_turn_s: float = 2.0
    sit_arc_m: float = 0.5
    early: tuple[float, float] = (0.0, 0.0)
    is_unwound: bool = True
    flaw: CourseFlaw = CourseFlaw.NONE


@dataclass(frozen=True, slots=True)
class FeetInTurns:
    """How feet are put down where the way turns.

    `turned_sd_rad`: how differently they point; `late_s`: so much they lag behind the body's turn; `pivot_share`: so
    much of a foot's turn is made on its ball, before the toes leave the floor.
    """

    turned_sd_rad: float = 0.0
    late_s: float = 0.0
    pivot_share: float = 0.0


ON_THE_PATH = FeetInTurns()


@dataclass(frozen=True, slots=True)
class TimedCourse:
    """Everything one simulated course depends on. Within a session sensors and tissue are the session's.

    `is_joined`: the patient is standing at either end: sits down first and rises last if the test is from a chair; so
    a recording of standing can be played before it and after it.
    `silent_s`: from when to when a site's sensor sends nothing; not within a session.
    `manner_of_side`: sides that walk in another manner than the ordinary one.
    `change`, `changed_side`: what is added to joints and stance, in both legs or in one; time and length stay the
    course's.
    """

    kind: CourseKind
    seed: int = 0
    speed_m_s: float = 1.1
    lap_m: float = 15.0  # of the courses to and fro, from cone to cone
    straight_m: float = 15.0  # of the walk between two tapes, with the ways before and after them
    pauses: int = 0  # how often the patient stops on the way, in courses to and fro
    hesitates: bool = False  # before a turn the patient waits for a moment and takes shorter steps
    slowing: float = 0.0  # by what share the speed falls from the first to the last step
    rise_s: float = 1.2  # how long rising from the chair takes
    silent_s: Mapping[Site, tuple[float, float]] = field(default_factory=dict)
    sites: tuple[Site, ...] = (Site.LEFT_THIGH, Site.RIGHT_THIGH, Site.LEFT_FOOT, Site.RIGHT_FOOT)
    tissue: Tissue = Tissue.RIGID
    rate_hz: float = 100.0
    errors: SensorErrors = field(default_factory=SensorErrors)
    name: str = "course"
    is_restrapped_before: bool = False
    manner_of_side: Mapping[Side, Manner] = field(default_factory=dict)
    change: GaitChange = NO_CHANGE
    changed_side: Side | None = None
    up_and_go: UpAndGo = UpAndGo()
    feet: FeetInTurns = ON_THE_PATH
    is_joined: bool = False


@dataclass(frozen=True, slots=True)
class WalkerSettings:
    """Everything one simulated session depends on.

    Attributes
    ----------
    body_seed
        Whose body it is, where several sessions are of one person; None: one of this session's own.
    clock_late_s
        By how much a site's stamps are later than the truth. Missing sites are on time.
    clock_rate
        How fast a site's clock runs against the truth, 1.02: 2 % fast. At the start of each recording it is right but
        for `clock_late_s`; it samples by its own seconds.
    loss_fraction
        Share of samples lost, in bursts.
    site_loss_fractions
        Sites that lose another share.
    stamp_jitter_s
        Standard deviation of a stamp around the instant of its sample.
    site_rates_hz
        Sites that do not sample at `rate_hz`.
    site_errors
        Sites whose sensor has other errors than `errors`.
    loose_straps
        How loosely sites are strapped: 1 turns a foot's sensor by some degrees in swing and after landing.
    fitted
        Level, knee and foot of the prosthesis on `prosthetic_side`; the session states them. Not stated: a hinge for a
        knee, and a stiff foot.
    stiff_knee_side
        A leg whose knee bends by a quarter only.
    tissue_gain, tissue_gain_sd
        By what share of the true flexion sensors read more at the knee, as the thigh's tissue stays behind the bone:
        mean and standard deviation over legs. On people 0.09 and 0.04 in walking. What was drawn is in the session's
        truth (`JointTruth.sensor_gain`), whose angles stay those of the bones.
    tissue_turn_rad
        How far tissue turns a thigh's sensor about the flexion axis, to and fro in step with the gait, where there is
        tissue; shank and foot by their share. Nothing distinguishes it from flexion. On people it may be 2 to 4 deg.
    variation
        How gait varies beyond the walker's own small spread: `PEOPLE` is as people do.
    """

    seed: int = 0
    recordings: tuple[Standing | FreeMotion | Walk | TimedCourse, ...] = (Standing(), FreeMotion(), Walk())
    sites: tuple[Site, ...] = LEG_SITES
    tissue: Tissue = Tissue.RIGID
    prosthetic_side: Side | None = None
    fitted: Prosthesis = NOT_STATED
    stiff_knee_side: Side | None = None
    rate_hz: float = 100.0
    site_rates_hz: Mapping[Site, float] = field(default_factory=dict)
    rate_kind: RateKind = RateKind.INSTANTANEOUS
    clock_late_s: Mapping[Site, float] = field(default_factory=dict)
    clock_rate: Mapping[Site, float] = field(default_factory=dict)
    loss_fraction: float = 0.0
    site_loss_fractions: Mapping[Site, float] = field(default_factory=dict)
    stamp_jitter_s: float = 0.0
    errors: SensorErrors = SensorErrors()
    site_errors: Mapping[Site, SensorErrors] = field(default_factory=dict)
    loose_straps: Mapping[Site, float] = field(default_factory=dict)
    mounting_sd_m: float = 0.025
    tissue_gain: float = 0.0
    tissue_gain_sd: float = 0.0
    tissue_turn_rad: float = 0.0
    variation: Variation = Variation()
    body_seed: int | None = None

    @property
    def body(self) -> int:
        """The seed of the body."""
        return self.seed if self.body_seed is None else self.body_seed

    def errors_of(self, site: Site) -> SensorErrors:
        """The errors of one site's sensor."""
        return self.site_errors.get(site, self.errors)


@dataclass(frozen=True, slots=True)
class Leg:
    """One leg of the patient. Segment axes: x forward, y left, z up in neutral stance, on both legs.

    A segment's origin is its proximal joint: hip, knee, ankle. `knee_axis` and `ankle_axis` (unit, clinical sign) are
    the same vector in both their segments' axes. `foot` is a prosthetic one, None where the ankle is the patient's.
    """

    side: Side
    thigh_m: float
    shank_m: float
    knee_axis: FloatArray
    ankle_axis: FloatArray
    standing_knee_rad: float
    knee_gain: float
    ankle_gain: float
    toe_out_rad: float
    knee_rotation_per_flexion: float
    foot: ProstheticFoot | None = None
    fitted: Prosthesis = NOT_STATED
    prosthesis: ProsthesisSetting = AS_BUILT

    @property
    def outward(self) -> float:
        """+1 where outward is +y, the left leg; -1 on the right."""
        return 1.0 if self.side is Side.LEFT else -1.0

    @property
    def is_polycentric(self) -> bool:
        return self.fitted.knee is KneeKind.POLYCENTRIC

    @property
    def has_own_knee(self) -> bool:
        """Whether there is a prosthesis, and the knee above it is the patient's."""
        return self.fitted.level is not None and not self.fitted.has_knee


HEEL_M = np.array([-0.05, 0.0, -0.08])  # lowest points of the foot, from the ankle
TOE_M = np.array([0.15, 0.0, -0.08])

SHORT_FOOT_GAIN = 0.6  # of the push-off, where a part of the foot is left

SENSOR_PLACES_M = {  # from the proximal joint, y outward: side of the thigh, front of the shin, instep
    Segment.THIGH: np.array([0.02, 0.07, -0.22]),
    Segment.SHANK: np.array([0.04, 0.03, -0.20]),
    Segment.FOOT: np.array([0.09, 0.0, -0.03]),
    Segment.PELVIS: np.array([-0.15, 0.0, 0.08]),  # on the sacrum, from the middle between both hips
}


def set_up(leg: Leg, setting: ProsthesisSetting) -> Leg:
    """The leg with its prosthesis set so; the same leg where it is none, or has no foot to be set."""
    if leg.foot is None:
        return leg
    if setting == AS_BUILT:
        setting = built(leg.fitted)
    if leg.has_own_knee:
        setting = with_own_knee(setting)
    if setting == AS_BUILT:
        return leg
    return replace(leg, prosthesis=setting, shank_m=leg.shank_m + 1e-3 * setting.height_mm)


def make_leg(settings: WalkerSettings, side: Side) -> Leg:
    """One leg of the body that the settings' seed gives, in segment axes."""
    rng = np.random.default_rng([settings.body, 1, list(Side).index(side)])
    is_prosthetic = settings.prosthetic_side is side
    fitted = settings.fitted if is_prosthetic else NOT_STATED
    foot = foot_of(fitted) if is_prosthetic else None
    has_own_knee = not is_prosthetic or (fitted.level is not None and not fitted.has_knee)
    has_weak_ankle = is_prosthetic and foot is None
    knee_axis = np.array([0.0, 1.0, 0.0]) + rng.normal(0.0, np.tan(np.deg2rad(3.0)), 3) * [1, 0, 1]
    # the malleoli: the lateral one is lower and further back (Isman & Inman 1969: 80 deg to the tibia, 84 to the foot)
    outward = 1.0 if side is Side.LEFT else -1.0
    ankle_axis = np.array([outward * 0.08, -1.0, outward * 0.10]) + rng.normal(0.0, 0.04, 3) * [1, 0, 1]
    has_rotation = settings.tissue is not Tissue.RIGID and has_own_knee
    return Leg(
        side=side,
        thigh_m=0.43 * rng.normal(1.0, 0.01),
        shank_m=0.43 * rng.normal(1.0, 0.01),
        knee_axis=knee_axis / np.linalg.norm(knee_axis),
        ankle_axis=ankle_axis / np.linalg.norm(ankle_axis),
        standing_knee_rad=np.deg2rad(np.clip(rng.normal(4.0, 2.0), 0.5, 9.0)),
        knee_gain=rng.normal(1.0, 0.03) * (0.25 if settings.stiff_knee_side is side else 1.0),
        ankle_gain=rng.normal(1.0, 0.05) * (SHORT_FOOT_GAIN if has_weak_ankle else 1.0),
        toe_out_rad=outward * np.deg2rad(rng.normal(7.0, 2.0)),
        # internal rotation turns the front of the shank inward: about -z on the left, +z on the right
        knee_rotation_per_flexion=-outward * 0.1 if has_rotation else 0.0,
        foot=foot,
        fitted=fitted,
    )
