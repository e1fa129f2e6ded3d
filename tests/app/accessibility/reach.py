"""Check that every control can be brought into sight, by geometry, through all that scrolls round it."""

from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtWidgets import QAbstractScrollArea, QWidget

SLACK = 2  # px, of frames that are drawn on the edge


def out_of_reach(window: QWidget) -> list[str]:
    """Say which controls lie outside of what is round them, but for areas that scroll, and outside the window."""
    takers = [
        one
        for one in window.findChildren(QWidget)
        if one.isVisible() and one.isEnabled() and one.focusPolicy() & Qt.FocusPolicy.TabFocus
        if one.window() is window.window()
    ]
    return [f"{type(one).__name__} “{one.accessibleName()}”" for one in takers if not _can_be_seen(one, window)]


def _can_be_seen(widget: QWidget, window: QWidget) -> bool:
    box, inside = widget.rect(), widget
    while inside is not window:
        parent = inside.parentWidget()
        assert parent is not None
        box = box.translated(inside.mapTo(parent, QPoint(0, 0)))
        area = parent.parentWidget()
        if isinstance(area, QAbstractScrollArea) and parent is area.viewport():
            if not _scrolls_to(inside, area):
                return False
            box, parent = QRect(area.rect()), area  # the area itself has to be in sight
        elif not parent.rect().adjusted(-SLACK, -SLACK, SLACK, SLACK).contains(box):
            return False
        inside = parent
    return True


def _scrolls_to(content: QWidget, area: QAbstractScrollArea) -> bool:
    """Whether all of the content comes by when the area is scrolled."""
    room, bars = area.viewport().size(), (area.horizontalScrollBar(), area.verticalScrollBar())
    ways = (content.width() - room.width(), content.height() - room.height())
    return all(bar.maximum() >= way - SLACK for bar, way in zip(bars, ways, strict=True)) and room.height() > 0
