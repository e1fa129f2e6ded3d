"""Small pictures of page one's four values: where each lies on its scale, and which way it changed."""

import math

from app.charts.drawing import MM, Drawing, Picture
from app.charts.joint_on_paper import CURVES
from app.summary.tiles import Tile, TileChange, TileValue
from app.theme.colours import LIGHT, PAPER
from core.body import Side

WIDTH, HEIGHT, TRACK = 34 * MM, 12.0, 2.6
NOW, LAST, EDGE, TICK = 2.6, 2.1, 1.1, 10.0  # radii, their line's width, and a goal's length
ARROW = 6.5


def bar(tile: Tile) -> Picture:
    """The zone of the reference, the last visit's ring, today's dot, and the goal's tick."""
    y, (low, high) = HEIGHT / 2, tile.scale

    def x(value: float) -> float:
        return NOW + (WIDTH - 2 * NOW) * min(max((value - low) / (high - low), 0.0), 1.0)

    draw = Drawing()
    draw.box(0, y - TRACK / 2, WIDTH, TRACK, LIGHT.track)
    if tile.zone is not None:
        left, right = (x(edge) for edge in tile.zone)
        draw.box(left, y - TRACK / 2, right - left, TRACK, LIGHT.band_1sd)
    for goal in tile.goals:
        draw.line(x(goal), y - TICK / 2, x(goal), y + TICK / 2, PAPER.ink, 1.3)
    for value in tile.values:
        if math.isfinite(value.value):
            if math.isfinite(value.last):
                draw.line(x(value.last), y, x(value.value), y, PAPER.note, TRACK * 0.6)
                draw.circle(x(value.last), y, LAST, PAPER.paper, _colour(value), EDGE)
            is_hollow = value.side is Side.RIGHT
            fill = PAPER.paper if is_hollow else _colour(value)
            draw.circle(x(value.value), y, NOW, fill, _colour(value), EDGE)
    return draw.picture(WIDTH, HEIGHT)


def arrow(change: TileChange) -> Picture:
    """Up or down; filled where the change is beyond its error."""
    top, bottom = (0.8, ARROW - 0.8) if change.rises else (ARROW - 0.8, 0.8)
    corners = f"{ARROW / 2},{top} {ARROW - 0.6},{bottom} 0.6,{bottom}"
    fill = PAPER.ink if change.is_beyond_error else PAPER.paper
    draw = Drawing()
    draw.parts.append(f'<polygon points="{corners}" fill="{fill}" stroke="{PAPER.ink}" stroke-width="0.9"/>')
    return draw.picture(ARROW, ARROW)


def _colour(value: TileValue) -> str:
    return CURVES[value.side] if value.side is not None else PAPER.ink
