"""What is a measure called that goals and a patient's course are of? Its name, its unit, and how it is written."""

from enum import Enum, auto

from app.wording.timed_tests import name_of_test
from app.wording.translation import figure_text, later, side_name, tr
from core.goals import Goal, GoalOf
from core.timed.measures import PROTOCOLS

NAMES = {
    "knee_stance_to_swing_deg": later("Knee, stance to swing"),
    "knee_while_loading_deg": later("Knee while loading"),
    "knee_range_deg": later("Knee range"),
    "ankle_push_off_deg": later("Ankle push-off"),
    "ankle_rocker_deg": later("Ankle rocker"),
    "ankle_range_deg": later("Ankle range"),
    "hip_range_deg": later("Hip range"),
    "pelvis_obliquity_range_deg": later("Pelvis, obliquity range"),
    "stance_percent": later("Stance"),
    "stride_length_m": later("Stride length"),
    "speed_m_s": later("Walking speed"),
    "cadence_steps_min": later("Cadence"),
}
LESS = "L \N{MINUS SIGN} R"
NO_BREAK = "\N{NO-BREAK SPACE}"


def measure_name(column: str, *, is_between: bool = False) -> str:
    """As it heads a row: "Stance L - R"."""
    name = _name(column)
    return tr("{measure} {less}").format(measure=name, less=LESS) if is_between else name


def spoken_name(column: str, *, is_between: bool = False) -> str:
    """As it is read out."""
    name = _name(column)
    return tr("{measure} of the left leg less that of the right").format(measure=name) if is_between else name


def unit_name(column: str) -> str:
    """The unit by itself."""
    return {
        _Unit.DEGREES: tr("degrees"),
        _Unit.PERCENT: tr("% of stride"),
        _Unit.METRES: "m",
        _Unit.DISTANCE: "m",
        _Unit.SPEED: "m/s",
        _Unit.CADENCE: tr("steps/min"),
        _Unit.SECONDS: tr("seconds"),
    }[_unit(column)]


def spoken_value(column: str, value: str) -> str:
    """A number with its unit, as it is read out."""
    said = {
        _Unit.DEGREES: tr("{value} degrees"),
        _Unit.PERCENT: tr("{value} percent of the stride"),
        _Unit.METRES: tr("{value} metres"),
        _Unit.DISTANCE: tr("{value} metres"),
        _Unit.SPEED: tr("{value} metres per second"),
        _Unit.CADENCE: tr("{value} steps per minute"),
        _Unit.SECONDS: tr("{value} seconds"),
    }
    return said[_unit(column)].format(value=value)


def short_unit(column: str) -> str:
    """The unit as it follows a number, with the space before it."""
    unit = _unit(column)
    if unit is _Unit.DEGREES:
        return "°"
    signs = {_Unit.PERCENT: "%", _Unit.SECONDS: "s"}
    return NO_BREAK + (signs.get(unit) or unit_name(column))


def decimals(column: str) -> int:
    """Of its values where there is room for few: those that the error leaves a meaning."""
    few = {_Unit.PERCENT: 1, _Unit.METRES: 2, _Unit.SPEED: 2, _Unit.SECONDS: 1}
    return few.get(_unit(column), 0)


def least_span(column: str) -> float:
    """Smaller changes are not blown up to a whole plot."""
    return {
        _Unit.DEGREES: 20.0,
        _Unit.PERCENT: 6.0,
        _Unit.METRES: 0.3,
        _Unit.DISTANCE: 40.0,
        _Unit.SPEED: 0.4,
        _Unit.CADENCE: 20.0,
        _Unit.SECONDS: 6.0,
    }[_unit(column)]


def limit(goal: Goal) -> str:
    """The value of a goal with its unit: "60°"; decimals that say nothing are left out but of metres and speed."""
    whole = (_Unit.DEGREES, _Unit.PERCENT, _Unit.SECONDS)
    count = max(1, decimals(goal.column)) if _unit(goal.column) in whole else decimals(goal.column)
    number = figure_text(goal.value, f".{count}f")
    return (number.removesuffix(".0") if count == 1 else number) + short_unit(goal.column)


def wanted(goal: Goal) -> str:
    """What the goal asks for: "at least 60°", "at most 2 % apart"."""
    if goal.of is GoalOf.BETWEEN:
        return tr("at most {value} apart").format(value=limit(goal))
    return (tr("at most {value}") if goal.is_at_most else tr("at least {value}")).format(value=limit(goal))


def whose_name(of: GoalOf) -> str:
    """Whose figure a goal is of; empty of the walk, which has one figure only."""
    if of.side is not None:
        return side_name(of.side)
    return tr("between the legs") if of is GoalOf.BETWEEN else ""


def goal_in_words(goal: Goal) -> str:
    """The whole goal: "Knee, stance to swing, left: at least 60°"."""
    who = ", ".join(filter(None, [_name(goal.column), whose_name(goal.of)]))
    return tr("{who}: {wanted}").format(who=who, wanted=wanted(goal))


class _Unit(Enum):
    DEGREES = auto()
    PERCENT = auto()
    METRES = auto()
    DISTANCE = auto()  # metres of a whole test
    SPEED = auto()
    CADENCE = auto()
    SECONDS = auto()


_ENDS = {  # of columns; the longer before those that they end with
    "_deg": _Unit.DEGREES,
    "_percent": _Unit.PERCENT,
    "_m_s": _Unit.SPEED,
    "_distance_m": _Unit.DISTANCE,
    "_m": _Unit.METRES,
    "_steps_min": _Unit.CADENCE,
    "_s": _Unit.SECONDS,
}


def _unit(column: str) -> _Unit:
    return next(unit for end, unit in _ENDS.items() if column.endswith(end))


def _name(column: str) -> str:
    return name_of_test(PROTOCOLS[column]) if column in PROTOCOLS else tr(NAMES[column])
