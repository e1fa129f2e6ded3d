"""What a widget lies on, which the style paints under it: a box with round corners, or a strip with a line along it."""

from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget

from app.theme.theme import CONTROL_RADIUS

GROUND = "ground"  # property of a widget


@dataclass(frozen=True, slots=True)
class Ground:
    """`fill` and `line` are tokens of colours, empty: none. `inset` is in px of the screen.

    `edge`, at the top or bottom: it has no round corners, and its line is along this edge only.
    """

    fill: str = ""
    line: str = ""
    width: float = 1
    radius: float = CONTROL_RADIUS
    inset: float = 0.5
    edge: Qt.Edge | None = None


def set_ground(widget: QWidget, ground: Ground | None) -> None:
    """Let the style paint this under `widget`, instead of what was there before."""
    if ground != widget.property(GROUND):
        widget.setProperty(GROUND, ground)
        widget.setAttribute(Qt.WidgetAttribute.WA_StyledBackground, ground is not None)
        widget.update()
