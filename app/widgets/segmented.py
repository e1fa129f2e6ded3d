"""One choice out of a few, all of them in sight. Arrows move, and each says in a second line what it does."""

from collections.abc import Sequence

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QButtonGroup, QHBoxLayout, QSizePolicy, QWidget

from app.theme import CONTROL_RADIUS, Look
from app.widgets.text import MEDIUM, SEMIBOLD

HEIGHT = 52
PLAIN_HEIGHT = 48  # without second lines, as high as a field
PADDING = 14


class Segmented(QWidget):
    """`options` are key, word and second line of each choice; the first is chosen to begin with."""

    chosen = Signal(str)

    def __init__(self, look: Look, name: str, options: Sequence[tuple[str, str, str]]) -> None:
        super().__init__()
        self._look = look
        self.setAccessibleName(name)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        self._group = QButtonGroup(self)
        height = HEIGHT if any(note for _, _, note in options) else PLAIN_HEIGHT
        self._segments = {key: _Segment(look, word, note, height, self) for key, word, note in options}
        row = QHBoxLayout(self)
        row.setContentsMargins(2, 2, 2, 2)
        row.setSpacing(0)
        for segment in self._segments.values():
            self._group.addButton(segment)
            row.addWidget(segment, 1)
        next(iter(self._segments.values())).setChecked(True)
        self._group.buttonToggled.connect(self._on_button_toggled)
        look.changed.connect(self.update)

    @property
    def segments(self) -> list[QAbstractButton]:
        """The choices in the order of reading."""
        return list(self._segments.values())

    @property
    def choice(self) -> str:
        return next(key for key, segment in self._segments.items() if segment.isChecked())

    def focus(self) -> None:
        """Give the focus to the choice in force."""
        self._segments[self.choice].setFocus()

    def choose(self, key: str) -> None:
        self._segments[key].setChecked(True)

    def set_reason(self, key: str, reason: str) -> None:
        """Switch a choice off and say why in its second line; an empty reason switches it on again."""
        self._segments[key].set_reason(reason)
        self._leave(key, bool(reason))

    def set_offered(self, key: str, is_offered: bool) -> None:
        """Take a choice away where it means nothing, or bring it back."""
        self._segments[key].setVisible(is_offered)
        self._leave(key, not is_offered)

    def set_word(self, key: str, word: str) -> None:
        self._segments[key].set_word(word)

    def set_brief(self, is_brief: bool) -> None:
        """Leave the second lines to readers of screens, where there is no room for them; reasons are still shown."""
        for segment in self._segments.values():
            segment.set_brief(is_brief)

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(theme.pen(theme.colours.line, 1))
        painter.setBrush(QColor(theme.colours.sunken))
        radius = CONTROL_RADIUS * theme.scale
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), radius, radius)

    def _leave(self, key: str, must_leave: bool) -> None:
        """Go to the first choice that can be chosen, if `key` was chosen and no longer can be."""
        if must_leave and self.choice == key:
            open_to = (one for one in self._segments.values() if one.isEnabled() and not one.isHidden())
            next(open_to).setChecked(True)

    def _on_button_toggled(self, button: QAbstractButton, is_checked: bool) -> None:
        if is_checked:
            self.chosen.emit(next(key for key, segment in self._segments.items() if segment is button))


class _Segment(QAbstractButton):
    def __init__(self, look: Look, word: str, note: str, height: float, parent: QWidget) -> None:
        super().__init__(parent)
        self._look, self._note, self._height, self._reason = look, note, height, ""
        self._is_brief = False
        self.setText(word)
        self.setCheckable(True)
        self.setAutoExclusive(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self._name()
        look.changed.connect(self._on_look_changed)

    def set_word(self, word: str) -> None:
        self.setText(word)
        self._name()
        self._on_look_changed()

    def set_brief(self, is_brief: bool) -> None:
        if is_brief != self._is_brief:
            self._is_brief = is_brief
            self._on_look_changed()

    def set_reason(self, reason: str) -> None:
        self._reason = reason
        self.setEnabled(not reason)
        self._name()
        self._on_look_changed()

    def sizeHint(self) -> QSize:
        theme = self._look.theme
        word = QFontMetrics(theme.font(14, SEMIBOLD)).horizontalAdvance(self.text())
        note = QFontMetrics(theme.font(12)).horizontalAdvance(self._second_line())
        return QSize(max(word, note) + 2 * theme.px(PADDING), theme.px(self._height) - 4)

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        c = theme.colours
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        radius = (CONTROL_RADIUS - 1) * theme.scale
        box = QRectF(self.rect()).adjusted(1, 1, -1, -1)
        if self.isChecked():
            painter.setPen(theme.pen(c.ink, 1.75))
            painter.setBrush(QColor(c.surface))
            painter.drawRoundedRect(box, radius, radius)
        elif self.isEnabled() and (self.underMouse() or self.isDown()):
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(theme.veil(self.isDown()))
            painter.drawRoundedRect(box, radius, radius)
        ink = c.disabled if not self.isEnabled() else c.ink if self.isChecked() else c.ink2
        note_ink = c.ink2  # also when switched off: the reason is to be read
        height, note_height = theme.px(20), theme.px(16) if self._second_line() else 0
        top = (self.height() - height - note_height) // 2
        painter.setPen(QColor(ink))
        painter.setFont(theme.font(14, SEMIBOLD if self.isChecked() else MEDIUM))
        painter.drawText(0, top, self.width(), height, Qt.AlignmentFlag.AlignCenter, self.text())
        painter.setPen(QColor(note_ink))
        painter.setFont(theme.font(12))
        painter.drawText(0, top + height, self.width(), note_height, Qt.AlignmentFlag.AlignCenter, self._second_line())

    def _second_line(self) -> str:
        return self._reason or ("" if self._is_brief else self._note)

    def _name(self) -> None:
        self.setAccessibleName(", ".join(filter(None, [self.text(), self._reason or self._note])))

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.update()
