"""Small pictures beside a figure: where both legs lie with their errors, and how far a curve lies from its band."""

import math

from app.charts.drawing import COLOURS, MM, Picture, box, line, marker, picture
from app.summary.numbers_in_words import fixed
from app.summary.what_differs import LegsRow
from app.theme.colours import PAPER
from app.wording.body import side_name
from core.body import Side

STRIP_WIDTH, STRIP_HEIGHT = 29 * MM, 8.4 * MM
SCALE_WIDTH, SCALE_HEIGHT = 18 * MM, 9.0
SCALE_DEG, LABORATORIES_DEG = 15.0, 7.0  # what a scale reaches, and how much laboratories differ in height
EDGE = 5.0
AROUND = 1.25  # what is drawn reaches so much farther than what lies in it


def strip(row: LegsRow) -> Picture:
    """The left leg's value above, the right leg's below, each with half of the error as whisker, over the band."""
    values = {side: value.mean for side, value in row.values.items() if math.isfinite(value.mean)}
    reach = row.difference.error / 2 if row.difference.is_judged else 0.0
    ends = [value + sign * reach for value in values.values() for sign in (-1, 1)]
    if row.band is not None:
        ends += row.band
    if not ends:
        return picture([], STRIP_WIDTH, STRIP_HEIGHT)
    middle = (min(ends) + max(ends)) / 2
    half = max(AROUND * (max(ends) - min(ends)) / 2, 0.1 * abs(middle), 1e-6)

    def x(value: float) -> float:
        return EDGE + (STRIP_WIDTH - 2 * EDGE) * (value - middle + half) / (2 * half)

    parts = [line(0, STRIP_HEIGHT / 2, STRIP_WIDTH, STRIP_HEIGHT / 2, PAPER.note, 0.4)]
    if row.band is not None:
        low, high = row.band
        for share, fill, edge in (
            (1.0, PAPER.band_2sd, PAPER.band_2sd_edge),
            (0.5, PAPER.band_1sd, PAPER.band_1sd_edge),
        ):
            left, right = (x((low + high) / 2 + sign * share * (high - low) / 2) for sign in (-1, 1))
            parts.append(box(left, 2, right - left, STRIP_HEIGHT - 4, fill, edge, 0.35))
        parts.append(line(x((low + high) / 2), 2, x((low + high) / 2), STRIP_HEIGHT - 2, PAPER.band_mean, 0.6))
    for side, value in values.items():
        y = STRIP_HEIGHT * (0.3 if side is Side.LEFT else 0.7)
        if reach:
            parts.append(line(x(value - reach), y, x(value + reach), y, PAPER.ink, 0.9))
            parts += [
                line(x(value + s * reach), y - 2.4, x(value + s * reach), y + 2.4, PAPER.ink, 0.9) for s in (-1, 1)
            ]
        parts.append(marker(x(value), y, side, COLOURS[side] if side is Side.LEFT else PAPER.paper, 5.6))
        if side is Side.RIGHT:
            parts.append(box(x(value) - 2.5, y - 2.5, 5, 5, PAPER.paper, COLOURS[side], 1.2))
    stated = ", ".join(f"{side_name(side)} {fixed(value, row.decimals)}" for side, value in values.items())
    return picture(parts, STRIP_WIDTH, STRIP_HEIGHT, f"{row.name}: {stated}.")


def height_scale(offset_deg: float, side: Side) -> Picture:
    """How far a curve lies from the band as a whole, beside how much laboratories differ; at its edge where farther."""
    y, middle = SCALE_HEIGHT / 2, SCALE_WIDTH / 2

    def x(value: float) -> float:
        return middle + (middle - 4) * max(-1.0, min(1.0, value / SCALE_DEG))

    low, high = x(-LABORATORIES_DEG), x(LABORATORIES_DEG)
    parts = [
        line(0, y, SCALE_WIDTH, y, PAPER.note, 0.5),
        box(low, 1, high - low, SCALE_HEIGHT - 2, PAPER.band_1sd),
        line(middle, 0.5, middle, SCALE_HEIGHT - 0.5, PAPER.ink, 0.6),
    ]
    if side is Side.LEFT:
        parts.append(marker(x(offset_deg), y, side, COLOURS[side], 5.6))
    else:
        parts.append(box(x(offset_deg) - 2.5, y - 2.5, 5, 5, PAPER.paper, COLOURS[side], 1.2))
    return picture(parts, SCALE_WIDTH, SCALE_HEIGHT)
