"""A measure's unit and decimals inside a sentence, and how it differs between the legs."""

from collections.abc import Sequence
from typing import NamedTuple

from app.summary.facts import Facts, role
from app.summary.numbers_in_words import fixed
from app.wording.body import name_of, side_name
from app.wording.measures import decimals, name_in_sentence, short_unit, unit_symbol
from app.wording.translation import capitalised, later, tr
from core import parameters
from core.body import Joint, JointKind, Side
from core.parameters import Unit, unit_of
from core.timed.measures import PROTOCOLS
from core.verdicts.measurement_error import Difference
from core.verdicts.quantities import joint_of as joint_of_column


class Reported(NamedTuple):
    """Where a value was measured, as "in B" or "on 1 July", and the value."""

    where: str
    value: float


def unit_and_decimals(column: str) -> tuple[str, int]:
    """A column's unit as it follows a number, and its decimals."""
    if column in PROTOCOLS:
        return short_unit(column), decimals(column)
    unit = unit_of(column)
    assert unit is not None, column
    space = "" if unit is Unit.DEGREES else "\N{NO-BREAK SPACE}"
    return f"{space}{unit_symbol(unit)}", unit.decimals


CLAUSES = {
    parameters.KNEE: later("{who} flexes {value} from stance to swing"),
    "knee_while_loading_deg": later("{who} flexes {value} in loading response"),
    "knee_straightening_deg": later("{who} extends {value} in mid-stance"),
    "knee_swing_peak_deg": later("{who} reaches {value} flexion in swing"),
    parameters.KNEE_RANGE: later("{who} has {value} range of motion"),
    parameters.PUSH_OFF: later("{who} plantarflexes {value} at push-off"),
    "ankle_rocker_deg": later("{who} dorsiflexes {value} in stance"),
    "ankle_heel_rocker_deg": later("{who} plantarflexes {value} in loading response"),
    "ankle_toes_lifted_deg": later("{who} dorsiflexes {value} in swing"),
    parameters.ANKLE_RANGE: later("{who} has {value} range of motion"),
    "hip_range_deg": later("{who} has {value} range of motion"),
    parameters.STANCE: later("{who}: stance takes {value}"),
}
OTHER_OF_LEG, OTHER = later("{who}: {measure} is {value}"), later("{measure} is {value}")
BESIDE = {  # how one leg has less than the other, and more
    parameters.KNEE_RANGE: (
        later("The {joint} has {size} less range of motion than the {second}: {value} against {other}."),
        later("The {joint} has {size} more range of motion than the {second}: {value} against {other}."),
    ),
    "knee_stance_to_swing_deg": (
        later("The {joint} flexes {size} less from stance to swing than the {second}: {value} against {other}."),
        later("The {joint} flexes {size} more from stance to swing than the {second}: {value} against {other}."),
    ),
    "knee_while_loading_deg": (
        later("The {joint} flexes {size} less in loading response than the {second}: {value} against {other}."),
        later("The {joint} flexes {size} more in loading response than the {second}: {value} against {other}."),
    ),
    "knee_straightening_deg": (
        later("The {joint} extends {size} less in mid-stance than the {second}: {value} against {other}."),
        later("The {joint} extends {size} more in mid-stance than the {second}: {value} against {other}."),
    ),
    parameters.PUSH_OFF: (
        later("The {joint} plantarflexes {size} less at push-off than the {second}: {value} against {other}."),
        later("The {joint} plantarflexes {size} more at push-off than the {second}: {value} against {other}."),
    ),
    "ankle_heel_rocker_deg": (
        later("The {joint} plantarflexes {size} less in loading response than the {second}: {value} against {other}."),
        later("The {joint} plantarflexes {size} more in loading response than the {second}: {value} against {other}."),
    ),
    "ankle_rocker_deg": (
        later("The {joint} dorsiflexes {size} less in stance than the {second}: {value} against {other}."),
        later("The {joint} dorsiflexes {size} more in stance than the {second}: {value} against {other}."),
    ),
    "stance_percent": (
        later(
            "Stance is {size} of the gait cycle shorter on the {first} than on the {second}: {value} against {other}."
        ),
        later(
            "Stance is {size} of the gait cycle longer on the {first} than on the {second}: {value} against {other}."
        ),
    ),
    "step_time_s": (
        later("Step time is {size} shorter on the {first} than on the {second}: {value} against {other}."),
        later("Step time is {size} longer on the {first} than on the {second}: {value} against {other}."),
    ),
}
BESIDE[parameters.ANKLE_RANGE] = BESIDE[parameters.KNEE_RANGE]
CHANGES = (  # less and more, with what it is compared with and without
    (
        later("{clause} {now}, {size} less than {before} ({other})."),
        later("{clause} {now}, {size} less than {before}."),
    ),
    (
        later("{clause} {now}, {size} more than {before} ({other})."),
        later("{clause} {now}, {size} more than {before}."),
    ),
)
OTHER_BESIDE = (
    later("{measure} is {size} lower on the {first} than on the {second}: {value} against {other}."),
    later("{measure} is {size} higher on the {first} than on the {second}: {value} against {other}."),
)


def change_sentence(column: str, who: str, difference: float, now: Reported, before: Reported) -> str:
    """State a measure and its change: "Left knee flexes 54° in B, 5° more ..."; empty `who`: the whole walk.

    What it is compared with is left out where, rounded, it would not be as far away as stated.
    """
    unit, decimals = unit_and_decimals(column)
    value, size = _figures(column, (now.value, abs(difference)), decimals)
    other = fixed(before.value, decimals) + unit
    pattern = CLAUSES.get(column, OTHER_OF_LEG if who else OTHER)
    clause = tr(pattern).format(who=who, measure=name_in_sentence(column), value=value)
    with_other, alone = CHANGES[difference >= 0]
    stated = tr(with_other if _agree(now.value, before.value, difference, decimals) else alone)
    return capitalised(stated.format(clause=clause, now=now.where, size=size, before=before.where, other=other))


def similar_sentence(column: str, who: str, difference: float, now: Reported, before: Reported) -> str:
    """The same where the difference may be error: both values."""
    decimals = agreeing_decimals(column, now.value, before.value, difference)
    value, other = _figures(column, (now.value, before.value), decimals)
    stated = tr("{who}: {measure} is similar {before} and {now}, {other} and {value}.")
    if not who:
        stated = tr("{measure} is similar {before} and {now}, {other} and {value}.")
    measure = name_in_sentence(column)
    text = stated.format(who=who, measure=measure, before=before.where, now=now.where, other=other, value=value)
    return capitalised(text)


def who_in_sentence(column: str, side: Side) -> str:
    """The joint that a measure is of, else the leg; empty where it is of both."""
    if column in parameters.OF_WALK:
        return ""
    joint = joint_of_column(column, side)
    return capitalised(name_of(joint) if joint is not None else side_name(side))


def who_of_role(facts: Facts, side: Side, column: str) -> str:
    """The joint or leg that a measure is of, with what is known of the side."""
    joint = joint_of_column(column, side)
    leg = role(facts, side, joint)
    return leg if joint is None else joint_of_role(leg, joint)


def joint_of_role(leg: str, joint: Joint) -> str:
    """A joint of the leg that is named so: "right (prosthetic) knee"."""
    kind = {JointKind.HIP: tr("hip"), JointKind.KNEE: tr("knee"), JointKind.ANKLE: tr("ankle")}[joint.kind]
    return tr("{side} {joint}").format(side=leg, joint=kind)


def agreeing_decimals(column: str, value: float, other: float, difference: float) -> int:
    """With how many decimals two values and their difference are stated; one more where these would not agree."""
    _, decimals = unit_and_decimals(column)
    return decimals + (not _agree(value, other, difference, decimals))


def _agree(value: float, other: float, difference: float, decimals: int) -> bool:
    """Whether two values, rounded, are as far apart as their difference, rounded."""
    return round(round(value, decimals) - round(other, decimals), decimals) == round(difference, decimals)


def unit_in_sentence(column: str) -> str:
    """As it is written behind a number; a share is that of the gait cycle, since "2 % more" means another thing."""
    is_share = unit_of(column) is Unit.PERCENT
    return f"\N{NO-BREAK SPACE}{tr('% of the gait cycle')}" if is_share else unit_and_decimals(column)[0]


def _figures(column: str, values: Sequence[float], decimals: int) -> list[str]:
    return [fixed(value, decimals) + unit_in_sentence(column) for value in values]


def leg_beside_leg(facts: Facts, column: str, found: Difference) -> str:
    """How one leg's figure differs from the other's."""
    sides = facts.first_and_second
    first, second = (role(facts, side, joint_of_column(column, side)) for side in sides)
    value, other = (facts.value(side, column).mean for side in sides)
    return legs_sentence(column, found, (first, second), (value, other))


def legs_sentence(column: str, found: Difference, legs: tuple[str, str], values: tuple[float, float]) -> str:
    """How the first leg's figure differs from the second's, which `legs` names."""
    unit, decimals = unit_and_decimals(column)
    first, second = legs
    pattern = tr(BESIDE.get(column, OTHER_BESIDE)[0 if found.difference < 0 else 1])
    joint = joint_of_column(column, Side.LEFT)
    return pattern.format(
        measure=capitalised(name_in_sentence(column)),
        joint="" if joint is None else joint_of_role(first, joint),
        first=first,
        second=second,
        size=fixed(abs(found.difference), decimals) + unit,
        value=fixed(values[0], decimals) + unit,
        other=fixed(values[1], decimals) + unit,
    )
