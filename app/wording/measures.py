"""Names of the measures that goals and a patient's course are of.

Each has its name, its unit, and how it is written.
"""

from app.wording.body import side_name
from app.wording.timed_tests import name_of_test
from app.wording.translation import figure_text, later, tr, within_sentence
from core.goals import Goal, GoalOf
from core.parameters import Unit, unit_of
from core.timed.measures import PROTOCOLS

# in the order of lists
NAMES = {
    "speed_m_s": later("Walking speed"),
    "stride_length_m": later("Stride length"),
    "stride_time_s": later("Stride time"),
    "step_time_s": later("Step time"),
    "cadence_steps_min": later("Cadence"),
    "stance_percent": later("Stance"),
    "swing_percent": later("Swing"),
    "double_support_percent": later("Double support"),
    "clearance_m": later("Foot clearance (sensor)"),
    "knee_range_deg": later("Knee range of motion"),
    "knee_stance_to_swing_deg": later("Knee flexion, stance to swing"),
    "knee_while_loading_deg": later("Knee flexion, loading response"),
    "knee_straightening_deg": later("Knee extension, mid-stance"),
    "knee_at_initial_contact_deg": later("Knee at initial contact"),
    "knee_loading_peak_deg": later("Peak knee flexion, loading"),
    "knee_stance_minimum_deg": later("Least knee flexion, stance"),
    "knee_swing_peak_deg": later("Peak knee flexion, swing"),
    "knee_swing_peak_percent": later("Time of peak knee flexion, swing"),
    "ankle_range_deg": later("Ankle range of motion"),
    "ankle_push_off_deg": later("Ankle plantarflexion, push-off"),
    "ankle_rocker_deg": later("Ankle dorsiflexion, stance"),
    "ankle_heel_rocker_deg": later("Ankle plantarflexion, loading response"),
    "ankle_toes_lifted_deg": later("Ankle dorsiflexion, swing"),
    "ankle_at_initial_contact_deg": later("Ankle at initial contact"),
    "ankle_loading_plantarflexion_deg": later("Peak plantarflexion, loading"),
    "ankle_stance_dorsiflexion_deg": later("Peak dorsiflexion, stance"),
    "ankle_push_off_plantarflexion_deg": later("Peak plantarflexion, push-off"),
    "ankle_swing_dorsiflexion_deg": later("Peak dorsiflexion, swing"),
    "hip_range_deg": later("Hip range of motion"),
    "hip_flexion_peak_deg": later("Peak hip flexion"),
    "hip_extension_peak_deg": later("Peak hip extension"),
    "hip_abduction_range_deg": later("Hip abduction range of motion"),
    "hip_abduction_peak_deg": later("Peak hip abduction"),
    "hip_adduction_peak_deg": later("Peak hip adduction"),
    "pelvis_obliquity_range_deg": later("Pelvic obliquity range"),
    "pelvis_drop_deg": later("Pelvic drop in swing"),
    "pelvis_rotation_range_deg": later("Pelvic rotation range"),
    "pelvis_tilt_range_deg": later("Pelvic tilt range"),
    "pelvis_lean_deg": later("Pelvic tilt, mean"),
    "knee_terminal_extension_deg": later("Least knee flexion, late swing"),
    "knee_extended_before_contact_percent": later("Knee extended before contact"),
    "foot_heel_rise_deg": later("Heel rise"),
    "foot_pitch_at_contact_deg": later("Foot angle at contact"),
    "foot_flat_percent": later("Foot flat"),
    "shank_to_foot_in_swing_deg": later("Foot-to-shank angle, swing"),
    "shank_over_flat_foot_deg": later("Shank forward tilt, foot flat"),
}
WITH_UNIT = {  # as they head rows of figures that have no unit of their own
    "stance_percent": later("Stance (% gait cycle)"),
    "stride_length_m": later("Stride length, m"),
    "speed_m_s": later("Walking speed, m/s"),
    "cadence_steps_min": later("Cadence, steps/min"),
    "foot_flat_percent": later("Foot flat (% gait cycle)"),
    "knee_extended_before_contact_percent": later("Knee extended before contact (% gait cycle)"),
}
LESS = "L \N{MINUS SIGN} R"
NO_BREAK = "\N{NO-BREAK SPACE}"


def measure_name(column: str, *, is_between: bool = False) -> str:
    """As it heads a row: "Stance L - R"."""
    name = _name(column)
    return tr("{measure} {less}").format(measure=name, less=LESS) if is_between else name


def name_in_sentence(column: str) -> str:
    """As it is written inside a sentence."""
    return within_sentence(_name(column)) if column in NAMES else _name(column)


def name_with_unit(column: str) -> str:
    """As it heads figures that have no unit of their own: "Stance (% gait cycle)", "Step time, s"."""
    if column in WITH_UNIT:
        return tr(WITH_UNIT[column])
    if column in PROTOCOLS:
        return with_unit(_name(column), short_unit(column).strip())
    return with_unit(_name(column), unit_symbol(_unit(column)))


def with_unit(name: str, unit: str) -> str:
    """A name and its unit; a share is that of the gait cycle."""
    pattern = tr("{measure} (% gait cycle)") if unit == Unit.PERCENT.symbol else tr("{measure}, {unit}")
    return pattern.format(measure=name, unit=unit)


def spoken_name(column: str, *, is_between: bool = False) -> str:
    """As it is read out."""
    name = _name(column)
    return tr("{measure}, left minus right").format(measure=name) if is_between else name


def unit_name(column: str) -> str:
    """The unit by itself."""
    return {
        Unit.DEGREES: tr("degrees"),
        Unit.PERCENT: tr("% gait cycle"),
        Unit.METRES: "m",
        Unit.SPEED: "m/s",
        Unit.CADENCE: tr("steps/min"),
        Unit.SECONDS: tr("seconds"),
    }[_unit(column)]


def spoken_value(column: str, value: str) -> str:
    """A number with its unit, as it is read out."""
    stated = {
        Unit.DEGREES: tr("{value} degrees"),
        Unit.PERCENT: tr("{value} percent of the gait cycle"),
        Unit.METRES: tr("{value} metres"),
        Unit.SPEED: tr("{value} metres per second"),
        Unit.CADENCE: tr("{value} steps per minute"),
        Unit.SECONDS: tr("{value} seconds"),
    }
    return stated[_unit(column)].format(value=value)


def short_unit(column: str) -> str:
    """The unit as it follows a number, with the space before it."""
    unit = _unit(column)
    if unit is Unit.DEGREES:
        return "°"
    signs = {Unit.PERCENT: "%", Unit.SECONDS: "s"}
    return NO_BREAK + (signs.get(unit) or unit_name(column))


def decimals(column: str) -> int:
    """Of its values where there is room for few: those that the error leaves a meaning."""
    if column.endswith("_distance_m"):
        return 0
    few = {Unit.PERCENT: 1, Unit.METRES: 2, Unit.SPEED: 2, Unit.SECONDS: 1}
    return few.get(_unit(column), 0)


def least_span(column: str) -> float:
    """Smaller changes are not blown up to a whole plot."""
    if column.endswith("_distance_m"):  # of a whole test
        return 40.0
    return {
        Unit.DEGREES: 20.0,
        Unit.PERCENT: 6.0,
        Unit.METRES: 0.3,
        Unit.SPEED: 0.4,
        Unit.CADENCE: 20.0,
        Unit.SECONDS: 6.0,
    }[_unit(column)]


def limit(goal: Goal) -> str:
    """The value of a goal with its unit: "60°"; decimals that say nothing are left out but of metres and speed."""
    return _number(goal) + short_unit(goal.column)


def bare_limit(goal: Goal) -> str:
    """The same beside a value that has its unit: "1.10", but "55°"."""
    return _number(goal) + ("°" if _unit(goal.column) is Unit.DEGREES else "")


def _number(goal: Goal) -> str:
    whole = (Unit.DEGREES, Unit.PERCENT, Unit.SECONDS)
    count = max(1, decimals(goal.column)) if _unit(goal.column) in whole else decimals(goal.column)
    number = figure_text(goal.value, f".{count}f")
    return number.removesuffix(".0").removesuffix(",0") if count == 1 else number


def required(goal: Goal) -> str:
    """What the goal asks for: "at least 60°", "at most 2 % apart"."""
    if goal.of is GoalOf.BETWEEN:
        return tr("difference at most {value}").format(value=limit(goal))
    return (tr("at most {value}") if goal.is_at_most else tr("at least {value}")).format(value=limit(goal))


def whose_name(of: GoalOf) -> str:
    """Whose figure a goal is of; empty of the walk, which has one figure only."""
    if of.side is not None:
        return side_name(of.side)
    return tr("left vs right") if of is GoalOf.BETWEEN else ""


def goal_in_words(goal: Goal) -> str:
    """The whole goal: "Knee, stance to swing, left: at least 60°"."""
    who = ", ".join(filter(None, [_name(goal.column), whose_name(goal.of)]))
    return tr("{who}: {required}").format(who=who, required=required(goal))


def unit_symbol(unit: Unit) -> str:
    return tr("steps/min") if unit is Unit.CADENCE else unit.symbol


def _unit(column: str) -> Unit:
    found = unit_of(column)
    assert found is not None, column
    return found


def _name(column: str) -> str:
    return name_of_test(PROTOCOLS[column]) if column in PROTOCOLS else tr(NAMES[column])
