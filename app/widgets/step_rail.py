"""Rail of rows at the left that shows where the user is and can go.

Its rows are the steps of a session, or the ways on from Home.
"""

from collections.abc import Callable

from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import (
    QAccessible,
)
from PySide6.QtWidgets import QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import on_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.icons import Icon
from app.widgets.header import ProductMark
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.rail_row import BelowRow, RailButton, RailForm, RailRow
from app.widgets.reading_area import scrolled
from app.widgets.text import REGULAR, SEMIBOLD, Text
from app.wording.translation import tr


def wizard_below() -> tuple[BelowRow, ...]:
    return (
        BelowRow("patients", tr("All patients"), Icon.HOME),
        BelowRow("settings", tr("Settings"), Icon.SETTINGS),
        BelowRow("help", tr("Help"), Icon.HELP, tr("F1")),
    )


def home_below(*, can_lock: bool) -> tuple[BelowRow, ...]:
    lock = (BelowRow("lock", tr("Lock"), Icon.LOCK),) if can_lock else ()  # a demonstration keeps nobody's secrets
    return (
        *lock,
        BelowRow("look", tr("Appearance"), Icon.LIGHT_OR_DARK),
        BelowRow("settings", tr("Settings"), Icon.SETTINGS),
        BelowRow("help", tr("Help"), Icon.HELP, tr("F1")),
    )


class StepRail(QWidget):
    """One stop for Tab: within it the arrows go from row to row, Enter or Space presses one."""

    accessible_role = QAccessible.Role.Grouping

    step_pressed = Signal(int)
    below_pressed = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._form = RailForm.USUAL
        set_ground(self, Ground("sunken", radius=0, inset=0))
        self._below_names: list[str] = []
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self.setAccessibleName(tr("Steps"))
        self.rows: list[RailButton] = []
        self.below: list[RailButton] = []
        self._mark = ProductMark()
        self._name = Text("Gaitwright", size=18, weight=SEMIBOLD)
        self._note = Text(size=12, tone="ink2", wraps=True)
        self._tag = _NameTag(self)
        self._build()
        self.show_below(wizard_below())
        on_theme(self._apply_theme)

    @property
    def form(self) -> RailForm:
        return self._form

    def show_rows(self, rows: tuple[RailRow, ...]) -> None:
        """Show the steps; rows that stay keep the focus."""
        self._keep(self.rows, len(rows), self._steps, self._on_step_clicked)
        for number, (widget, row) in enumerate(zip(self.rows, rows, strict=True)):
            widget.show_row(row, number + 1, len(rows))
        self._set_tab_stop(next((row for row in self._all() if row.hasFocus()), None))

    def show_below(self, rows: tuple[BelowRow, ...], note: str = "") -> None:
        """Show the rows at the bottom, and a word above them."""
        self._keep(self.below, len(rows), self._foot, self._on_below_clicked)
        self._below_names = [row.name for row in rows]
        for widget, row in zip(self.below, rows, strict=True):
            widget.show_below(row)
        self._note.setText(note)
        self._show_words()

    def set_form(self, form: RailForm) -> None:
        if form is not self._form:
            self._form = form
            self._apply_theme()

    def focus(self) -> None:
        """Give the focus to the row of the current step."""
        current = next((row for row in self.rows if row.is_current), next(iter(self._all()), None))
        if current is not None:
            current.setFocus(Qt.FocusReason.OtherFocusReason)

    def _build(self) -> None:
        self._head = QWidget()
        self._mark.setParent(self._head)
        self._name.setParent(self._head)
        self._head.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self._inside = QWidget()
        self._column = QVBoxLayout(self._inside)
        self._steps = QVBoxLayout()
        self._foot = QVBoxLayout()
        for layout in (self._steps, self._foot):
            layout.setSpacing(0)
        self._note_row = lay_out(QVBoxLayout(), self._note)
        lay_out(self._column, self._head, self._steps, 1, self._note_row, self._foot, spacing=0)
        self._scroll = scrolled(self._inside)
        self._scroll.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)  # wheel and arrows scroll
        lay_out(QVBoxLayout(self), self._scroll, margins=0)

    def _keep(self, rows: list[RailButton], count: int, layout: QVBoxLayout, slot: Callable[[], None]) -> None:
        while len(rows) > count:
            gone = rows.pop()
            layout.removeWidget(gone)
            gone.hide()
            gone.deleteLater()
        while len(rows) < count:
            row = RailButton()
            row.set_form(self._form)
            row.clicked.connect(slot)
            row.moved.connect(self._on_moved)
            row.looked_at.connect(self._on_looked_at)
            layout.addWidget(row)
            rows.append(row)
            hear_as_laid_out(self._inside)

    def _all(self) -> list[RailButton]:
        return [*self.rows, *self.below]

    def _set_tab_stop(self, stop: RailButton | None = None) -> None:
        """Let Tab stop at one row only: the one last used, or the current step's."""
        stop = stop or next((row for row in self.rows if row.is_current), next(iter(self._all()), None))
        for row in self._all():
            row.setFocusPolicy(Qt.FocusPolicy.StrongFocus if row is stop else Qt.FocusPolicy.ClickFocus)

    def _on_step_clicked(self) -> None:
        self.step_pressed.emit(next(k for k, row in enumerate(self.rows) if row is self.sender()))

    def _on_below_clicked(self) -> None:
        self.below_pressed.emit(self._below_names[next(k for k, row in enumerate(self.below) if row is self.sender())])

    def _on_moved(self, steps: int) -> None:
        rows = self._all()
        at = next(k for k, row in enumerate(rows) if row is self.sender())
        rows[min(max(at + steps, 0), len(rows) - 1)].setFocus(Qt.FocusReason.OtherFocusReason)

    def _on_looked_at(self, is_looked_at: bool) -> None:
        row = self.sender()
        assert isinstance(row, RailButton)
        if row.hasFocus():
            self._set_tab_stop(row)
            self._scroll.ensureWidgetVisible(row, 0, 0)
        if is_looked_at and self._form is RailForm.COMPACT:
            self._tag.name(row)
        else:
            self._tag.hide()

    def _show_words(self) -> None:
        has_words = self._form is not RailForm.COMPACT
        self._name.setVisible(has_words)
        self._note.setVisible(has_words and bool(self._note.text()))

    def _apply_theme(self) -> None:
        is_compact = self._form is RailForm.COMPACT
        self.setFixedWidth(px(self._form.value))
        self._head.setFixedHeight(px(53 if is_compact else 72))
        left = px(6 if is_compact else 12)
        x, y = (18, 12) if is_compact else (17, 14)
        self._mark.move(px(x) - left, px(y))
        self._name.setGeometry(px(50) - left, 0, px(self._form.value - 50), px(56))
        self._column.setContentsMargins(left, 0, 0, px(6 if is_compact else 20))
        beside_note = (px(31) - left, px(12), px(12), px(8))
        self._note_row.setContentsMargins(*((0, 0, 0, 0) if is_compact else beside_note))
        for row in self._all():
            row.set_form(self._form)
        self._tag.hide()
        self._show_words()


class _NameTag(Text):
    """What a row is called, beside it, where the rail has no room for words."""

    def __init__(self, rail: QWidget) -> None:
        super().__init__(size=14, weight=REGULAR, tone="inv_ink", parent=rail)
        self._rail = rail
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        set_ground(self, Ground("inv", inset=0))
        scaled(self.setContentsMargins, 12, 8, 12, 8)
        self.hide()

    def name(self, row: RailButton) -> None:
        window = self._rail.window()
        if self.parentWidget() is not window:
            self.setParent(window)
        self.setText(", ".join(filter(None, [row.text(), row.note])))
        self.adjustSize()
        corner = row.mapTo(window, QPoint(row.width() + px(8), (row.height() - self.height()) // 2))
        self.move(corner)
        self.raise_()
        self.show()
