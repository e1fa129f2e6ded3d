"""Rows and columns of a page: their parts in order, with the gaps between them and the margins round all."""

from typing import TypeVar

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QBoxLayout, QLayout, QWidget

from app.theme.current import scaled

ALL_ROOM = Qt.AlignmentFlag(0)
Box = TypeVar("Box", bound=QBoxLayout)
Part = QWidget | QLayout
Placed = Part | int | tuple[Part, int] | tuple[QWidget, int, Qt.AlignmentFlag]


def lay_out(
    box: Box,
    *parts: Placed,
    margins: float | tuple[float, float, float, float] | None = None,
    spacing: float | None = None,
) -> Box:
    """Put parts into a row or column, behind those it has, and give it back.

    A number is a stretch. A part may come with its stretch, a widget with its place in the room it has. Lengths are
    those of the design; `margins` are the same on all sides, or left, top, right and bottom.
    """
    for part in parts:
        if isinstance(part, int):
            box.addStretch(part)
        else:
            _add(box, *(part if isinstance(part, tuple) else (part,)))
    if margins is not None:
        scaled(box.setContentsMargins, *(margins if isinstance(margins, tuple) else (margins,) * 4))
    if spacing is not None:
        scaled(box.setSpacing, spacing)
    return box


def _add(box: QBoxLayout, part: Part, stretch: int = 0, place: Qt.AlignmentFlag = ALL_ROOM) -> None:
    if isinstance(part, QLayout):
        box.addLayout(part, stretch)
    else:
        box.addWidget(part, stretch, place)
