"""What the bench showed last, so that it states by itself what is shown otherwise since."""

from app.results.compared_words import unit_behind
from app.summary.comparison import Comparison
from app.summary.numbers_in_words import signed
from app.wizard.walking.bench_rows import shown_rows
from app.wording.measures import name_in_sentence
from app.wording.translation import tr
from core.body import Side

Pair = tuple[str, str]
Figures = dict[tuple[str, Side], str]
"""Changes as the table has them, by measure and leg."""


class ShownBefore:
    """Keeps the letters of the pair shown last, and of every pair of walks the figures shown last.

    A walk that is repeated in the place of an excluded one has its letter, and other figures.
    """

    def __init__(self) -> None:
        self._pair: Pair | None = None
        self._replaced: Pair | None = None
        self._figures: dict[Pair, Figures] = {}
        self._recalculated = ""

    def chosen(self) -> None:
        """Take note that somebody chooses what is shown next."""
        self._pair = self._replaced = None
        self._recalculated = ""

    def note(self, found: Comparison, prosthetic: Side) -> str:
        """State which pair was shown before, and what of this one was recalculated; empty where all is as it was."""
        pair = found.parts[1].letter, found.against.letter
        if self._pair is not None and self._pair != pair:
            self._replaced, self._recalculated = self._pair, ""
        self._pair = pair
        figures = _figures_of(found, prosthetic)
        walks = found.parts[1].walks[0].name, found.against.walks[0].name
        self._recalculated = _what_changed(self._figures.get(walks, {}), figures) or self._recalculated
        self._figures[walks] = figures
        return " ".join(filter(None, [self._pair_in_words(pair), self._recalculated]))

    def _pair_in_words(self, pair: Pair) -> str:
        if self._replaced is None or self._replaced == pair:
            return ""
        stated = tr("Now {one} \N{MINUS SIGN} {other}; before: {one_before} \N{MINUS SIGN} {other_before}.")
        one, other = self._replaced
        return stated.format(one=pair[0], other=pair[1], one_before=one, other_before=other)


def _figures_of(found: Comparison, prosthetic: Side) -> Figures:
    rows = shown_rows(found, prosthetic)
    return {
        (row.measure.column, row.side): signed(row.difference.difference, row.measure.decimals)
        + unit_behind(row.measure)
        for row in (*rows.prosthetic, *rows.sound, *rows.both)
        if row.is_reported
    }


def _what_changed(before: Figures, now: Figures) -> str:
    """The first figure that is another now; a new walk moves them where it sharpens an axis or adds strides."""
    for (column, side), value in before.items():
        if now.get((column, side), value) != value:
            stated = tr("Recalculated with the walks since: {measure} {now}, before {before}.")
            return stated.format(measure=name_in_sentence(column), now=now[column, side], before=value)
    return ""
