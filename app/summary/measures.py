"""Measures of strides that are compared between walks, visits and legs."""

from dataclasses import dataclass

from app.wording.measures import NAMES, WITH_UNIT
from core.body import Joint, Side
from core.parameters import ALIGNED, BY_COLUMN, COMPARED, OF_WALK, QuantityClass, Unit, unit_of
from core.verdicts.quantities import joint_of

KINDS = ("knee", "ankle", "hip", "pelvis")


@dataclass(frozen=True, slots=True)
class Measure:
    """One figure that is compared: a quantity's column, and its name as it heads a row (to be translated)."""

    column: str
    name: str = ""

    def joint(self, side: Side) -> Joint | None:
        """Whose figure it is; None where it is no joint's."""
        return joint_of(self.column, side)

    @property
    def kind(self) -> str:
        """Knee, ankle, hip or pelvis, whose angle it is; empty of all else."""
        kind = self.column.split("_")[0]
        return kind if kind in KINDS and unit_of(self.column) is Unit.DEGREES else ""

    @property
    def unit(self) -> str:
        unit = unit_of(self.column)
        return unit.symbol if unit is not None else ""

    @property
    def decimals(self) -> int:
        unit = unit_of(self.column)
        return unit.decimals if unit is not None else 1

    @property
    def is_of_walk(self) -> bool:
        """Whether both legs have the same, so that it is shown once, of both."""
        return self.column in OF_WALK

    @property
    def needs_height(self) -> bool:
        """Whether it means something only with a zero of the same kind."""
        known = BY_COLUMN.get(self.column)
        return known is not None and known.rests_on is QuantityClass.HEIGHT


MEASURES = tuple(Measure(column, WITH_UNIT.get(column) or NAMES[column]) for column in COMPARED)
FITTED = tuple(Measure(column, WITH_UNIT.get(column) or NAMES[column]) for column in ALIGNED)
