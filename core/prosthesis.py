"""What a prosthesis replaces and what it is made of: level of amputation, kind of knee and kind of foot.

Levels are named as in ISO 8549-4:2020. Knees are named by their axes, then by what controls them; feet by whether they
have a joint, and of which axes. Nothing here is measured: a person has stated it. What nobody has stated is None.
"""

import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from core.body import Joint, JointKind, Side


class AmputationLevel(StrEnum):
    """Where the limb ends, from below."""

    PARTIAL_FOOT = "partial_foot"
    ANKLE_DISARTICULATION = "ankle_disarticulation"
    TRANSTIBIAL = "transtibial"
    KNEE_DISARTICULATION = "knee_disarticulation"
    TRANSFEMORAL = "transfemoral"
    HIP_DISARTICULATION = "hip_disarticulation"

    def replaces(self, kind: JointKind) -> bool:
        """Whether the joint of this kind is the prosthesis's."""
        levels, left_by = list(AmputationLevel), _LEFT_BY[kind]
        return levels.index(self) > levels.index(left_by)


_LEFT_BY = {  # the highest level that leaves the joint to the patient
    JointKind.ANKLE: AmputationLevel.PARTIAL_FOOT,
    JointKind.KNEE: AmputationLevel.TRANSTIBIAL,
    JointKind.HIP: AmputationLevel.TRANSFEMORAL,
}


class KneeKind(StrEnum):
    """A knee that is locked while walking, that has one axis or several, or what controls it where that is stated."""

    LOCKED = "locked"
    SINGLE_AXIS = "single_axis"
    POLYCENTRIC = "polycentric"
    FLUID_CONTROLLED = "fluid_controlled"  # hydraulic or pneumatic
    MICROPROCESSOR = "microprocessor"


class FootKind(StrEnum):
    """SACH: solid ankle, cushioned heel. It and an energy-storing foot bend in themselves and have no joint."""

    SACH = "sach"
    SINGLE_AXIS = "single_axis"
    MULTI_AXIAL = "multi_axial"
    ENERGY_STORING = "energy_storing"
    HYDRAULIC_ANKLE = "hydraulic_ankle"
    MICROPROCESSOR_ANKLE = "microprocessor_ankle"

    @property
    def has_joint(self) -> bool:
        return self not in (FootKind.SACH, FootKind.ENERGY_STORING)


class JointNature(StrEnum):
    """What a joint is, for all that was stated of its side."""

    NOT_STATED = "not_stated"  # of a side without a prosthesis: a person's, or a test bench's
    PROSTHETIC = "prosthetic"  # the prosthesis's, as far as is known: where no level is stated it may be the patient's
    RIGID = "rigid"  # the prosthesis's foot against the pylon, which no joint is between
    OWN = "own"  # the patient's, above the level


@dataclass(frozen=True, slots=True)
class Prosthesis:
    """What was stated of the prosthesis of one side.

    Raises
    ------
    ValueError
        A knee without a level that replaces the knee, or a foot where the patient's own ankle is left.
    """

    level: AmputationLevel | None = None
    knee: KneeKind | None = None
    foot: FootKind | None = None

    def __post_init__(self) -> None:
        if self.knee is not None and not self.has_knee:
            raise ValueError(f"a {self.knee} knee, but the level is {self.level}")
        if self.foot is not None and not self.may_have_foot:
            raise ValueError(f"a {self.foot} foot, but the level is {self.level}")

    @property
    def has_knee(self) -> bool:
        """Whether the knee is known to be the prosthesis's."""
        return self.level is not None and self.level.replaces(JointKind.KNEE)

    @property
    def may_have_foot(self) -> bool:
        return self.level is None or self.level.replaces(JointKind.ANKLE)

    def nature_of(self, joint: Joint) -> JointNature:
        """What a joint of its side is."""
        if self.level is not None and not self.level.replaces(joint.kind):
            return JointNature.OWN
        is_rigid = self.has_rigid_foot and joint.kind is JointKind.ANKLE
        return JointNature.RIGID if is_rigid else JointNature.PROSTHETIC

    @property
    def has_rigid_foot(self) -> bool:
        """Whether the foot is known to have no joint."""
        return self.foot is not None and not self.foot.has_joint


NOT_STATED = Prosthesis()
Prostheses = Mapping[Side, Prosthesis]
_PARTS = {"level": AmputationLevel, "knee": KneeKind, "foot": FootKind}


def prosthesis_table(prosthesis: Prosthesis) -> dict[str, str]:
    """What is stated, as a file has it."""
    parts = {name: getattr(prosthesis, name) for name in _PARTS}
    return {name: str(part) for name, part in parts.items() if part is not None}


def prosthesis_of_table(table: Mapping[str, object]) -> tuple[Prosthesis, dict[str, object]]:
    """What is stated in a table, and what of it means nothing here: a word of a later version, a knee out of place."""
    stated = NOT_STATED
    for name, kind in _PARTS.items():  # the level first: knee and foot depend on it
        with suppress(KeyError, ValueError):
            part: dict[str, Any] = {name: kind(str(table[name]))}
            stated = replace(stated, **part)
    return stated, {name: value for name, value in table.items() if name not in prosthesis_table(stated)}


def prostheses_of_tables(tables: object) -> tuple[dict[Side, Prosthesis], object]:
    """Each side's prosthesis, and what means nothing here, in its place; None where all of it is understood."""
    if not isinstance(tables, Mapping):
        return {}, tables
    found: dict[Side, Prosthesis] = {}
    rest: dict[str, object] = {}
    for name, table in tables.items():
        if name in set(Side) and isinstance(table, Mapping):
            found[Side(name)], left = prosthesis_of_table(table)
            rest |= {name: left} if left else {}
        else:
            rest[name] = table
    return stated_only(found), rest or None


def stated_only(prostheses: Prostheses) -> dict[Side, Prosthesis]:
    """Those of which something is stated, left first."""
    return {side: prostheses[side] for side in Side if prostheses.get(side, NOT_STATED) != NOT_STATED}


def prostheses_tables(prostheses: Prostheses, rest: object = None) -> dict[str, object]:
    """What `prostheses_of_tables` reads back, with the `rest` that meant nothing to it in its place again."""
    others = rest if isinstance(rest, Mapping) else {}
    worn = stated_only(prostheses)
    tables: dict[str, object] = {str(side): _with_rest(one, others.get(side)) for side, one in worn.items()}
    return tables | {name: table for name, table in others.items() if name not in worn}


def _with_rest(prosthesis: Prosthesis, rest: object) -> dict[str, object]:
    """Its table, and what of the rest changes nothing of what is stated now."""
    known = prosthesis_table(prosthesis)
    others = rest if isinstance(rest, Mapping) else {}
    kept = {k: v for k, v in others.items() if prosthesis_of_table({k: v, **known})[0] == prosthesis}
    return {**known, **kept, **known}


def prostheses_text(prostheses: Prostheses) -> str:
    """The same in one line; empty where nothing is stated."""
    tables = prostheses_tables(prostheses)
    return json.dumps(tables, separators=(",", ":")) if tables else ""


def prostheses_of_text(text: str) -> dict[Side, Prosthesis]:
    """What `prostheses_text` was given; none of anything else."""
    try:
        return prostheses_of_tables(json.loads(text))[0] if text else {}
    except (ValueError, RecursionError):
        return {}
