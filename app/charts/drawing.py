"""Paper's canvas: lines, boxes, texts and markers of a figure as SVG, one unit a point, attributes only."""

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


class Drawing:
    """Paper's canvas: gathers the elements of a figure in the order in which they cover one another."""

    def __init__(self) -> None:
        self.parts: list[str] = []

    def picture(self, width: float, height: float, alt: str = "") -> Picture:
        size = f'width="{width:.2f}" height="{height:.2f}" viewBox="0 0 {width:.2f} {height:.2f}"'
        svg = f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{"".join(self.parts)}</svg>'
        return Picture(svg, width, height, alt)

    def line(self, x1: float, y1: float, x2: float, y2: float, colour: str, width: float, dash: str = "") -> None:
        ends = f'x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}"'
        self.parts.append(f"<line {ends} {_stroke(colour, width, dash)}/>")

    def box(
        self, x: float, y: float, width: float, height: float, fill: str, edge: str = "none", edge_width: float = 0.0
    ) -> None:
        place = f'x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}"'
        self.parts.append(f'<rect {place} fill="{fill}" stroke="{edge}" stroke-width="{edge_width}"/>')

    def circle(self, x: float, y: float, radius: float, fill: str, edge: str, edge_width: float) -> None:
        look = f'fill="{fill}" stroke="{edge}" stroke-width="{edge_width}"'
        self.parts.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{radius}" {look}/>')

    def polygon(self, corners: Sequence[tuple[float, float]], fill: str) -> None:
        tips = " ".join(f"{x:.2f},{y:.2f}" for x, y in corners)
        self.parts.append(f'<polygon points="{tips}" fill="{fill}"/>')

    def text(
        self,
        x: float,
        y: float,
        stated: str,
        size: float,
        *,
        anchor: str = "start",
        weight: int = 400,
        fill: str = PAPER.ink,
        halo: float = 0.0,
    ) -> None:
        """Letters on a line; a `halo` parts them from the curves that they are read over."""
        look = f'font-family="Inter" font-size="{size}" font-weight="{weight}" fill="{fill}" text-anchor="{anchor}"'
        around = f'paint-order="stroke" stroke="{PAPER.paper}" stroke-width="{halo}" stroke-linejoin="round" '
        place = f'{around if halo else ""}x="{x:.2f}" y="{y:.2f}"'
        self.parts.append(f"<text {place} {look}>{escape(stated)}</text>")

    def curve(self, x: FloatArray, y: FloatArray, colour: str, width: float, dash: str = "") -> None:
        """Draw a line through points (n,); one that is not known breaks it."""
        if path := _path(x, y):
            look = _stroke(colour, width, dash)
            self.parts.append(f'<path d="{path}" fill="none" stroke-linejoin="round" {look}/>')

    def area(self, x: FloatArray, low: FloatArray, high: FloatArray, fill: str, edge: str, edge_width: float) -> None:
        outline = _path(np.concatenate([x, x[::-1]]), np.concatenate([high, low[::-1]]))
        self.parts.append(f'<path d="{outline}Z" fill="{fill}" stroke="none"/>')
        self.curve(x, low, edge, edge_width)
        self.curve(x, high, edge, edge_width)

    def badge(self, x: float, y: float, letter: str, side: Side, colour: str, size: float = BADGE) -> None:
        """A letter on a line: in a circle on the left leg's, in a square on the right leg's."""
        half = size / 2
        if side is Side.LEFT:
            self.circle(x, y, half, PAPER.paper, colour, 1.1)
        else:
            self.box(x - half, y - half, size, size, PAPER.paper, colour, 1.1)
        self.text(x, y + 0.36 * 6.6, letter, 6.6, anchor="middle", weight=600)


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
