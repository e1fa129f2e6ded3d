"""Order in which a screen reader reads the parts of a widget: that of reading, as its layout has them.

Qt reports assistive technology of them as they are stacked: what came into the widget last is received last, wherever
it is. Layouts are asked for the places of widgets and never for their items: an item that Qt deletes would leave its
wrapper behind, and whatever comes to lie at its address next would be taken for it.
"""

from collections.abc import Iterator, Sequence

from PySide6.QtWidgets import QGridLayout, QLayout, QWidget


def hear_as_laid_out(widget: QWidget) -> None:
    """Let screen readers read the parts of `widget` in the order of its layout; none may cover another."""
    layout = widget.layout()
    if layout is not None:
        for part in _parts(layout, [one for one in widget.children() if isinstance(one, QWidget)]):
            part.raise_()


def _parts(layout: QLayout, widgets: Sequence[QWidget]) -> Iterator[QWidget]:
    placed: list[tuple[int, QWidget | QLayout]] = [(layout.indexOf(one), one) for one in widgets]
    placed += [(layout.indexOf(one), one) for one in layout.children() if isinstance(one, QLayout)]
    inside = [(_place(layout, number), part) for number, part in placed if number >= 0]
    for _, part in sorted(inside, key=lambda one: one[0]):
        if isinstance(part, QLayout):
            yield from _parts(part, widgets)
        else:
            yield part


def _place(layout: QLayout, number: int) -> tuple[int, int]:
    if not isinstance(layout, QGridLayout):
        return 0, number
    place: tuple[int, int, int, int] = layout.getItemPosition(number)  # type: ignore[assignment]  # the stubs say object
    return place[:2]
