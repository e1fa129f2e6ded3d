"""What differs between two alignments: the prosthetic side, the sound side's reaction, and both legs together."""

from app.results.compared_words import change_in_words, is_judged, why_not_reported
from app.summary.comparison import Compared, Comparison
from app.summary.measures import FITTED
from app.summary.numbers_in_words import DAGGER, MARKS, judged_in_words
from app.theme.current import px
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import CENTRE, EMPTY, RIGHT, ErrorStrip, TableCell, TextCell
from app.widgets.text import REGULAR, SEMIBOLD, Text
from app.wording.alignment import NO_PROOF
from app.wording.translation import tr
from core.body import Side
from core.verdicts.measurement_error import Judgement

OF_PROSTHETIC = ("knee_stance_to_swing_deg", "knee_while_loading_deg", "ankle_rocker_deg", "stance_percent")
OF_SOUND = ("knee_stance_to_swing_deg", "ankle_push_off_deg", "stance_percent")
OF_BOTH = ("speed_m_s", "cadence_steps_min")
LENGTH = "stride_length_m"
PADDING = 12
SCALE = 1.8  # errors, to either edge of a strip
ROW, HEAD = 26, 22
MOST_FITTED = 3  # there is room for no more


class BenchDifferences(Card):
    """Grey is the error; what is beyond it has a circle."""

    def __init__(self) -> None:
        super().__init__(padding=PADDING)
        self.title = Text(size=16, weight=SEMIBOLD)
        self.table = CellTable(tr("Differences"), row=ROW, head=HEAD)
        self.no_proof = Text(tr(NO_PROOF), size=12, tone="ink2", wraps=True)
        lay_out(self.column, self.title, self.table, 1, self.no_proof)

    @property
    def needed(self) -> int:
        """How wide it has to be, px of the screen."""
        return self.table.minimumWidth() + px(2 * PADDING + 2)

    def show_pair(self, found: Comparison | None, prosthetic: Side, reported: str) -> None:
        """Show how the pair differs; None: one alignment was walked with, and nothing is beside it."""
        self.table.setVisible(found is not None)
        self.title.setText(tr("Nothing to compare yet"))
        if found is None:
            return
        self.title.setText(f"{found.parts[1].letter} \N{MINUS SIGN} {found.against.letter}")
        self.table.setAccessibleDescription(reported)
        head = TextCell(tr("grey: error"), align=CENTRE, size=12, tone="ink2")
        columns = [TableColumn(share=3), TableColumn(share=1), TableColumn(head, share=2)]
        rows = [_heading(tr("Prosthetic side"), prosthetic), *_rows(found, OF_PROSTHETIC, prosthetic)]
        rows += map(_row, _fitted_beyond_error(found, prosthetic))
        sound = next(side for side in Side if side is not prosthetic)
        if sound in found.sides:
            rows += [_heading(tr("Sound-side response"), sound), *_rows(found, OF_SOUND, sound)]
        rows += [_heading(tr("Both legs"), None), *_rows(found, OF_BOTH, None), *_rows(found, (LENGTH,), prosthetic)]
        self.table.show_rows(columns, rows)


def _heading(words: str, side: Side | None) -> TableRow:
    return TableRow((TextCell(words, weight=SEMIBOLD, side=side, span=3), EMPTY, EMPTY), is_heading=True)


def _rows(found: Comparison, columns: tuple[str, ...], side: Side | None) -> list[TableRow]:
    """Of one leg, or of both where `side` is None."""
    of_side = [row for row in found.rows if row.measure.is_of_walk or row.side is side]
    return [_row(row) for column in columns for row in of_side if row.measure.column == column]


def _fitted_beyond_error(found: Comparison, prosthetic: Side) -> list[Compared]:
    """Those of the measures for fitting that changed by most errors."""
    rows = [found.compare(measure, prosthetic, found.parts[1], found.against) for measure in FITTED]
    beyond = sorted((row for row in rows if row.exceeds), key=lambda row: -row.difference.ratio)
    return beyond[:MOST_FITTED]


def _row(row: Compared) -> TableRow:
    weight = SEMIBOLD if row.exceeds else REGULAR
    change = change_in_words(row.difference.difference, row.measure) if row.is_reported else why_not_reported(row)
    if is_judged(row) and row.difference.is_unverified:
        change += DAGGER
    change = f"{MARKS[row.difference.mark]} {change}".strip()
    return TableRow(
        (
            TextCell(tr(row.measure.name), size=12, weight=weight),
            TextCell(change, align=RIGHT, weight=weight),
            _strip(row),
        )
    )


def _strip(row: Compared) -> TableCell:
    found = row.difference
    if not row.is_reported:
        return EMPTY
    if not is_judged(row):
        word = tr("too few strides") if found.judgement is Judgement.TOO_FEW_STRIDES else tr("no published error")
        return TextCell(word, align=CENTRE, size=12, tone="ink2")
    return ErrorStrip(found.difference, found.error, SCALE * found.error, is_judged=True, spoken=judged_in_words(found))
