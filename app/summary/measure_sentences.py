"""A measure's name, unit and decimals inside a sentence, and how it differs between the legs."""

from app.summary.facts import Facts, role
from app.summary.numbers_in_words import fixed
from app.summary.panels import peak_name
from app.wording.measures import IN_SENTENCE, decimals, short_unit, unit_symbol
from app.wording.timed_tests import name_of_test
from app.wording.translation import capitalised, tr
from core import parameters
from core.parameters import Unit, unit_of
from core.timed.measures import PROTOCOLS
from core.verdicts.measurement_error import Difference
from core.verdicts.quantities import joint_of as joint_of_column


def unit_and_decimals(column: str) -> tuple[str, int]:
    """A column's unit as it follows a number, and its decimals."""
    if column in PROTOCOLS:
        return short_unit(column), decimals(column)
    unit = unit_of(column)
    assert unit is not None, column
    space = "" if unit is Unit.DEGREES else "\N{NO-BREAK SPACE}"
    return f"{space}{unit_symbol(unit)}", unit.decimals


def measure_in_words(column: str) -> str:
    """A column's name inside a sentence."""
    if column in PROTOCOLS:
        return name_of_test(PROTOCOLS[column])
    if column in IN_SENTENCE:
        return tr(IN_SENTENCE[column])
    kind = tr("knee") if column.startswith("knee") else tr("ankle")
    return f"{kind} {peak_name(column)}"


def leg_beside_leg(facts: Facts, column: str, found: Difference) -> str:
    """How one leg's figure differs from the other's, in the words of who would say it."""
    first, second = facts.first_and_second
    unit, decimals = unit_and_decimals(column)
    is_less = found.difference < 0
    match column:
        case parameters.KNEE_RANGE | parameters.ANKLE_RANGE:
            pattern = (
                tr("The {joint} has {size} less range of motion than the {second}: {value} against {other}.")
                if is_less
                else tr("The {joint} has {size} more range of motion than the {second}: {value} against {other}.")
            )
        case "knee_stance_to_swing_deg":
            pattern = (
                tr("The {joint} flexes {size} less from stance to swing than the {second}: {value} against {other}.")
                if is_less
                else tr(
                    "The {joint} flexes {size} more from stance to swing than the {second}: {value} against {other}."
                )
            )
        case "knee_while_loading_deg":
            pattern = (
                tr("The {joint} flexes {size} less in loading response than the {second}: {value} against {other}.")
                if is_less
                else tr(
                    "The {joint} flexes {size} more in loading response than the {second}: {value} against {other}."
                )
            )
        case "knee_straightening_deg":
            pattern = (
                tr("The {joint} extends {size} less in mid-stance than the {second}: {value} against {other}.")
                if is_less
                else tr("The {joint} extends {size} more in mid-stance than the {second}: {value} against {other}.")
            )
        case "stance_percent":
            pattern = (
                tr(
                    "Stance is {size} of the gait cycle shorter on the {first} than on the {second}: {value} "
                    "against {other}."
                )
                if is_less
                else tr(
                    "Stance is {size} of the gait cycle longer on the {first} than on the {second}: {value} "
                    "against {other}."
                )
            )
        case "step_time_s":
            pattern = (
                tr("Step time is {size} shorter on the {first} than on the {second}: {value} against {other}.")
                if is_less
                else tr("Step time is {size} longer on the {first} than on the {second}: {value} against {other}.")
            )
        case _:
            pattern = (
                tr("{measure} is {size} lower on the {first} than on the {second}: {value} and {other}.")
                if is_less
                else tr("{measure} is {size} higher on the {first} than on the {second}: {value} and {other}.")
            )
    joint = joint_of_column(column, first)
    return pattern.format(
        measure=capitalised(measure_in_words(column)),
        joint=tr("{side} {joint}").format(side=role(facts, first), joint=tr("knee") if joint.is_knee else tr("ankle"))
        if joint
        else "",
        first=role(facts, first),
        second=role(facts, second),
        size=fixed(abs(found.difference), decimals) + unit,
        value=fixed(facts.value(first, column).mean, decimals) + unit,
        other=fixed(facts.value(second, column).mean, decimals) + unit,
    )
