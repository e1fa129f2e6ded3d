"""Room for every word on a page: what is cut, and where. For any page, at any size and in any language."""

from collections.abc import Iterator

from PySide6.QtCore import QPoint, QRect, QRectF, Qt
from PySide6.QtGui import QFontMetrics
from PySide6.QtWidgets import QAbstractButton, QAbstractScrollArea, QApplication, QComboBox, QLabel, QLineEdit, QWidget

from app.widgets.choice import Choice
from app.widgets.painted_text import PaintedText
from app.widgets.table import CellTable

SLACK = 1.5  # px: metrics are rounded up, letters are not that wide


def settle() -> None:
    """Let layouts come to rest: each round may ask for another."""
    application = QApplication.instance()
    assert application is not None
    for _ in range(5):
        application.processEvents()


def words_cut(page: QWidget) -> list[str]:
    """Give what is cut of all words in sight on `page`, in words; an empty list where everything has its room.

    Looked at are `Text` and other labels, buttons, boxes of choices, the words that wait in an empty field, and what
    widgets paint themselves and report by `painted_texts`. Each must have the room it needs in its own box, and that
    box must lie inside all that it is part of, up to the page or to an area that scrolls.
    """
    settle()
    return [cut for widget in _in_sight(page) for cut in _cut_of(widget, page)]


def _in_sight(page: QWidget) -> Iterator[QWidget]:
    if page.isVisible():
        yield page
    for widget in page.findChildren(QWidget):
        if widget.isVisibleTo(page) and not isinstance(widget, QAbstractScrollArea):
            yield widget


def _cut_of(widget: QWidget, page: QWidget) -> Iterator[str]:
    own = widget.rect()
    if hasattr(widget, "painted_texts"):
        for text in widget.painted_texts():
            yield from _cut_of_painted(text, widget)
            if text.text:
                yield from _cut_by_parents(_ink(text), widget, page, text.text)
    elif isinstance(widget, QLabel):
        if widget.text():
            yield from _cut_of_label(widget)
            yield from _cut_by_parents(_label_ink(widget), widget, page, widget.text())
    elif isinstance(widget, (QAbstractButton, QComboBox)):
        # what was typed may be cut in a choice, whose tooltip has it whole
        needed = widget.minimumSizeHint() if isinstance(widget, Choice) else widget.sizeHint()
        words = widget.text() if isinstance(widget, QAbstractButton) else widget.currentText()
        if words and (needed.width() > own.width() + SLACK or needed.height() > own.height() + SLACK):
            yield _stated(widget, words, f"needs {needed.width()} x {needed.height()}")
        if words:
            yield from _cut_by_parents(own, widget, page, words)
    elif isinstance(widget, QLineEdit) and not widget.text():
        needed_width = widget.fontMetrics().horizontalAdvance(widget.placeholderText())
        room = own.width() - widget.textMargins().left() - widget.textMargins().right()
        if needed_width > room + SLACK:
            yield _stated(widget, widget.placeholderText(), f"needs {needed_width} in {room}")


def _cut_of_painted(text: PaintedText, widget: QWidget) -> Iterator[str]:
    if not text.text:
        return
    ink = _ink(text)
    if ink.width() > text.box.width() + SLACK or (text.wraps and ink.height() > text.box.height() + SLACK):
        size = f"{text.box.width():.0f} x {text.box.height():.0f}"
        yield _stated(widget, text.text, f"needs {ink.width()} x {ink.height()} in {size}")


def _ink(text: PaintedText) -> QRect:
    """Give where the letters come to lie; a word that is wider than its lines sticks out of them."""
    if not text.wraps:
        return text.needed
    metrics = QFontMetrics(text.font)
    needed = QRectF(text.needed)
    widest = max((metrics.horizontalAdvance(word) for word in text.text.split()), default=0)
    needed.setWidth(max(needed.width(), widest))
    return needed.toRect()


def _cut_of_label(label: QLabel) -> Iterator[str]:
    inside = label.contentsRect()
    metrics = label.fontMetrics()
    if label.wordWrap():
        needed = max((metrics.horizontalAdvance(word) for word in label.text().split()), default=0)
        high = label.heightForWidth(label.width())
        if high > label.height() + SLACK:
            yield _stated(label, label.text(), f"needs a height of {high}")
    else:
        needed = max(metrics.horizontalAdvance(line) for line in label.text().split("\n"))
        if label.sizeHint().height() > label.height() + SLACK:
            yield _stated(label, label.text(), f"needs a height of {label.sizeHint().height()}")
    if needed > inside.width() + SLACK:
        yield _stated(label, label.text(), f"needs {needed} in {inside.width()}")


def _label_ink(label: QLabel) -> QRect:
    flags = int(label.alignment().value) | (Qt.TextFlag.TextWordWrap.value if label.wordWrap() else 0)
    return label.fontMetrics().boundingRect(label.contentsRect(), flags, label.text())


def _cut_by_parents(ink: QRect, widget: QWidget, page: QWidget, words: str) -> Iterator[str]:
    """Report if the words lie outside what they are part of. What scrolls can be brought into sight."""
    inside = widget
    while inside is not page:
        parent = inside.parentWidget()
        if parent is None or isinstance(parent.parentWidget(), QAbstractScrollArea):
            return
        ink = ink.translated(inside.mapTo(parent, QPoint(0, 0)))
        inside = parent
        outside = ink.adjusted(2, 2, -2, -2)
        if not inside.rect().contains(outside):
            yield _stated(widget, words, f"is cut by {type(inside).__name__}")
            return


def _stated(widget: QWidget, words: str, what: str) -> str:
    return f"{type(widget).__name__} {widget.width()} x {widget.height()} “{words}” {what}"


def is_cut(widget: QWidget) -> bool:
    """Return whether a widget has less room than its words need."""
    if isinstance(widget, QLabel):
        room = widget.size().shrunkBy(widget.contentsMargins())
        flags = Qt.TextFlag.TextWordWrap if widget.wordWrap() else 0
        needed = widget.fontMetrics().boundingRect(0, 0, room.width(), 10_000, int(flags), widget.text())
        return needed.width() > room.width() or needed.height() > room.height()
    if isinstance(widget, CellTable):
        is_narrow = any(widget.columnWidth(k) < need for k, need in enumerate(widget.needed_widths))
        return is_narrow or widget.height() < widget.minimumSizeHint().height()
    if isinstance(widget, QAbstractButton | QComboBox) and widget.accessibleName():
        need = widget.minimumSizeHint()
        return need.width() > widget.width() or need.height() > widget.height()
    return False
