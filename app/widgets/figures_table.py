"""Table of a walk's figures. Each figure has one row: left, right, and the same of a cited group."""

import math
from collections.abc import Mapping, Sequence

from app.charts.cycles import is_mean_enough, is_spread_enough
from app.summary.walk_figures import Figure
from app.widgets.table import TableColumn, TableRow
from app.widgets.table_cells import CENTRE, EMPTY, RIGHT, TextCell
from app.widgets.text import SEMIBOLD
from app.wording.body import side_name
from app.wording.numbers import MINUS
from app.wording.translation import capitalised, figure_text, later, tr, tr_n, within_sentence
from app.wording.verdicts import verdict_word
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.verdicts.model import Verdict

FIGURE = 15  # px of the letters of a value
BAND_HEAD = later("ref. ±1 SD")
CARE_MARK = "*"  # behind what is to be read with care


def figure_columns(strides: Mapping[Side, int]) -> list[TableColumn]:
    """Names, both sides with the number of `strides` used above them, and the band."""
    sides = [TableColumn(_side_head(side, strides), is_hidden=bool(strides) and side not in strides) for side in Side]
    return [TableColumn(share=1), *sides, TableColumn(TextCell(tr(BAND_HEAD), align=RIGHT, size=12, tone="ink2"))]


def figure_rows(rows: Sequence[str | Figure]) -> list[TableRow]:
    """Headings (a word) and figures."""
    described, heading = [], ""
    for row in rows:
        if isinstance(row, str):
            heading = row
            described.append(TableRow((TextCell(row, weight=SEMIBOLD, span=4), *[EMPTY] * 3), is_heading=True))
        else:
            described.append(TableRow(_figure_cells(row, heading)))
    return described


def _side_head(side: Side, strides: Mapping[Side, int]) -> TextCell:
    count = strides.get(side)
    words = tr_n("{count} stride", "{count} strides", count).format(count=count) if count is not None else ""
    return TextCell(words, align=RIGHT, size=12, tone="ink2", side=side, spoken=f"{side.letter}, {words}")


def _figure_cells(row: Figure, heading: str) -> tuple[TextCell, ...]:
    name = TextCell(row.name, "" if row.unit == "°" or row.name.endswith(row.unit) else row.unit)
    band = "" if row.band is None else _range(row)
    of_band = _cell(("", band), row, heading, tr("reference"))
    if row.both is not None:
        return name, _cell(_of_both(row), row, heading, tr("both sides"), span=2), EMPTY, of_band
    return name, *(_cell(_of_side(row, side), row, heading, side_name(side), side) for side in Side), of_band


def _cell(
    figure: tuple[str, str], row: Figure, heading: str, who: str, side: Side | None = None, span: int = 1
) -> TextCell:
    """A value and smaller words behind it; grey where it has too few strides to make a mean."""
    value, small = figure
    is_grey = side is not None and side in row.sides and not is_mean_enough(row.sides[side].n)
    return TextCell(
        value,
        small,
        align=CENTRE if span > 1 and value else RIGHT,
        size=FIGURE,
        weight=SEMIBOLD,
        tone="ink3" if is_grey else "ink",
        span=span,
        spoken=_in_words(" ".join(filter(None, figure)), row, heading, who),
    )


def _in_words(words: str, row: Figure, heading: str, who: str) -> str:
    """Say a cell with its row, its side and its unit, for screen readers, which read one cell at a time."""
    name = " ".join(filter(None, [heading, within_sentence(row.name)]))
    has_figure = any(letter.isdigit() for letter in words)  # not reported has no unit
    stated = f"{words} {row.unit}" if has_figure else words or tr("no value")
    if words.endswith(CARE_MARK):
        stated = f"{words.removesuffix(CARE_MARK).rstrip()} {row.unit}, {verdict_word(Verdict.CARE)}"
    return f"{capitalised(name)}, {who}: {stated}"


def _of_both(row: Figure) -> tuple[str, str]:
    if row.unknown_both:
        return "", tr(row.unknown_both)
    assert row.both is not None
    return " ".join(filter(None, _marked((_number(row.both, row.decimals), ""), bool(row.with_care)))), ""


def _of_side(row: Figure, side: Side) -> tuple[str, str]:
    if side in row.unknown:
        return "", tr(row.unknown[side])
    return _marked(_mean(row.sides.get(side), row.decimals), side in row.with_care)


def _mean(value: MeanAndSd | None, decimals: int) -> tuple[str, str]:
    if value is None or not math.isfinite(value.mean):
        return "", tr("none")
    spread = f"± {figure_text(value.sd, f'.{decimals}f')}" if is_spread_enough(value.n) else ""
    return _number(value.mean, decimals), spread


def _marked(cell: tuple[str, str], is_care: bool) -> tuple[str, str]:
    value, addition = cell
    return (value, f"{addition} {CARE_MARK}".lstrip()) if is_care and value else cell


def _range(figure: Figure) -> str:
    assert figure.band is not None
    decimals = figure.decimals if figure.decimals > 1 else 0
    low, high = (_number(value, decimals) for value in figure.band)
    return tr("{low} to {high}").format(low=low, high=high)


def _number(value: float, decimals: int) -> str:
    if not math.isfinite(value):
        return tr("none")
    return figure_text(round(value, decimals) or 0.0, f".{decimals}f").replace("-", MINUS)
