"""What the parameters of a table are called, their units and how many decimals they are reported with."""

from dataclasses import dataclass

from app.wording.measures import NAMES, unit_symbol, with_unit
from app.wording.translation import later, tr
from core.parameters import SPEED, unit_of

OF_TABLE = {"walk_speed_m_s": later("Walking speed"), SPEED: later("Walking speed, by leg")}  # a batch reports both


@dataclass(frozen=True, slots=True)
class MeasureWords:
    """`name` in words, its unit (empty: none), and the decimals that it is reported with."""

    name: str
    unit: str
    decimals: int

    @property
    def with_unit(self) -> str:
        return with_unit(self.name, self.unit) if self.unit else self.name


def measure_words(column: str) -> MeasureWords:
    """Give the words of a parameter; one that nobody has named yet is called as its column."""
    unit = unit_of(column)
    name = OF_TABLE.get(column) or NAMES.get(column)
    if unit is None:
        return MeasureWords(tr(name) if name else _plain(column), "", 2)
    return MeasureWords(tr(name) if name else _plain(column.removesuffix(unit)), unit_symbol(unit), unit.decimals)


def in_order(columns: tuple[str, ...]) -> list[str]:
    """Parameters in the order of this list, those without a name last."""
    known = [*OF_TABLE, *(column for column in NAMES if column not in OF_TABLE)]
    return sorted(columns, key=lambda column: (known.index(column) if column in known else len(known), column))


def _plain(column: str) -> str:
    return column.replace("_", " ").capitalize()
