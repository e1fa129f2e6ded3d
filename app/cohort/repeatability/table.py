"""The table of a study: each figure with its limits beside the published one, for terminal, file and screen."""

from collections.abc import Iterator
from dataclasses import dataclass

from app.wording.measures import NAMES, decimals, unit_symbol
from app.wording.translation import figure_text, tr
from core.parameters import QuantityKind, unit_of
from core.verdicts.own_figures import OwnEstimate, OwnFigures, OwnSigma
from core.verdicts.repeatability import COLUMNS
from core.verdicts.sigmas import HEALTHY_BETWEEN_LEGS

HEADS = ("group", "quantity", "column", "unit", "own", "low", "high", "people", "published", "published_is_within")
ATTACHED_AGAIN, BETWEEN_LEGS = "attached_again", "between_legs"


@dataclass(frozen=True, slots=True)
class RepeatabilityRow:
    """A figure of a study. `group`: ATTACHED_AGAIN, a standard deviation of one mean, or BETWEEN_LEGS.

    `size`: of the means that it is of, where it grows with it; None where it does not.
    """

    group: str
    key: str
    name: str
    column: str
    found: OwnEstimate
    published: float
    size: float | None = None

    @property
    def unit(self) -> str:
        unit = unit_of(self.column)
        return unit_symbol(unit) if unit is not None else ""

    @property
    def is_within(self) -> bool:
        """Whether the published figure is within the limits of the own one."""
        return self.found.holds(self.published)

    @property
    def title(self) -> str:
        if self.size is None:
            return self.name
        size = figure_text(self.size, f".{decimals(self.column)}f")
        return tr("{measure} (at {size}°)").format(measure=self.name, size=size)  # angles alone grow

    def number(self, value: float) -> str:
        """With one decimal more than the quantity itself has, and times to the millisecond."""
        return figure_text(value, f".{3 if self.column.endswith('_s') else decimals(self.column) + 1}f")

    @property
    def limits(self) -> str:
        return tr("{low} to {high}").format(low=self.number(self.found.low), high=self.number(self.found.high))

    @property
    def verdict(self) -> str:
        """Where the published figure is."""
        if self.is_within:
            return tr("within limits")
        return tr("own is higher") if self.published < self.found.low else tr("own is lower")


def rows_of(own: OwnFigures) -> tuple[RepeatabilityRow, ...]:
    again = (_of_kind(kind, found) for kind, found in own.sigmas.items())
    legs = (
        RepeatabilityRow(BETWEEN_LEGS, column, tr(NAMES[column]), column, found, HEALTHY_BETWEEN_LEGS[column])
        for column, found in own.healthy.items()
    )
    return (*again, *legs)


def csv_rows(own: OwnFigures) -> Iterator[tuple[str, ...]]:
    """The same for a file, without words of a language; under HEADS."""
    for row in rows_of(own):
        figures = (row.found.value, row.found.low, row.found.high)
        unit = unit_of(row.column)
        quantity, column = (row.key, "") if row.group == ATTACHED_AGAIN else ("", row.key)
        yield (
            *(row.group, quantity, column, unit.in_files if unit is not None else ""),
            *(f"{figure:.5f}" for figure in figures),
            *(str(row.found.people), f"{row.published:.5f}", "true" if row.is_within else "false"),
        )


def kind_name(kind: QuantityKind) -> str:
    """What quantities of a kind are called together."""
    names = {
        QuantityKind.KNEE_SHAPE: tr("Knee range of motion"),
        QuantityKind.KNEE_HEIGHT: tr("Knee, absolute angle"),
        QuantityKind.ANKLE_SHAPE: tr("Ankle range of motion"),
        QuantityKind.ANKLE_HEIGHT: tr("Ankle, absolute angle"),
        QuantityKind.SEGMENT_SHAPE: tr("Shank, range of motion"),
        QuantityKind.SEGMENT_HEIGHT: tr("Shank and thigh, absolute angle"),
    }
    return names[kind] if kind in names else tr(NAMES[COLUMNS[kind][0]])


def _of_kind(kind: QuantityKind, found: OwnSigma) -> RepeatabilityRow:
    grows = kind in (QuantityKind.KNEE_SHAPE, QuantityKind.KNEE_HEIGHT)
    grows = grows or kind in (QuantityKind.SEGMENT_SHAPE, QuantityKind.SEGMENT_HEIGHT)
    return RepeatabilityRow(
        ATTACHED_AGAIN,
        str(kind),
        kind_name(kind),
        COLUMNS[kind][0],
        found.sigma,
        found.published,
        found.mean if grows else None,
    )
