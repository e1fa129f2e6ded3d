"""List of the recorded walks, each with its condition and what became of it.

Nothing is deleted: a walk can come back.
"""

from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import QEvent, QObject, QRectF, Qt, Signal
from PySide6.QtGui import QAccessible, QKeyEvent, QMouseEvent, QPainter, QResizeEvent
from PySide6.QtWidgets import (
    QHBoxLayout,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.icons import Icon, paint_icon
from app.theme.theme import CHIP_RADIUS
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.field import Field
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.painted_button import PaintedButton
from app.widgets.painted_text import PaintedText, height_for
from app.widgets.reading_area import scrolled
from app.widgets.text import MEDIUM, Text
from app.wizard.walking.badge import Badge
from app.wording.numbers import clock
from app.wording.translation import tr, tr_n

ROW, BETWEEN = 56, 4
LEAST_WIDTH = 180
LEAST_ROWS = 1.5  # in sight: half a row shows that there are more


class WalkState(StrEnum):
    RECORDING = "recording"
    ASKING = "asking"  # stopped, neither kept nor discarded
    KEPT = "kept"
    DISCARDED = "discarded"
    IN_SENSORS = "in_sensors"  # to be fetched from their memories
    RECOVERED = "recovered"  # the program was closed while it was recorded


@dataclass(frozen=True, slots=True)
class WalkRow:
    """One walk as it is called everywhere: `letter` is its condition's, with the walk's number from the second on.

    `strides` is None while nobody has counted them. `is_of_old_straps`: sensors were strapped again since.
    `video_s`: how long its video is; 0 where it has none.
    """

    id: str
    letter: str
    label: str
    state: WalkState
    strides: int | None = None
    is_of_old_straps: bool = False
    video_s: float = 0.0

    @property
    def note(self) -> str:
        """What is so, in the second line."""
        strides = ""
        if self.strides is not None:
            strides = tr_n("{count} stride", "{count} strides", self.strides).format(count=self.strides)
        stated = {
            WalkState.RECORDING: tr("recording"),
            WalkState.ASKING: tr("include or exclude?"),
            WalkState.KEPT: strides,
            WalkState.DISCARDED: tr("excluded"),
            WalkState.IN_SENSORS: tr("stored on the sensors"),
            WalkState.RECOVERED: tr("recovered, needs review"),
        }[self.state]
        video = tr("video {length}").format(length=clock(self.video_s)) if self.video_s else ""
        return " · ".join(filter(None, [stated, video]))


class WalkList(Card):
    """The newest walk is in sight. Below the list: what to press when the sensors came off."""

    accessible_role = QAccessible.Role.List

    undo_pressed = Signal(str)  # takes back that a walk was discarded
    renamed = Signal(str, str)  # a walk that was kept, and the condition that somebody typed

    def __init__(self) -> None:
        super().__init__(spacing=4)
        self._rows: list[_ListedWalk] = []
        self._is_compact = False
        self._title = Text(tr("Walks"), size=14, weight=MEDIUM, tone="ink2")
        self._none = Text(tr("No walks yet."), size=14, tone="ink2", wraps=True)
        self._inside = QWidget()
        self._scroll = scrolled(self._inside)
        self.restrapped = ActionRow(
            Icon.REPEAT,
            tr("Sensors were reattached"),
            tr("Standing still and free motion must then be repeated."),
        )
        self._list = lay_out(QVBoxLayout(self._inside), 1, margins=0, spacing=BETWEEN)
        self.setAccessibleName(tr("Walks"))
        lay_out(self.column, self._title, self._none, (self._scroll, 1), self.restrapped)
        on_theme(self._fit)

    @property
    def buttons(self) -> list[QWidget]:
        """Of the rows, from above to below."""
        every = [control for row in self._rows for control in (row.edit, row.field, row.undo)]
        return [control for control in every if not control.isHidden()]

    def show_walks(self, rows: tuple[WalkRow, ...]) -> None:
        """Show these, in the order of recording; a row that stays keeps the focus."""
        is_longer = len(rows) > len(self._rows)
        while len(self._rows) > len(rows):
            self._rows.pop().deleteLater()
        while len(self._rows) < len(rows):
            added = _ListedWalk(self)
            self._list.insertWidget(len(self._rows), added)
            self._rows.append(added)
        for widget, row in zip(self._rows, rows, strict=True):
            widget.show_walk(row)
        self._none.setVisible(not rows)
        self._scroll.setVisible(bool(rows))
        self._fit()
        if is_longer:
            self._inside.adjustSize()
            bar = self._scroll.verticalScrollBar()
            bar.setValue(bar.maximum())

    def set_compact(self, is_compact: bool) -> None:
        """Show all rows, and leave it to the page to scroll."""
        self._is_compact = is_compact
        self._fit()

    def set_restrap_offered(self, is_offered: bool) -> None:
        self.restrapped.setVisible(is_offered)

    def _fit(self) -> None:
        rows = len(self._rows) if self._is_compact else min(LEAST_ROWS, len(self._rows))
        self._scroll.setMinimumHeight(px((ROW + BETWEEN) * rows))
        bar = 0 if self._is_compact else self._scroll.verticalScrollBar().sizeHint().width()
        self._scroll.setMinimumWidth(max(px(LEAST_WIDTH), self._inside.minimumSizeHint().width() + bar))


MARKS = {
    WalkState.KEPT: Icon.CHECK,
    WalkState.RECORDING: Icon.RECORDING,
    WalkState.RECOVERED: Icon.WARNING,
    WalkState.ASKING: Icon.UNCHECKED,
}
FRAMED = Ground("", "control", 1.25, CHIP_RADIUS)
FILLED = Ground("ink", "ink", 1.25, CHIP_RADIUS)  # of the walk that goes on


class _ListedWalk(QWidget):
    accessible_role = QAccessible.Role.ListItem

    def __init__(self, owner: WalkList) -> None:
        super().__init__()
        self._owner = owner
        self._walk = WalkRow("", "", "", WalkState.KEPT)
        self._is_edited = False
        self._bar, self._badge = QWidget(), Badge()
        self._label = Text(size=15, weight=MEDIUM, wraps=True)
        self._note = Text(size=12, tone="ink2", wraps=True)
        self._mark = IconMark(Icon.CHECK, size=20)
        self.undo = Button(tr("Undo"), ButtonKind.QUIET, height=44)
        self.edit = Button("", ButtonKind.QUIET, Icon.EDIT, height=44)
        self.field = Field(tr("Condition of this walk"), has_label=False)
        words = lay_out(QVBoxLayout(), 1, self.field, self._label, self._note, 1, spacing=0)
        bar = lay_out(QHBoxLayout(), self._bar, self._badge, spacing=7)
        named = lay_out(QHBoxLayout(), bar, (words, 1), spacing=10)
        lay_out(QHBoxLayout(self), (named, 1), self._mark, self.edit, self.undo, margins=(0, 4, 8, 4), spacing=4)
        scaled(self._bar.setFixedWidth, 3)
        scaled(self.setMinimumHeight, ROW)
        self.undo.clicked.connect(self._on_undo_clicked)
        self.edit.clicked.connect(self._on_edit_clicked)
        self.field.committed.connect(self._on_committed)
        self.field.line_edit.editingFinished.connect(self._on_left)
        self.field.line_edit.installEventFilter(self)

    def show_walk(self, walk: WalkRow) -> None:
        is_same = (walk.id, walk.label, walk.state) == (self._walk.id, self._walk.label, self._walk.state)
        self._is_edited &= is_same  # strides that are counted meanwhile take nobody's words away
        self._walk = walk
        called = f"{walk.letter} {walk.label}".lstrip()  # apart from others of its condition
        self._label.setText(walk.label)
        self._note.setText(walk.note)
        self.edit.setAccessibleName(tr("Rename {label}").format(label=called))
        had_focus = self.undo.hasFocus()
        self.undo.setAccessibleName(tr("Include {label} again").format(label=called))
        if had_focus and walk.state is not WalkState.DISCARDED:
            self._owner.setFocus()
        if (mark := MARKS.get(walk.state)) is not None:
            self._mark.set_icon(mark)
        self._show_parts()
        self._label.set_tone("ink2" if walk.state is WalkState.DISCARDED else "ink")
        state = tr("included") if walk.state is WalkState.KEPT else ""
        self.setAccessibleName(", ".join(filter(None, [walk.letter, walk.label, walk.note, state])))
        is_now = walk.state is WalkState.RECORDING
        set_ground(self, Ground("sunken", inset=0) if is_now else None)
        set_ground(self._bar, Ground("ink", radius=1, inset=0) if is_now else None)
        self._badge.show_letter(walk.letter, "inv_ink" if is_now else "ink", FILLED if is_now else FRAMED)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_F2 and self._can_be_renamed:
            self._on_edit_clicked()
        else:
            super().keyPressEvent(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        if event.button() is Qt.MouseButton.LeftButton and self._can_be_renamed:
            self._on_edit_clicked()
        else:
            super().mouseDoubleClickEvent(event)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Let Esc take back what was typed; the window has this key otherwise, and leaving would keep the words."""
        if watched is self.field.line_edit and isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Escape:
            if event.type() is QEvent.Type.ShortcutOverride:
                event.accept()
                return True
            if event.type() is QEvent.Type.KeyPress:
                self.field.set_text(self._walk.label)
                self._on_left()
                return True
        return super().eventFilter(watched, event)

    @property
    def _can_be_renamed(self) -> bool:
        return self._walk.state is WalkState.KEPT and not self._is_edited

    def _on_undo_clicked(self) -> None:
        self._owner.undo_pressed.emit(self._walk.id)

    def _on_edit_clicked(self) -> None:
        self._is_edited = True
        self.field.set_text(self._walk.label)
        self._show_parts()
        self.field.line_edit.setFocus()
        self.field.line_edit.selectAll()

    def _on_committed(self) -> None:
        label = self.field.text.strip()
        if label and label != self._walk.label:
            self._owner.renamed.emit(self._walk.id, label)

    def _on_left(self) -> None:
        """Show the walk again instead of the field, the focus on what opened it."""
        if self._is_edited:
            had_focus = self.field.line_edit.hasFocus()
            self._is_edited = False
            self._show_parts()
            if had_focus:
                self.edit.setFocus()

    def _show_parts(self) -> None:
        walk, is_edited = self._walk, self._is_edited
        self.field.setVisible(is_edited)
        self._label.setVisible(not is_edited)
        self._note.setVisible(bool(walk.note) and not is_edited)
        self._mark.setVisible(walk.state in MARKS and not is_edited)
        self.edit.setVisible(self._can_be_renamed)
        self.undo.setVisible(walk.state is WalkState.DISCARDED)


class ActionRow(PaintedButton):
    """A row that does something: an icon, what was the case, and below what follows. Both wrap."""

    def __init__(self, icon: Icon, text: str, note: str) -> None:
        super().__init__()
        self._icon, self._note = icon, note
        self.setText(text)
        self.setAccessibleName(text)
        self.setAccessibleDescription(note)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        scaled(self.setMinimumWidth, LEAST_WIDTH)
        on_theme(self._fit)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def painted_texts(self) -> list[PaintedText]:
        """Give what is painted now, each in its box."""
        theme = current_theme()
        left, width = px(10 + 20 + 10), self._words_width
        text, note = theme.font(14, MEDIUM), theme.font(12)
        high, low = height_for(self.text(), text, width), height_for(self._note, note, width)
        top = (self.height() - high - low) / 2
        return [
            PaintedText(self.text(), QRectF(left, top, width, high), text, "ink", wraps=True),
            PaintedText(self._note, QRectF(left, top + high, width, low), note, "ink2", wraps=True),
        ]

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c = theme.colours
        box = QRectF(self.rect()).adjusted(1, 1, -1, -1)
        theme.paint_box(painter, box, c.surface, c.control)
        self.paint_veil(painter, box)
        mark = QRectF(px(10), (self.height() - px(20)) / 2, px(20), px(20))
        paint_icon(painter, self._icon, mark, c.ink)

    @property
    def _words_width(self) -> int:
        return max(self.width() - px(10 + 20 + 10) - px(8), 1)

    def _fit(self) -> None:
        theme = current_theme()
        width = self._words_width
        high = height_for(self.text(), theme.font(14, MEDIUM), width)
        low = height_for(self._note, theme.font(12), width)
        self.setFixedHeight(max(theme.px(44), high + low + theme.px(16)))
        self.update()
