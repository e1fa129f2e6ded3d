"""Accessible tree of a page:

its elements in their order, and what is wrong with them, in words. It is what assistive technology gets.

All is read through Qt's accessibility interface, which is what the bridges to AT-SPI, UI Automation and NSAccessibility
read. No screen reader is received here.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QAccessible, QAccessibleInterface
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QTextBrowser, QWidget

Role, Words = QAccessible.Role, QAccessible.Text
WORKED = frozenset(
    (Role.Button, Role.CheckBox, Role.RadioButton, Role.ComboBox, Role.EditableText, Role.SpinBox, Role.Link)
)
SEEN = frozenset((Role.Chart, Role.Graphic))
MEANINGLESS = frozenset((Role.NoRole, Role.Client, Role.Pane, Role.Border, Role.LayeredPane, Role.Window))
IDENTIFIER = re.compile(r"[a-z]+(_[a-z0-9]+)+|qt_\w*|_\w*")
LEGS_TOGETHER = ("_Tile “R thigh", "BodyFigure “The patient faces you")  # words go from leg to leg, not from row to row
MOST_STOPS = 120  # more than any page has
MOST_LINKS = 50  # of a text


@dataclass(frozen=True, slots=True)
class Element:
    """One element of the tree; `kind` is the class of its widget, empty of a cell."""

    role: QAccessible.Role
    name: str
    description: str
    kind: str
    object_name: str
    is_focusable: bool
    is_enabled: bool
    is_checked: bool

    @property
    def stated(self) -> str:
        return f"{self.kind or 'element'} ({self.role.name}) “{self.name}”"


def elements(page: QWidget) -> list[Element]:
    """Give all that is in sight, a widget before what is inside it."""
    return [_element(one) for one in _interfaces(_interface(page))]


def complaints(page: QWidget) -> list[str]:
    """Say what is wrong with the elements of a page; an empty list where nothing is."""
    return [f"{one.stated} {wrong}" for one in elements(page) for wrong in _wrong_with(one)]


def tab_stops(window: QWidget) -> list[QWidget]:
    """Press Tab from where the focus is until it is there again; a window that keeps the focus gives fewer stops."""
    stops: list[QWidget] = []
    while (focused := QApplication.focusWidget()) is not None and focused not in stops and len(stops) < MOST_STOPS:
        stops.append(focused)
        for _ in range(MOST_LINKS if isinstance(focused, QTextBrowser) else 1):  # Tab goes through its links first
            QTest.keyClick(focused, Qt.Key.Key_Tab)
            if QApplication.focusWidget() is not focused:
                break
    assert QApplication.focusWidget() is (stops[0] if stops else None), f"Tab is kept by {_called(stops[-1])}"
    assert all(window.isAncestorOf(one) for one in stops)
    return stops


def wrong_order(window: QWidget) -> list[str]:
    """Say which controls Tab leaves out, and where it goes against the order of reading."""
    stops = tab_stops(window)
    takers = [
        one
        for one in window.findChildren(QWidget)
        if one.isVisible() and one.isEnabled() and one.focusPolicy() & Qt.FocusPolicy.TabFocus
        if one.window() is window.window() and one.focusProxy() is None
    ]
    missed = [f"{_called(one)} is never reached" for one in takers if one not in stops]
    back = [
        f"{_called(other)} comes after {_called(one)} and stands before it"
        for one, other in pairwise(stops)
        if one.parentWidget() is other.parentWidget() and _is_before(_place(other), _place(one))
    ]
    return missed + back


def wrong_hearing(page: QWidget) -> list[str]:
    """Say what is received after what is before it, of the parts of one widget; legs may each be reported as a
    whole."""
    received = [[_widget(one.child(k)) for k in range(one.childCount())] for one in _interfaces(_interface(page))]
    shown = [[part for part in parts if part is not None and part.window() is page.window()] for parts in received]
    return [
        f"{_called(other)} is heard after {_called(one)} and stands before it"
        for parts in shown
        for one, other in pairwise(parts)
        if _is_before(_place(other), _place(one)) and not _called(other).startswith(LEGS_TOGETHER)
    ]


def _interface(one: QWidget) -> QAccessibleInterface | None:
    return QAccessible.queryAccessibleInterface(one)


def _widget(one: QAccessibleInterface | None) -> QWidget | None:
    """The widget of an element, where it is in sight and has one."""
    found = one.object() if one is not None and not one.state().invisible else None
    return found if isinstance(found, QWidget) else None


def _interfaces(one: QAccessibleInterface | None) -> Iterator[QAccessibleInterface]:
    if one is None or one.state().invisible:
        return
    yield one
    for k in range(one.childCount()):
        yield from _interfaces(one.child(k))


def _element(one: QAccessibleInterface) -> Element:
    state, widget = one.state(), one.object()
    return Element(
        one.role(),
        one.text(Words.Name).strip(),
        one.text(Words.Description).strip(),
        type(widget).__name__ if widget is not None else "",
        widget.objectName() if widget is not None else "",
        is_focusable=bool(state.focusable),
        is_enabled=not state.disabled,
        is_checked=bool(state.checked),
    )


def _wrong_with(one: Element) -> Iterator[str]:
    if (one.is_focusable and one.role is not Role.Cell) or one.role in WORKED | SEEN:  # a cell may be blank
        if not one.name:
            yield "has no name"
        elif not re.search(r"\w", one.name):
            yield "has a name without a word"
        elif one.name in (one.kind, one.object_name) or IDENTIFIER.fullmatch(one.name):
            yield "has a name for programmers"
    if one.is_focusable and one.role in MEANINGLESS:
        yield "takes the focus and has no role"
    if one.role is Role.Chart and not one.description:
        yield "is not described"
    if one.role is Role.ComboBox and not one.description:
        yield "tells its choice and not what is chosen"  # where Qt gives the choice as its name


def _place(one: QWidget) -> QRect:
    return QRect(one.mapTo(one.window(), QPoint(0, 0)), one.size())


def _is_before(one: QRect, other: QRect) -> bool:
    """Whether one is read before the other: it ends above it and begins no further right, or is left in its row."""
    is_above = one.bottom() < other.top() and one.left() <= other.right()
    is_in_row = min(one.bottom(), other.bottom()) - max(one.top(), other.top()) > min(one.height(), other.height()) / 2
    return is_above or (is_in_row and one.right() < other.left())


def _called(one: QWidget) -> str:
    return f"{type(one).__name__} “{one.accessibleName()}”"
