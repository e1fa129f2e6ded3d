"""What is a measure called that goals and a patient's course are of? Its name, its unit, and how it is written."""

from app.wording import later, side_name, tr
from core.goals import Goal, GoalOf

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
    name = tr(NAMES[column])
    return tr("{measure} {less}").format(measure=name, less=LESS) if is_between else name


def spoken_name(column: str, *, is_between: bool = False) -> str:
    """As it is read out."""
    name = tr(NAMES[column])
    return tr("{measure} of the left leg less that of the right").format(measure=name) if is_between else name


def unit_name(column: str) -> str:
    """The unit by itself."""
    return {"deg": tr("degrees"), "percent": tr("% of stride"), "m": "m", "s": "m/s", "min": tr("steps/min")}[
        _end(column)
    ]


def spoken_value(column: str, value: str) -> str:
    """A number with its unit, as it is read out."""
    said = {
        "deg": tr("{value} degrees"),
        "percent": tr("{value} percent of the stride"),
        "m": tr("{value} metres"),
        "s": tr("{value} metres per second"),
        "min": tr("{value} steps per minute"),
    }
    return said[_end(column)].format(value=value)


def short_unit(column: str) -> str:
    """The unit as it follows a number, with the space before it."""
    units = {"deg": "°", "percent": f"{NO_BREAK}%", "m": f"{NO_BREAK}m", "s": f"{NO_BREAK}m/s"}
    return units.get(_end(column)) or f"{NO_BREAK}{tr('steps/min')}"


def decimals(column: str) -> int:
    """Of its values where there is room for few: those that the error leaves a meaning."""
    return {"deg": 0, "percent": 1, "m": 2, "s": 2, "min": 0}[_end(column)]


def least_span(column: str) -> float:
    """Smaller changes are not blown up to a whole plot."""
    return {"deg": 20.0, "percent": 6.0, "m": 0.3, "s": 0.4, "min": 20.0}[_end(column)]


def limit(goal: Goal) -> str:
    """The value of a goal with its unit: "60°"; decimals that say nothing are left out of degrees and percent."""
    count = max(1, decimals(goal.column)) if _end(goal.column) in ("deg", "percent") else decimals(goal.column)
    number = f"{goal.value:.{count}f}"
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
    who = ", ".join(filter(None, [tr(NAMES[goal.column]), whose_name(goal.of)]))
    return tr("{who}: {wanted}").format(who=who, wanted=wanted(goal))


def _end(column: str) -> str:
    return column.rsplit("_", 1)[1]
