"""Shapes of the drawn body: those of `resources/images/body.svg`, read once, without their colours."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from xml.etree import ElementTree

from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainterPath

SVG = "{http://www.w3.org/2000/svg}"
TOKEN = re.compile(r"[A-Za-z]|-?\d*\.?\d+")
POINTS = {"M": 1, "L": 1, "C": 3}  # how many points each command of a path takes

WHOLE = QRectF(0, 0, 200, 496)
LEGS = QRectF(30, 194, 140, 300)  # with the pelvis
BARE_LEGS = QRectF(35, 217, 130, 274)  # without, where there is little room


@dataclass(frozen=True, slots=True)
class BodyShapes:
    """Outlines and marked points by the ids of the drawing, in its units; the patient faces you."""

    outlines: Mapping[str, QPainterPath]
    points: Mapping[str, QPointF]


@cache
def body_shapes() -> BodyShapes:
    """Read the drawing; raises FileNotFoundError where the installation is incomplete."""
    # our own file, never a user's
    root = ElementTree.fromstring((files("resources") / "images" / "body.svg").read_text(encoding="utf-8"))
    outlines = {path.attrib["id"]: read_path(path.attrib["d"]) for path in root.iter(f"{SVG}path")}
    points = {
        circle.attrib["id"]: QPointF(float(circle.attrib["cx"]), float(circle.attrib["cy"]))
        for circle in root.iter(f"{SVG}circle")
    }
    return BodyShapes(outlines, points)


def read_path(text: str) -> QPainterPath:
    """Build the outline of an SVG path's `d`; ValueError for commands other than absolute M, L, C and Z."""
    path = QPainterPath()
    tokens = TOKEN.findall(text)
    while tokens:
        command = tokens.pop(0)
        if command == "Z":
            path.closeSubpath()
            continue
        if command not in POINTS:
            raise ValueError(f"the path has the command {command}, expected M, L, C or Z")
        count = 2 * POINTS[command]
        numbers = [float(token) for token in tokens[:count]]
        if len(numbers) < count:
            raise ValueError(f"{command} has {len(numbers)} numbers, expected {count}")
        del tokens[:count]
        points = [QPointF(x, y) for x, y in zip(numbers[::2], numbers[1::2], strict=True)]
        if command == "M":
            path.moveTo(points[0])
        elif command == "L":
            path.lineTo(points[0])
        else:
            path.cubicTo(*points)
    return path
