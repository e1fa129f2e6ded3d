"""One registry of the quantities of a walk: what each is, the verdict it rests on, its error class and its unit.

A new quantity is one entry here and its function. Its name for people is in `app/wording/measures.py`, by column.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from core.body import JointKind


class Unit(StrEnum):
    """Units by the end of a column's name."""

    CADENCE = "_steps_min"
    SPEED = "_m_s"
    PERCENT = "_percent"
    DEGREES = "_deg"
    SECONDS = "_s"
    MILLIMETRES = "_mm"
    METRES = "_m"

    @property
    def symbol(self) -> str:
        """As people write it."""
        return _SYMBOLS.get(self, self.value.removeprefix("_"))

    @property
    def in_files(self) -> str:
        """As files of text have it."""
        return "deg" if self is Unit.DEGREES else self.symbol

    @property
    def decimals(self) -> int:
        return {Unit.CADENCE: 0, Unit.PERCENT: 1, Unit.DEGREES: 1}.get(self, 2)


_SYMBOLS = {Unit.CADENCE: "steps/min", Unit.SPEED: "m/s", Unit.PERCENT: "%", Unit.DEGREES: "\N{DEGREE SIGN}"}


class QuantityClass(StrEnum):
    """What a figure needs to be known. A mirrored curve would not have the same `PEAK_TIME` or `EXCURSION`."""

    SHAPE = "shape"
    PEAK_TIME = "peak_time"
    EXCURSION = "excursion"
    HEIGHT = "height"
    TIMING = "timing"
    DISTANCE = "distance"
    BETWEEN = "between"


class QuantityKind(StrEnum):
    """Quantities that share an error."""

    KNEE_SHAPE = "knee_shape"
    ANKLE_SHAPE = "ankle_shape"
    KNEE_HEIGHT = "knee_height"
    KNEE_STRAIGHTENING = "knee_straightening"
    ANKLE_HEIGHT = "ankle_height"
    STANCE = "stance"
    TIME = "time"
    SPEED = "speed"
    LENGTH = "length"
    SEGMENT_SHAPE = "segment_shape"
    SEGMENT_HEIGHT = "segment_height"
    FOOT_PITCH = "foot_pitch"
    HEEL_RISE = "heel_rise"
    FOOT_FLAT = "foot_flat"
    SET_ANGLE = "set_angle"
    KNEE_TIMING = "knee_timing"


class ParameterFile(StrEnum):
    """The file that holds a quantity of each stride; `WALK`: both legs make it together."""

    STRIDES = "strides"
    PEAKS = "peaks"
    PELVIS = "pelvis"
    """Columns that strides.csv has more where a sensor is worn on the pelvis."""
    FITTING = "fitting"
    WALK = "walk"


@dataclass(frozen=True, slots=True)
class PeakWindow:
    """Where in a stride a peak is looked for, percent, and whether it is a maximum."""

    name: str
    first: int
    last: int
    is_maximum: bool


@dataclass(frozen=True, slots=True)
class Excursion:
    """How far a joint moves between two extremes of a stride; None: from, or to, initial contact.

    Excursions need no zero and repeat better than peaks (Ferber et al. 2002, J Orthop Res 20:1139, runners).
    """

    name: str
    high: PeakWindow | None
    low: PeakWindow | None


KNEE_WINDOWS = (
    PeakWindow("knee_loading_peak", 5, 30, True),
    PeakWindow("knee_stance_minimum", 25, 60, False),
    PeakWindow("knee_swing_peak", 55, 90, True),
)
ANKLE_WINDOWS = (
    PeakWindow("ankle_loading_plantarflexion", 0, 20, False),
    PeakWindow("ankle_stance_dorsiflexion", 20, 60, True),
    PeakWindow("ankle_push_off_plantarflexion", 50, 80, False),
    PeakWindow("ankle_swing_dorsiflexion", 70, 95, True),
)
PEAK_WINDOWS: Mapping[JointKind, tuple[PeakWindow, ...]] = {
    JointKind.HIP: (),  # its peaks are those of the whole stride
    JointKind.KNEE: KNEE_WINDOWS,
    JointKind.ANKLE: ANKLE_WINDOWS,
}
_LOADING, _STANCE, _SWING = KNEE_WINDOWS
_HEEL, _OVER_FOOT, _OFF, _CLEARING = ANKLE_WINDOWS
EXCURSIONS = (
    Excursion("knee_while_loading", _LOADING, None),
    Excursion("knee_straightening", _LOADING, _STANCE),
    Excursion("knee_stance_to_swing", _SWING, _STANCE),
    Excursion("ankle_heel_rocker", None, _HEEL),
    Excursion("ankle_rocker", _OVER_FOOT, _HEEL),
    Excursion("ankle_push_off", _OVER_FOOT, _OFF),
    Excursion("ankle_toes_lifted", _CLEARING, _OFF),
)


@dataclass(frozen=True, slots=True)
class Parameter:
    """One quantity of a stride or walk; its column ends in its unit.

    `definition`: for the reader of a file; empty where `core.verdicts.fitting`, a window or an excursion gives it.
    `most`: what a goal of it may be at most: wider than any walk, to catch what was typed into the wrong field. None:
    no goal can be of it. Absolute angles have none, since each visit has a zero of its own.
    """

    column: str
    file: ParameterFile
    rests_on: QuantityClass  # what has to be known for it
    error: QuantityKind | None = None  # whose error of a difference it has; None: no difference of it is judged
    definition: str = ""
    sign: str = ""  # which direction is positive, where it is not the joint's flexion
    most: float | None = None
    has_index: bool = False  # whether a symmetry index means something: positive figures only


_C, _E = QuantityClass, QuantityKind
_RANGE = "largest less smallest angle of the stride"


def _stride(
    column: str,
    rests_on: QuantityClass,
    error: QuantityKind | None,
    definition: str = "",
    *,
    most: float | None = None,
    has_index: bool = False,
) -> Parameter:
    return Parameter(column, ParameterFile.STRIDES, rests_on, error, definition, most=most, has_index=has_index)


def _peak(excursion: Excursion, most: float | None = None) -> Parameter:
    error = _E.KNEE_SHAPE if excursion.name.startswith("knee") else _E.ANKLE_SHAPE
    if excursion.name == "knee_straightening":  # its two ends are near one another, and people repeat it less well
        error = _E.KNEE_STRAIGHTENING
    return Parameter(f"{excursion.name}{Unit.DEGREES}", ParameterFile.PEAKS, _C.EXCURSION, error, most=most)


def _pelvis(
    column: str, rests_on: QuantityClass, definition: str, sign: str = "", most: float | None = None
) -> Parameter:
    return Parameter(column, ParameterFile.PELVIS, rests_on, None, definition, sign, most)


def _fitting(column: str, rests_on: QuantityClass, error: QuantityKind) -> Parameter:
    return Parameter(column, ParameterFile.FITTING, rests_on, error)


_MOST = {"knee_while_loading": 60.0, "knee_stance_to_swing": 120.0, "ankle_rocker": 90.0, "ankle_push_off": 90.0}

# in the order of the files' columns
REGISTRY = (
    _stride(
        "stride_time_s", _C.TIMING, _E.TIME, "from an initial contact to the next of the same foot", has_index=True
    ),
    _stride(
        "step_time_s",
        _C.BETWEEN,
        _E.TIME,
        "from the other foot's initial contact to this foot's, which ends the stride",
        has_index=True,
    ),
    _stride(
        "stance_percent",
        _C.TIMING,
        _E.STANCE,
        "share of the stride from initial contact to toe-off",
        most=95.0,
        has_index=True,
    ),
    _stride(
        "swing_percent", _C.TIMING, _E.STANCE, "share of the stride from toe-off to initial contact", has_index=True
    ),
    _stride(
        "stride_length_m",
        _C.DISTANCE,
        _E.LENGTH,
        "how far the foot travels in the swing that ends the stride",
        most=3.0,
        has_index=True,
    ),
    _stride("speed_m_s", _C.DISTANCE, _E.SPEED, "stride length by stride time", most=3.0),
    _stride("clearance_m", _C.DISTANCE, None, "how high the foot's sensor rises in swing, not the toe"),
    _stride("knee_at_initial_contact_deg", _C.HEIGHT, _E.KNEE_HEIGHT, "angle at initial contact"),
    _stride("knee_loading_peak_deg", _C.HEIGHT, _E.KNEE_HEIGHT),
    _stride("knee_stance_minimum_deg", _C.HEIGHT, _E.KNEE_HEIGHT),
    _stride("knee_swing_peak_deg", _C.HEIGHT, _E.KNEE_HEIGHT),
    _stride(
        "knee_swing_peak_percent", _C.PEAK_TIME, None, "when in the stride the largest angle from 55 to 90 % comes"
    ),
    _stride("knee_range_deg", _C.SHAPE, _E.KNEE_SHAPE, _RANGE, most=140.0, has_index=True),
    _stride("ankle_at_initial_contact_deg", _C.HEIGHT, _E.ANKLE_HEIGHT, "angle at initial contact"),
    _stride("ankle_loading_plantarflexion_deg", _C.HEIGHT, _E.ANKLE_HEIGHT),
    _stride("ankle_stance_dorsiflexion_deg", _C.HEIGHT, _E.ANKLE_HEIGHT),
    _stride("ankle_push_off_plantarflexion_deg", _C.HEIGHT, _E.ANKLE_HEIGHT),
    _stride("ankle_swing_dorsiflexion_deg", _C.HEIGHT, _E.ANKLE_HEIGHT),
    _stride("ankle_range_deg", _C.SHAPE, _E.ANKLE_SHAPE, _RANGE, most=120.0, has_index=True),
    *(_peak(excursion, _MOST.get(excursion.name)) for excursion in EXCURSIONS),
    _fitting("knee_terminal_extension_deg", _C.HEIGHT, _E.KNEE_HEIGHT),
    _fitting("knee_extended_before_contact_percent", _C.PEAK_TIME, _E.KNEE_TIMING),
    _fitting("foot_flat_percent", _C.TIMING, _E.FOOT_FLAT),
    _fitting("foot_pitch_at_contact_deg", _C.DISTANCE, _E.FOOT_PITCH),  # by the motion of the foot, as its length is
    _fitting("foot_heel_rise_deg", _C.DISTANCE, _E.HEEL_RISE),
    _fitting("shank_heel_rocker_deg", _C.EXCURSION, _E.SEGMENT_SHAPE),
    _fitting("shank_over_flat_foot_deg", _C.EXCURSION, _E.SEGMENT_SHAPE),
    _fitting("shank_forefoot_rocker_deg", _C.EXCURSION, _E.SEGMENT_SHAPE),
    *(
        _fitting(f"{segment}_at_{instant}_deg", _C.HEIGHT, _E.SEGMENT_HEIGHT)
        for segment in ("shank", "thigh")
        for instant in ("initial_contact", "mid_stance", "toe_off")
    ),
    _fitting("shank_to_foot_in_swing_deg", _C.HEIGHT, _E.SET_ANGLE),
    _pelvis("hip_range_deg", _C.SHAPE, "largest less smallest hip flexion of the stride", most=140.0),
    _pelvis("hip_flexion_peak_deg", _C.HEIGHT, "largest hip flexion of the stride, from standing", "flexion positive"),
    _pelvis(
        "hip_extension_peak_deg", _C.HEIGHT, "largest hip extension of the stride, from standing", "extension positive"
    ),
    _pelvis("pelvis_obliquity_range_deg", _C.SHAPE, "largest less smallest obliquity of the stride", most=60.0),
    _pelvis(
        "pelvis_drop_deg",
        _C.HEIGHT,
        "how far the side of this leg drops below the other in its swing, from standing",
        "dropping positive",
    ),
    _pelvis("pelvis_rotation_range_deg", _C.SHAPE, "largest less smallest rotation of the stride; empty in turns"),
    _pelvis("hip_abduction_range_deg", _C.SHAPE, "largest less smallest hip abduction of the stride"),
    _pelvis(
        "hip_abduction_peak_deg", _C.HEIGHT, "largest hip abduction of the stride, from standing", "abduction positive"
    ),
    _pelvis(
        "hip_adduction_peak_deg", _C.HEIGHT, "largest hip adduction of the stride, from standing", "adduction positive"
    ),
    _pelvis(
        "pelvis_tilt_range_deg",
        _C.SHAPE,
        "largest less smallest tilt of the stride; empty where its mean is 5 deg or less",
    ),
    _pelvis("pelvis_lean_deg", _C.HEIGHT, "mean tilt over the stride, from standing", "forward positive"),
    Parameter("cadence_steps_min", ParameterFile.WALK, _C.TIMING, _E.TIME, most=240.0),
    Parameter("double_support_percent", ParameterFile.WALK, _C.TIMING),
)
BY_COLUMN = {parameter.column: parameter for parameter in REGISTRY}

KNEE, PUSH_OFF, STANCE, SPEED = "knee_stance_to_swing_deg", "ankle_push_off_deg", "stance_percent", "speed_m_s"
"""Knee and ankle are represented by excursions, which need no zero."""
KNEE_RANGE, ANKLE_RANGE = "knee_range_deg", "ankle_range_deg"
CADENCE = "cadence_steps_min"  # of both legs; of one, two steps in each of its strides
STRIDE_LENGTH = "stride_length_m"  # in walking straight on both feet travel equally far: never compared between legs
STEP_TIME = "step_time_s"

MOVEMENTS: Mapping[JointKind, tuple[str, ...]] = {  # of a joint, without a zero, as tables have them
    JointKind.KNEE: (KNEE, "knee_while_loading_deg", "knee_straightening_deg", KNEE_RANGE),
    JointKind.HIP: ("hip_range_deg", "hip_abduction_range_deg"),
    JointKind.ANKLE: (PUSH_OFF, "ankle_rocker_deg", "ankle_heel_rocker_deg", "ankle_toes_lifted_deg", ANKLE_RANGE),
}
FOOT = ("foot_pitch_at_contact_deg", "foot_heel_rise_deg")  # what people who came twice repeat best
BETWEEN_LEGS = (  # of hips no error of a difference is known: it is shown in tables and never in a sentence
    *MOVEMENTS[JointKind.KNEE], *MOVEMENTS[JointKind.ANKLE], STANCE, STEP_TIME, *FOOT, "hip_range_deg"
)  # fmt: skip
COMPARED = (  # between walks, visits and legs, as tables have them; those with `most` as goals have them
    *(KNEE, "knee_while_loading_deg", "knee_swing_peak_deg", KNEE_RANGE),
    *(PUSH_OFF, "ankle_rocker_deg", ANKLE_RANGE),
    *("hip_range_deg", "hip_extension_peak_deg", "pelvis_obliquity_range_deg", "pelvis_drop_deg"),
    *(STANCE, *FOOT, STRIDE_LENGTH, SPEED, CADENCE),
)
OF_WALK = (SPEED, CADENCE)  # both legs have the same
ALIGNED = (  # by an alignment: the bench names those larger than their error
    *("knee_terminal_extension_deg", "knee_extended_before_contact_percent", "foot_heel_rise_deg"),
    *("foot_pitch_at_contact_deg", "foot_flat_percent", "shank_over_flat_foot_deg"),
)


def columns_of(*files: ParameterFile) -> tuple[str, ...]:
    """Columns of the quantities that these files hold, in their order there."""
    return tuple(one.column for file in files for one in REGISTRY if one.file is file)


def unit_of(column: str) -> Unit | None:
    """The unit that a column's name ends in; None for a name without one."""
    return next((unit for unit in Unit if f"_{column}".endswith(unit)), None)
