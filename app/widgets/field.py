"""One line to type into: its label above, its unit and its leg inside, and what is wrong with it below."""

import math
import unicodedata

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QAccessible,
    QAccessibleAnnouncementEvent,
    QColor,
    QFont,
    QFontMetrics,
    QHideEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QWheelEvent,
)
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import current_theme, on_theme, px
from app.theme.icons import Icon
from app.theme.leg_chip import paint_chip
from app.theme.style import IS_WRONG
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD, Text
from app.wording.numbers import MINUS
from app.wording.translation import short_figure, tr, within_sentence
from core.body import Side

HEIGHT = 48
PADDING = 14
CHIP_PADDING = 10
CHIP = 24
KEPT_CLEAR = 3  # px: Qt's own, on either side of the text
TEXT, SIDE_TEXT = 16, 20  # a side's fields hold one figure each, read beside the patient


class Field(QWidget):
    """Keeps what was typed, right or wrong.

    Parameters
    ----------
    has_label
        Without, only screen readers have the label: for fields in a row under one heading.
    is_secret
        Shows dots.
    is_code
        Distinguishes 0 from O.
    most
        Characters, so that what is typed has its room where it is shown.
    states_wrong
        Without, what is wrong is stated by whoever has more room than a narrow field: see `wrong`.
    """

    edited = Signal(str)  # by the user
    committed = Signal()  # by Enter, or by leaving after a change

    def __init__(
        self,
        label: str,
        *,
        unit: str = "",
        is_optional: bool = False,
        side: Side | None = None,
        is_secret: bool = False,
        is_code: bool = False,
        placeholder: str = "",
        has_label: bool = True,
        most: int | None = None,
        states_wrong: bool = True,
    ) -> None:
        super().__init__()
        self._label, self._side, self._is_optional = label, side, is_optional
        self._states_wrong = states_wrong
        self._most, self._is_secret, self._is_too_long = most, is_secret, False
        self._is_pending = False  # edited, not yet committed
        self._caption = Text(label, size=14, weight=MEDIUM)
        self._optional = Text(tr("optional"), size=12, tone="ink2")
        self._box = _Box(side, is_code)
        self._wrong_mark = IconMark(Icon.WARNING)
        self._wrong = Text(size=14, wraps=True)
        self._caption.setBuddy(self._box)
        self._box.setPlaceholderText(placeholder)
        if is_secret:
            self._box.setEchoMode(QLineEdit.EchoMode.Password)
        self.setFocusProxy(self._box)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Maximum)
        above = lay_out(QHBoxLayout(), (self._caption, 1), (self._optional, 0, Qt.AlignmentFlag.AlignBottom), spacing=8)
        below = lay_out(QHBoxLayout(), (self._wrong_mark, 0, Qt.AlignmentFlag.AlignTop), (self._wrong, 1), spacing=8)
        lay_out(QVBoxLayout(self), above, self._box, below, margins=0, spacing=6)
        self._caption.setVisible(has_label)  # not before it has a parent: alone it would be a window
        self._optional.setVisible(has_label and is_optional)
        self._make_room("")
        self._box.textEdited.connect(self._on_text_edited)
        self._box.inputRejected.connect(self._on_input_rejected)
        self._box.editingFinished.connect(self._on_editing_finished)
        self.set_unit(unit)
        self.set_wrong("")

    @property
    def line_edit(self) -> QLineEdit:
        """What has the focus, for the order of tabs."""
        return self._box

    @property
    def text(self) -> str:
        return self._box.text()

    @property
    def is_wrong(self) -> bool:
        return bool(self.wrong)

    @property
    def wrong(self) -> str:
        """What is wrong and what to do; empty where nothing is."""
        return self._wrong.text()

    def set_text(self, text: str) -> None:
        if text != self._box.text():  # else the cursor would jump
            self._make_room(text)
            self._box.setText(text)

    def set_label(self, label: str) -> None:
        self._label = label
        self._caption.setText(label)
        self._name()

    def set_unit(self, unit: str) -> None:
        self._box.set_unit(unit)
        self._name()

    def set_wrong(self, sentence: str) -> None:
        """Say what is wrong and what to do; an empty sentence takes it back. What was typed stays."""
        is_news = sentence != self._wrong.text()
        self._wrong.setText(sentence)
        self._wrong.setVisible(bool(sentence) and self._states_wrong)
        self._wrong_mark.setVisible(bool(sentence) and self._states_wrong)
        self._box.set_wrong(bool(sentence))
        self._name()
        if sentence and is_news:
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self._box, sentence))

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if self._is_pending:  # the page goes, or the window: nothing is lost
            self._on_editing_finished()

    def _name(self) -> None:
        sides = {Side.LEFT: tr("Left"), Side.RIGHT: tr("Right"), None: ""}
        label = self._label
        if self._side is not None and label:
            label = f"{sides[self._side]} {within_sentence(label)}"
        state = self._wrong.text() or (tr("optional") if self._is_optional else "")
        self._box.setAccessibleName(", ".join(filter(None, [label, self._box.unit, state])))

    def _on_text_edited(self, text: str) -> None:
        self._is_pending = True
        clean = text if self._is_secret else one_line(text)
        if clean != text:
            cursor = len(one_line(text[: self._box.cursorPosition()]))
            self._box.setText(clean)
            self._box.setCursorPosition(cursor)
        if self._is_too_long and len(clean) < self._box.maxLength():
            self._is_too_long = False
            self.set_wrong("")
        self.edited.emit(clean)

    def _make_room(self, text: str) -> None:
        """For what is typed, and for all that was written elsewhere."""
        if self._most is not None:
            self._box.setMaxLength(max(self._most, len(text)))

    def _on_input_rejected(self) -> None:
        self._is_too_long = True
        self.set_wrong(tr("At most {count} characters.").format(count=self._box.maxLength()))

    def _on_editing_finished(self) -> None:
        self._is_pending = False
        self.committed.emit()


def one_line(text: str) -> str:
    """What can be seen of a text: its breaks are spaces, and what only steers how it is shown is gone."""
    kinds = ((letter, unicodedata.category(letter)) for letter in text)
    return "".join(" " if kind in ("Cc", "Zl", "Zp") else letter for letter, kind in kinds if kind != "Cf")


class NumberField(Field):
    """A number between `low` and `high`, with a comma or a point; states itself which numbers fit."""

    def __init__(
        self,
        label: str,
        *,
        low: float,
        high: float,
        decimals: int = 0,
        unit: str = "",
        is_optional: bool = False,
        side: Side | None = None,
        placeholder: str = "",
        has_label: bool = True,
        states_wrong: bool = True,
    ) -> None:
        super().__init__(
            label,
            unit=unit,
            is_optional=is_optional,
            side=side,
            placeholder=placeholder,
            has_label=has_label,
            states_wrong=states_wrong,
        )
        self.low, self.high, self.decimals = low, high, decimals
        self._box.setInputMethodHints(Qt.InputMethodHint.ImhFormattedNumbersOnly)

    @property
    def value(self) -> float | None:
        """The number typed; None where there is none, or none that fits."""
        number = _number(self.text, self.decimals)
        return number if number is not None and self.low <= number <= self.high else None

    def set_value(self, value: float | None) -> None:
        if value is None or value != self.value:  # else "15.0" would turn into "15" under the cursor
            self.set_text("" if value is None else short_figure(value, self.decimals))
        self._judge()

    def _on_text_edited(self, text: str) -> None:
        if self.is_wrong:  # shown when the field was left; taken back as soon as it is right
            self._judge()
        super()._on_text_edited(text)

    def _on_editing_finished(self) -> None:
        self._judge()
        super()._on_editing_finished()

    def _judge(self) -> None:
        if not self.text.strip() or self.value is not None:
            self.set_wrong("")
            return
        required = (
            tr("Enter a number from {low} to {high}.")
            if self.decimals
            else tr("Enter a whole number from {low} to {high}.")
        )
        unit = self._box.unit
        space = "" if unit in ("", "°", "%") else " "
        low, high = (short_figure(limit, self.decimals).replace("-", MINUS) for limit in (self.low, self.high))
        self.set_wrong(required.format(low=low, high=f"{high}{space}{unit}"))


class _Box(QLineEdit):
    """The line itself. It is as large as its frame, so that the ring round the focus goes round the frame."""

    def __init__(self, side: Side | None, is_code: bool) -> None:
        super().__init__()
        self._side, self._is_code = side, is_code
        self.unit = ""
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        if side is not None:
            self.setAlignment(Qt.AlignmentFlag.AlignRight)
        on_theme(self._apply_theme)

    def set_unit(self, unit: str) -> None:
        self.unit = unit
        self._apply_theme()

    def set_wrong(self, is_wrong: bool) -> None:
        if is_wrong != self._is_wrong:
            self.setProperty(IS_WRONG, is_wrong)
            self._apply_theme()

    def sizeHint(self) -> QSize:
        margins = self.textMargins()
        letters = QFontMetrics(self.font()).horizontalAdvance("0000")
        return QSize(letters + margins.left() + margins.right(), px(HEIGHT))

    def minimumSizeHint(self) -> QSize:
        hint = self.sizeHint()
        letters = QFontMetrics(self.font()).horizontalAdvance("00")  # a longer text moves along under its frame
        return QSize(hint.width() - letters, hint.height())

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()  # who scrolls past must not change a number

    def paintEvent(self, event: QPaintEvent) -> None:
        super().paintEvent(event)
        theme = current_theme()
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        if self._side is not None:
            top = (self.height() - px(CHIP)) / 2
            paint_chip(painter, QRectF(px(CHIP_PADDING), top, px(CHIP), px(CHIP)), self._side, theme)
        if self.unit:
            painter.setFont(self._unit_font())
            painter.setPen(QColor(c.caution_ink if self._is_wrong else c.ink2 if self.isEnabled() else c.disabled))
            right = self.rect().adjusted(0, 0, -px(PADDING), 0)
            painter.drawText(right, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, self.unit)

    @property
    def _is_wrong(self) -> bool:
        return bool(self.property(IS_WRONG))

    def _unit_font(self) -> QFont:
        return current_theme().font(14 if self._side is None else SIDE_TEXT - 2)

    def _apply_theme(self) -> None:
        theme = current_theme()
        px = theme.px
        self.setFont(
            theme.font(TEXT if self._side is None else SIDE_TEXT, SEMIBOLD if self._is_code else REGULAR, self._is_code)
        )
        palette = QPalette()
        if self._is_wrong:
            palette.setColor(QPalette.ColorRole.Text, QColor(theme.colours.caution_ink))
        self.setPalette(palette)
        unit_width = QFontMetrics(self._unit_font()).horizontalAdvance(self.unit) + px(6) if self.unit else 0
        left = px(PADDING) if self._side is None else px(CHIP_PADDING + CHIP + 8)
        self.setTextMargins(left - KEPT_CLEAR, 0, px(PADDING) + unit_width - KEPT_CLEAR, 0)
        self.updateGeometry()
        self.update()


def _number(text: str, decimals: int) -> float | None:
    """Give the number a clinician wrote, rounded as it is stored; None where it is none."""
    try:
        number = float(text.strip().replace(",", ".").replace(MINUS, "-"))
    except ValueError:
        return None
    if not math.isfinite(number) or (decimals == 0 and number != round(number)):
        return None
    return round(number, decimals)
