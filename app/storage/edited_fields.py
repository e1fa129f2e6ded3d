"""What can be edited of a patient, a session and a recording: plain values by the field's name, and back.

What is stated about a joint or a side is a field of its own, "zero_rad.left_knee": two people may enter
two joints' zeros.
"""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from app.storage.stored import Limits
from app.storage.three_way import Value, Values
from core.alignment import alignment_of_text, alignment_text
from core.body import LEG_JOINTS, Side
from core.goals import GOAL_COLUMNS, GoalKey, goals_of_text, goals_text, ordered, whose
from core.prosthesis import NOT_STATED, Prosthesis, prostheses_of_text, prostheses_text
from core.session import Patient, Recording, RecordingKind, Session
from core.timed.protocols import planned_of_text, planned_text

IN_OTHER_FORM = ("goals", "prostheses", "unknown")
PATIENT_CORRECTABLE = tuple(field.name for field in fields(Patient) if field.name not in IN_OTHER_FORM)
KEPT = "is_kept"
CONFIRMED = "comment_confirmed"
PLACEMENT = "placement"
"""What a contest about who wears what is called; it is no field of a row that is edited."""
ALIGNMENT = "alignment"
"""What was changed at the prosthesis is one field: a chain whose parts came from two people would be nobody's."""
GOALS = "goals"
"""What was agreed of each figure is one field, with what it replaced: two people may agree on two figures' goals."""
PROSTHESIS = "prosthesis"
"""What is stated of one side's prosthesis is one field: a knee belongs to a level."""
GOAL_KEYS = tuple((column, of) for column in GOAL_COLUMNS for of in whose(column))
TEST = "test"
"""Which test a walk is is one field, with its keys: they belong to no other."""
SIDES = ("affected_side", "prosthetic_side")
SESSION_CORRECTABLE = ("started", "operator", "surface", "notes", "software")
RECORDING_CORRECTABLE = ("name", "kind", "condition", "started", "is_kept", "note", "is_restrapped_before")


def patient_fields(reported: Patient) -> dict[str, Value]:
    """Both sides are one field: which is affected and which is prosthetic are entered in one go."""
    values: dict[str, Value] = {name: getattr(reported, name) for name in PATIENT_CORRECTABLE if name not in SIDES}
    values |= {"sides": ",".join(getattr(reported, name) for name in SIDES)}
    values |= {f"{PROSTHESIS}.{side}": _prosthesis_text(reported, side) for side in Side}
    return values | {
        goal_field(key): goals_text([one for one in reported.goals if one.key == key]) for key in GOAL_KEYS
    }


def _prosthesis_text(reported: Patient, side: Side) -> str:
    return prostheses_text({side: reported.prostheses.get(side, NOT_STATED)})


def goal_field(key: GoalKey) -> str:
    """What the goals of one figure are called among the fields of a patient."""
    return f"{GOALS}.{key[0]}.{key[1]}"


def with_patient_fields(reported: Patient, values: Values) -> Patient:
    """The same patient with `values`, which may be of some fields only."""
    every: dict[str, Any] = patient_fields(reported) | dict(values)
    affected, prosthetic = every.pop("sides").split(",")
    goals = ordered(goal for key in GOAL_KEYS for goal in goals_of_text(every.pop(goal_field(key))))
    worn: dict[Side, Prosthesis] = {}
    for side in Side:
        worn |= prostheses_of_text(every.pop(f"{PROSTHESIS}.{side}"))
    sides = {"affected_side": affected, "prosthetic_side": prosthetic}
    return replace(reported, goals=goals, prostheses=worn, **sides, **every)


def session_fields(reported: Session, comment: str, limits: Limits, confirmed: str = "") -> dict[str, Value]:
    """What was `confirmed` holds the comment's words again: of two people's edits none confirms the other's."""
    values: dict[str, Value] = {name: getattr(reported, name) for name in SESSION_CORRECTABLE}
    values |= {"comment": comment, CONFIRMED: confirmed, "cannot_stand": limits.cannot_stand}
    values |= {f"without_ankle.{side}": side in limits.without_ankle for side in Side}
    values |= {f"zero_rad.{joint}": reported.zero_rad.get(joint) for joint in LEG_JOINTS}
    return values | {f"turned_sign.{joint}": reported.turned_sign.get(joint) for joint in LEG_JOINTS}


def with_session_fields(
    reported: Session, comment: str, limits: Limits, confirmed: str, values: Values
) -> tuple[Session, str, Limits, str]:
    """The same session, comment, limits and confirmation with `values`, which may be of some fields only."""
    every: Mapping[str, Any] = session_fields(reported, comment, limits, confirmed) | dict(values)
    stated = replace(
        reported,
        zero_rad={joint: every[f"zero_rad.{joint}"] for joint in LEG_JOINTS if every[f"zero_rad.{joint}"] is not None},
        turned_sign={joint: every[f"turned_sign.{joint}"] for joint in LEG_JOINTS if every[f"turned_sign.{joint}"]},
        **{name: every[name] for name in SESSION_CORRECTABLE},
    )
    without = frozenset(side for side in Side if every[f"without_ankle.{side}"])
    return stated, every["comment"], Limits(without, every["cannot_stand"]), every[CONFIRMED]


def recording_fields(reported: Recording) -> dict[str, Value]:
    values: dict[str, Value] = {name: getattr(reported, name) for name in RECORDING_CORRECTABLE}
    values |= {ALIGNMENT: alignment_text(reported.alignment), TEST: planned_text(reported.test)}
    return values | {f"left_out_s.{side}": tuple(sorted(reported.left_out_s.get(side, ()))) for side in Side}


def with_recording_fields(reported: Recording, values: Values) -> Recording:
    """The same recording with `values`, which may be of some fields only."""
    every: Mapping[str, Any] = recording_fields(reported) | dict(values)
    left_out_s = {side: every[f"left_out_s.{side}"] for side in Side if every[f"left_out_s.{side}"]}
    own = {name: every[name] for name in RECORDING_CORRECTABLE if name != "kind"}
    alignment = alignment_of_text(every[ALIGNMENT])
    test = planned_of_text(every[TEST])
    return replace(
        reported, kind=RecordingKind(every["kind"]), left_out_s=left_out_s, alignment=alignment, test=test, **own
    )
