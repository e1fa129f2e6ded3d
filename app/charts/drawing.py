"""Elements that the figures are drawn with.

Lines, boxes, texts and badges as SVG, one unit a point, attributes only.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from app.theme.colours import PAPER
from core.body import Side
from core.samples import FloatArray

MM = 72 / 25.4
COLOURS = {Side.LEFT: PAPER.left, Side.RIGHT: PAPER.right}
DASHES = {Side.LEFT: "", Side.RIGHT: "4.6 2.2"}
BADGE = 9.0


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure, its size in points, and what it shows in words and numbers; without words it is decoration."""

    svg: str
    width: float
    height: float
    alt: str = ""

    def as_data(self) -> dict[str, object]:
        return {"svg": self.svg, "width": self.width, "height": self.height, "alt": self.alt}


def picture(parts: Sequence[str], width: float, height: float, alt: str = "") -> Picture:
    size = f'width="{width:.2f}" height="{height:.2f}" viewBox="0 0 {width:.2f} {height:.2f}"'
    return Picture(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{"".join(parts)}</svg>', width, height, alt)


def line(x1: float, y1: float, x2: float, y2: float, colour: str, width: float, dash: str = "") -> str:
    ends = f'x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}"'
    return f"<line {ends} {_stroke(colour, width, dash)}/>"


def box(x: float, y: float, width: float, height: float, fill: str, edge: str = "none", edge_width: float = 0.0) -> str:
    place = f'x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}"'
    return f'<rect {place} fill="{fill}" stroke="{edge}" stroke-width="{edge_width}"/>'


def circle(x: float, y: float, radius: float, fill: str, edge: str, edge_width: float) -> str:
    look = f'fill="{fill}" stroke="{edge}" stroke-width="{edge_width}"'
    return f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{radius}" {look}/>'


def polygon(corners: Sequence[tuple[float, float]], fill: str) -> str:
    tips = " ".join(f"{x:.2f},{y:.2f}" for x, y in corners)
    return f'<polygon points="{tips}" fill="{fill}"/>'


def text(
    x: float, y: float, stated: str, size: float, *, anchor: str = "start", weight: int = 400, fill: str = PAPER.ink
) -> str:
    look = f'font-family="Inter" font-size="{size}" font-weight="{weight}" fill="{fill}" text-anchor="{anchor}"'
    return f'<text x="{x:.2f}" y="{y:.2f}" {look}>{escape(stated)}</text>'


def curve(x: FloatArray, y: FloatArray, colour: str, width: float, dash: str = "") -> str:
    """Draw a line through points (n,); one that is not known breaks it."""
    path = _path(x, y)
    return f'<path d="{path}" fill="none" stroke-linejoin="round" {_stroke(colour, width, dash)}/>' if path else ""


def area(x: FloatArray, low: FloatArray, high: FloatArray, fill: str, edge: str, edge_width: float) -> str:
    outline = _path(np.concatenate([x, x[::-1]]), np.concatenate([high, low[::-1]]))
    edges = curve(x, low, edge, edge_width) + curve(x, high, edge, edge_width)
    return f'<path d="{outline}Z" fill="{fill}" stroke="none"/>{edges}'


def badge(x: float, y: float, letter: str, side: Side, colour: str, size: float = BADGE) -> str:
    """A letter on a line: in a circle on the left leg's, in a square on the right leg's."""
    half = size / 2
    if side is Side.LEFT:
        shape = circle(x, y, half, PAPER.paper, colour, 1.1)
    else:
        look = f'fill="{PAPER.paper}" stroke="{colour}" stroke-width="1.1"'
        shape = f'<rect x="{x - half:.2f}" y="{y - half:.2f}" width="{size}" height="{size}" {look}/>'
    return shape + text(x, y + 0.36 * 6.6, letter, 6.6, anchor="middle", weight=600)


def marker(x: float, y: float, side: Side, fill: str = PAPER.ink, size: float = 4.0) -> str:
    """A mark at one value: round for the left leg, square for the right."""
    half = size / 2
    if side is Side.LEFT:
        return circle(x, y, half, fill, PAPER.paper, 0.5)
    return box(x - half, y - half, size, size, fill, PAPER.paper, 0.5)


def mixed(colour: str, other: str, share: float) -> str:
    """Give `colour` with a share of `other` in it."""
    one, two = (np.array([int(c[k : k + 2], 16) for k in (1, 3, 5)]) for c in (colour, other))
    return "#" + "".join(f"{round(v):02X}" for v in one + (two - one) * share)


def _stroke(colour: str, width: float, dash: str) -> str:
    dashes = f' stroke-dasharray="{dash}"' if dash else ""
    return f'stroke="{colour}" stroke-width="{width}"{dashes}'


def _path(x: FloatArray, y: FloatArray) -> str:
    parts, is_open = [], False
    for px, py in zip(x, y, strict=True):
        if np.isfinite(py):
            parts.append(f"{'L' if is_open else 'M'}{px:.2f} {py:.2f}")
        is_open = bool(np.isfinite(py))
    return "".join(parts)
