"""In which order are the parts of a widget heard? In that of reading, as its layout has them.

Qt tells assistive technology of them as they are stacked: what came into the widget last is heard last, wherever it
stands.
"""

from collections.abc import Iterator

from PySide6.QtWidgets import QGridLayout, QLayout, QWidget


def hear_as_laid_out(widget: QWidget) -> None:
    """Let the parts of `widget` be heard from the first of its layout to the last; none of them may cover another."""
    layout = widget.layout()
    for part in _parts(layout) if layout is not None else ():
        part.raise_()


def _parts(layout: QLayout) -> Iterator[QWidget]:
    numbers = list(range(layout.count()))
    if isinstance(layout, QGridLayout):
        numbers.sort(key=lambda number: _row_and_column(layout, number))
    for number in numbers:
        item = layout.itemAt(number)
        inner, widget = (item.layout(), item.widget()) if item is not None else (None, None)
        if widget is not None:
            yield widget
        elif inner is not None:
            yield from _parts(inner)


def _row_and_column(layout: QGridLayout, number: int) -> tuple[int, int]:
    place: tuple[int, int, int, int] = layout.getItemPosition(number)  # type: ignore[assignment]  # the stubs say object
    return place[:2]
