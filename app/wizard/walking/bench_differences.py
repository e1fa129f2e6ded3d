"""What differs between two alignments: the prosthetic side, the sound side's reaction, and both legs together."""

import textwrap
from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout

from app.results.compared_words import (
    ERROR,
    UNVERIFIED,
    change_in_words,
    evidence_of,
    is_judged,
    unit_behind,
    why_not_reported,
)
from app.summary.comparison import Compared, Comparison
from app.summary.error_sources import sources_in_words
from app.summary.numbers_in_words import DAGGER, MARKS, fixed, judged_in_words
from app.theme.current import px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.theme import CHIP_RADIUS, Theme
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import CENTRE, EMPTY, RIGHT, ErrorStrip, TableCell, TextCell
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD, Text
from app.wizard.walking.bench_rows import caution_of_row, cautions_of_table, is_provisional, shown_rows
from app.wording.alignment import NO_PROOF, NO_PROOF_BRIEF
from app.wording.translation import tr
from core.body import Side
from core.verdicts.measurement_error import Judgement
from core.verdicts.norms import MIN_STRIDES_FOR_SD

PADDING = 12
SCALE = 1.8  # errors, to either edge of a strip
ROW, HEAD, LINE, BETWEEN = 24, 20, 15, 4
LINES_CLOSER = 7  # px: what two lines leave free of the room of one
LETTERS_IN_LINE, LETTERS_BEFORE_COMMA = 24, 20
STRIP = 58


class BenchDifferences(Card):
    """Grey is the error; what is beyond it has a circle."""

    def __init__(self) -> None:
        super().__init__(padding=PADDING)
        self.title = Text(size=16, weight=SEMIBOLD)
        self.provisional = Text(size=12, weight=MEDIUM)
        self.table = CellTable(tr("Differences"), row=ROW, head=HEAD, padding=BETWEEN)
        self.cautions = Text(size=12, wraps=True)
        self.no_proof = Text(tr(NO_PROOF_BRIEF), size=12, tone="ink2", wraps=True)
        self.no_proof.setToolTip(tr(NO_PROOF))
        self.no_proof.setAccessibleDescription(tr(NO_PROOF))
        set_ground(self.provisional, Ground("", "control", radius=CHIP_RADIUS, inset=0))
        scaled(self.provisional.setContentsMargins, 8, 2, 8, 2)
        head = lay_out(QHBoxLayout(), (self.title, 1), (self.provisional, 0, Qt.AlignmentFlag.AlignTop), margins=0)
        lay_out(self.column, head, self.table, self.cautions, 1, self.no_proof)

    @property
    def needed(self) -> int:
        """How wide it has to be, px of the screen."""
        return self.table.minimumWidth() + px(2 * PADDING + 2)

    def show_pair(self, found: Comparison | None, prosthetic: Side, reported: str) -> None:
        """Show how the pair differs; None: one alignment was walked with, and nothing is beside it."""
        self.table.setVisible(found is not None)
        self.title.setText(tr("Nothing to compare yet"))
        self.cautions.setVisible(False)
        self.provisional.setVisible(False)
        if found is None:
            return
        shown = shown_rows(found, prosthetic)
        self.title.setText(f"{found.parts[1].letter} \N{MINUS SIGN} {found.against.letter}")
        self.title.setToolTip(
            tr("With {one}, less what it was with {other}.").format(
                one=found.parts[1].letter, other=found.against.letter
            )
        )
        self._show_provisional(found, prosthetic)
        self.table.setAccessibleDescription(reported)
        rows = [_heading(tr("Prosthetic side"), prosthetic), *map(self._row, shown.prosthetic)]
        if shown.sound:
            sound = next(side for side in Side if side is not prosthetic)
            rows += [_heading(tr("Sound-side response"), sound), *map(self._row, shown.sound)]
        rows += [_heading(tr("Both legs"), None), *map(self._row, shown.both)]
        self.table.show_rows(_columns(self._is_light), rows)
        cautions = cautions_of_table(found, prosthetic)
        self.cautions.setText("\n".join(cautions))
        self.cautions.setVisible(bool(cautions))

    @property
    def _is_light(self) -> bool:
        """Whether the figures are provisional."""
        return not self.provisional.isHidden()

    def _show_provisional(self, found: Comparison, prosthetic: Side) -> None:
        fewest = min(part.strides(prosthetic) for part in found.parts)
        stated = tr("Provisional: {count} of {required} strides")
        self.provisional.setText(stated.format(count=fewest, required=MIN_STRIDES_FOR_SD))
        self.provisional.setToolTip(
            tr("Under {required} strides no measurement error is known, and nothing is judged.").format(
                required=MIN_STRIDES_FOR_SD
            )
        )
        self.provisional.setVisible(is_provisional(found, prosthetic))

    def _row(self, row: Compared) -> TableRow:
        weight = SEMIBOLD if row.exceeds else REGULAR
        tone = "ink2" if self._is_light else "ink"
        name, value = tr(row.measure.name), _Low(why_not_reported(row), align=RIGHT, size=12, tone="ink2")
        if row.is_reported:
            change = change_in_words(row.difference.difference, row.measure)
            change = f"{MARKS[row.difference.mark]} {change}".strip()
            value = _Low(change, small=_error(row), align=RIGHT, weight=weight, tone=tone)
        cells = (_Low(_in_lines(name), size=12, weight=weight, tone=tone), value, self._strip(row))
        return TableRow(cells, hint=_hint(row, name))

    def _strip(self, row: Compared) -> TableCell:
        found = row.difference
        if not row.is_reported or self._is_light:
            return _Low()
        if not is_judged(row):
            word = tr("too few strides") if found.judgement is Judgement.TOO_FEW_STRIDES else tr("no published error")
            return _Low(word, align=CENTRE, size=12, tone="ink2")
        spoken = judged_in_words(found)
        return _Strip(found.difference, found.error, SCALE * found.error, is_judged=True, spoken=spoken)


def _columns(is_light: bool) -> list[TableColumn]:
    change, error = (TextCell(tr("change"), align=RIGHT, size=12, tone="ink2") for _ in range(2))
    if not is_light:
        change = TextCell(tr("change ± error"), align=RIGHT, size=12, tone="ink2")
        error = TextCell(tr("error"), align=CENTRE, size=12, tone="ink2")
    about = tr("± and grey are the measurement error: in 95 of 100 such measurements the true change is within it.")
    return [
        TableColumn(share=2),
        TableColumn(change, share=1, hint=about),
        TableColumn(EMPTY if is_light else error, share=2, hint="" if is_light else about),
    ]


def _heading(words: str, side: Side | None) -> TableRow:
    return TableRow((_Low(words, weight=SEMIBOLD, side=side, span=3), _Low(), _Low()), is_heading=True)


def _error(row: Compared) -> str:
    """The error in figures, with a dagger where it rests on a value whose source could not be verified."""
    if not is_judged(row):
        return ""
    unit = row.measure.unit if row.measure.unit == "°" else ""
    dagger = DAGGER if row.difference.is_unverified else ""
    return f"±{fixed(row.difference.error, row.measure.decimals)}{unit}{dagger}"


def _hint(row: Compared, name: str) -> str:
    """All that is known of a row, under the mouse."""
    pattern = tr("{name}: {before} with {other}, {now} with {one}.")
    if not row.is_reported:
        return " ".join([f"{name}: {why_not_reported(row)}.", *caution_of_row(row)])
    values = [fixed(value.mean, row.measure.decimals) + unit_behind(row.measure) for value in (row.other, row.value)]
    stated = [pattern.format(name=name, before=values[0], other=row.against.letter, now=values[1], one=row.part.letter)]
    if is_judged(row):
        stated += [evidence_of(row), tr(ERROR).format(sources=sources_in_words([row.difference]))]
        stated += [tr(UNVERIFIED)] if row.difference.is_unverified else []
    return " ".join([*stated, *caution_of_row(row)])


def _in_lines(name: str) -> str:
    """A long name in two lines, the second after its comma where it has one."""
    first, comma, rest = name.partition(", ")
    if comma and len(name) > LETTERS_BEFORE_COMMA:
        return f"{first},\n{rest}"
    return "\n".join(textwrap.wrap(name, LETTERS_IN_LINE, break_long_words=False))


@dataclass(frozen=True, slots=True)
class _Low(TextCell):
    """Lower than elsewhere: sixteen rows have to have their room beside the curves."""

    def height(self, theme: Theme) -> int:
        lines = self.text.count("\n")
        return theme.px(ROW + lines * LINE - (LINES_CLOSER if lines else 0))


@dataclass(frozen=True, slots=True)
class _Strip(ErrorStrip):
    """Lower and narrower than elsewhere."""

    def height(self, theme: Theme) -> int:
        return theme.px(ROW)

    def width(self, theme: Theme) -> int:
        return theme.px(STRIP)
