"""The style: how buttons, fields, boxes of choices, menus and bars are painted from the tokens of the theme."""

from dataclasses import dataclass
from enum import Enum, auto
from time import monotonic

from PySide6.QtCore import QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter, QPalette, QPixmap
from PySide6.QtWidgets import (
    QApplication,
    QFrame,
    QHeaderView,
    QLabel,
    QPlainTextEdit,
    QProxyStyle,
    QScrollArea,
    QStyle,
    QStyleOption,
    QStyleOptionButton,
    QStyleOptionComboBox,
    QStyleOptionComplex,
    QStyleOptionFrame,
    QStyleOptionMenuItem,
    QStyleOptionProgressBar,
    QStyleOptionSlider,
    QTableView,
    QWidget,
)

from app.theme.ground import GROUND, Ground
from app.theme.icons import Icon, paint_icon
from app.theme.motion import duration_ms
from app.theme.theme import CONTROL_RADIUS, Theme

Control = QStyle.ControlElement
Primitive = QStyle.PrimitiveElement
State = QStyle.StateFlag

IS_WRONG = "is_wrong"  # property of a field: what was typed does not fit
LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
CENTRE = Qt.AlignmentFlag.AlignCenter
MEDIUM, SEMIBOLD = QFont.Weight.Medium, QFont.Weight.DemiBold
FRAME = 1  # px between a control's edge and its outline, so that half of the line has its room
CAP = 22
TIP_PADDING = 6
MENU_ROW, MENU_PADDING, MENU_ICON = 44, 16, 20
CHOICE_HEIGHT, CHOICE_PADDING, CHOICE_ICON = 52, 16, 22
SCROLL_BAR, SCROLL_MARGIN, LEAST_HANDLE = 12, 3, 32
BUSY_S = 1.5  # from one end of a bar to the other, where it is not known how long something takes


class ButtonKind(Enum):
    """What a button is for."""

    PRIMARY = auto()  # what most want next
    SECONDARY = auto()  # another way
    QUIET = auto()  # beside the matter
    TOGGLE = auto()  # on or off
    SEGMENT = auto()  # one of a few, side by side
    CHIP = auto()  # any of a few
    LABEL = auto()  # one of the names for the next walk


@dataclass(frozen=True, slots=True)
class ButtonFace:
    """What a button shows beside its word: icon, key cap or second line. `is_inverse`: it lies on an inverse ground."""

    kind: ButtonKind
    height: float
    icon: Icon | None = None
    key: str = ""
    note: str = ""
    is_inverse: bool = False


@dataclass(frozen=True, slots=True)
class _Measures:
    padding: float
    text: float
    icon: float
    gap: float


_PLAIN = _Measures(padding=20, text=16, icon=22, gap=8)
_MEASURES = {
    ButtonKind.QUIET: _Measures(padding=10, text=16, icon=22, gap=8),
    ButtonKind.SEGMENT: _Measures(padding=14, text=14, icon=0, gap=0),
    ButtonKind.CHIP: _Measures(padding=12, text=14, icon=16, gap=4),
    ButtonKind.LABEL: _Measures(padding=14, text=14, icon=0, gap=8),
}


class ControlStyle(QProxyStyle):
    """Fusion with our own painting. What it does not know, Fusion paints in the theme's palette.

    Qt calls what is overridden here for every part of every control, so each falls through to Fusion early;
    metrics and hints, which Qt asks for a thousand times a page, are left alone.
    """

    def __init__(self, theme: Theme) -> None:
        super().__init__("fusion")
        self.theme = theme

    def polish(self, what: QWidget | QApplication | QPalette) -> QPalette | None:  # type: ignore[override]  # three in one
        """Let the page be seen through what scrolls."""
        if isinstance(what, QScrollArea | QTableView | QHeaderView | QPlainTextEdit):
            what.viewport().setAutoFillBackground(False)
        if isinstance(what, QScrollArea | QTableView):
            what.setFrameShape(QFrame.Shape.NoFrame)
        if isinstance(what, QScrollArea) and (content := what.widget()) is not None:
            content.setAutoFillBackground(False)
        if isinstance(what, QPlainTextEdit):
            what.document().setDocumentMargin(self.theme.px(12))
        if isinstance(what, QLabel) and what.windowType() is Qt.WindowType.ToolTip:
            what.setContentsMargins(*[self.theme.px(TIP_PADDING)] * 4)
        return super().polish(what)

    def drawControl(
        self, element: Control, option: QStyleOption, painter: QPainter, widget: QWidget | None = None
    ) -> None:
        if element is Control.CE_PushButton and isinstance(face := getattr(widget, "face", None), ButtonFace):
            self._paint_button(face, option, painter)
        elif element is Control.CE_ComboBoxLabel:
            self._paint_choice_label(option, painter)
        elif element is Control.CE_MenuItem:
            self._paint_menu_item(option, painter)
        elif element is Control.CE_ProgressBarGroove:
            self.theme.paint_box(painter, QRectF(option.rect), self.theme.colours.track, radius=4)
        elif element is Control.CE_ProgressBarContents:
            self._paint_progress(option, painter, widget)
        elif element not in (Control.CE_HeaderEmptyArea, Control.CE_MenuEmptyArea):
            super().drawControl(element, option, painter, widget)

    def drawPrimitive(
        self, element: Primitive, option: QStyleOption, painter: QPainter, widget: QWidget | None = None
    ) -> None:
        c = self.theme.colours
        if element is Primitive.PE_Widget and widget is not None and isinstance(widget.property(GROUND), Ground):
            self._paint_ground(widget.property(GROUND), option.rect, painter)
        elif element is Primitive.PE_PanelLineEdit:
            self._paint_field(option, painter, widget)
        elif element is Primitive.PE_Frame and isinstance(widget, QPlainTextEdit):
            self.theme.paint_box(painter, _framed(option), c.surface, c.control)
        elif element is Primitive.PE_PanelMenu:
            painter.fillRect(option.rect, QColor(c.control))
            painter.fillRect(option.rect.adjusted(1, 1, -1, -1), QColor(c.surface))
        elif element is Primitive.PE_PanelTipLabel:
            painter.fillRect(option.rect, QColor(c.inv))
        elif element is Primitive.PE_PanelItemViewRow and isinstance(widget, QTableView):
            return  # tables paint the ground of their rows, which Fusion would fill with the highlight
        elif element not in (Primitive.PE_FrameMenu, Primitive.PE_PanelScrollAreaCorner):
            super().drawPrimitive(element, option, painter, widget)

    def drawComplexControl(
        self,
        control: QStyle.ComplexControl,
        option: QStyleOptionComplex,
        painter: QPainter,
        widget: QWidget | None = None,
    ) -> None:
        theme, c = self.theme, self.theme.colours
        if control is QStyle.ComplexControl.CC_ComboBox:
            theme.paint_box(painter, _framed(option), c.surface, c.control)
            side, right = theme.px(CHOICE_ICON), option.rect.right() + 1 - theme.px(CHOICE_PADDING)
            arrow = QRectF(right - side, (option.rect.height() - side) / 2, side, side)
            paint_icon(painter, Icon.CHEVRON, arrow, c.ink)
        elif control is QStyle.ComplexControl.CC_ScrollBar:
            handle = self.subControlRect(control, option, QStyle.SubControl.SC_ScrollBarSlider, widget)
            margin = theme.px(SCROLL_MARGIN)
            theme.paint_box(painter, QRectF(handle).adjusted(margin, margin, -margin, -margin), c.control, radius=3)
        else:
            super().drawComplexControl(control, option, painter, widget)

    def subControlRect(
        self,
        control: QStyle.ComplexControl,
        option: QStyleOptionComplex,
        part: QStyle.SubControl,
        widget: QWidget | None = None,
    ) -> QRect:
        if control is QStyle.ComplexControl.CC_ScrollBar and isinstance(option, QStyleOptionSlider):
            return self._scroll_bar_part(option, part)
        return super().subControlRect(control, option, part, widget)  # type: ignore[arg-type]  # the stubs forget None

    def sizeFromContents(
        self, kind: QStyle.ContentsType, option: QStyleOption, size: QSize, widget: QWidget | None = None
    ) -> QSize:
        px = self.theme.px
        if kind is QStyle.ContentsType.CT_PushButton and isinstance(face := getattr(widget, "face", None), ButtonFace):
            return self._button_size(face, option)
        if kind is QStyle.ContentsType.CT_ComboBox:
            return QSize(size.width() + px(2 * CHOICE_PADDING + 8 + CHOICE_ICON), px(CHOICE_HEIGHT))
        if kind is QStyle.ContentsType.CT_MenuItem and isinstance(option, QStyleOptionMenuItem):
            return self._menu_item_size(option)
        if kind is QStyle.ContentsType.CT_ScrollBar:
            is_upright = not option.state & State.State_Horizontal
            return QSize(px(SCROLL_BAR), size.height()) if is_upright else QSize(size.width(), px(SCROLL_BAR))
        return super().sizeFromContents(kind, option, size, widget)  # type: ignore[arg-type]  # the stubs forget None

    # buttons

    def _button_icon(self, face: ButtonFace, option: QStyleOption) -> Icon | None:
        is_on = bool(option.state & State.State_On)
        if face.kind is ButtonKind.TOGGLE:
            return face.icon or (Icon.CHECK if is_on else Icon.UNCHECKED)
        return Icon.CHECK if face.kind is ButtonKind.CHIP and is_on else face.icon

    def _button_widths(self, face: ButtonFace, option: QStyleOption) -> tuple[int, int, int]:
        """Give the widths of icon, word and key cap; a word is as wide as it is when chosen."""
        assert isinstance(option, QStyleOptionButton)
        theme, measures = self.theme, _MEASURES.get(face.kind, _PLAIN)
        icon = theme.px(measures.icon) if self._button_icon(face, option) is not None else 0
        word = QFontMetrics(theme.font(measures.text, SEMIBOLD)).horizontalAdvance(option.text)
        key = QFontMetrics(theme.font(12, MEDIUM)).horizontalAdvance(face.key) + theme.px(16) if face.key else 0
        return icon, word, key

    def _button_size(self, face: ButtonFace, option: QStyleOption) -> QSize:
        theme, measures = self.theme, _MEASURES.get(face.kind, _PLAIN)
        widths = [width for width in self._button_widths(face, option) if width]
        width = sum(widths) + theme.px(measures.gap) * (len(widths) - 1)
        height = theme.px(face.height)
        if face.kind is ButtonKind.SEGMENT:
            width = max(width, QFontMetrics(theme.font(12)).horizontalAdvance(face.note))
            height -= 4  # what the frame round all segments takes
        return QSize(width + 2 * theme.px(measures.padding), height)

    def _paint_button(self, face: ButtonFace, option: QStyleOption, painter: QPainter) -> None:
        assert isinstance(option, QStyleOptionButton)
        theme, measures, rect = self.theme, _MEASURES.get(face.kind, _PLAIN), option.rect
        ink = self._paint_button_frame(face, option, painter)
        if face.kind is ButtonKind.SEGMENT:
            self._paint_two_lines(face, option, painter, ink)
            return
        icon, word, key = self._button_widths(face, option)
        gap = theme.px(measures.gap)
        widths = [width for width in (icon, word, key) if width]
        x = (rect.width() - sum(widths) - gap * (len(widths) - 1)) // 2
        if (picture := self._button_icon(face, option)) is not None:
            paint_icon(painter, picture, QRectF(x, (rect.height() - icon) / 2, icon, icon), ink)
            x += icon + gap
        if option.text:
            is_chip = face.kind in (ButtonKind.CHIP, ButtonKind.LABEL)
            is_light = is_chip and not option.state & State.State_On
            painter.setPen(ink)
            painter.setFont(theme.font(measures.text, MEDIUM if is_light else SEMIBOLD))
            painter.drawText(x, 0, word, rect.height(), LEFT if is_chip else CENTRE, option.text)
            x += word + gap
        if face.key:
            cap = QRectF(x + 0.5, (rect.height() - theme.px(CAP)) / 2, key - 1, theme.px(CAP))
            is_filled = face.kind is ButtonKind.PRIMARY
            theme.paint_cap(painter, cap, face.key, ink, ink if is_filled else theme.colours.control)

    def _paint_button_frame(self, face: ButtonFace, option: QStyleOption, painter: QPainter) -> QColor:
        """Paint what lies under icon and word, and give the ink for them."""
        theme, c, box = self.theme, self.theme.colours, _framed(option)
        is_enabled, is_on = bool(option.state & State.State_Enabled), bool(option.state & State.State_On)
        ink = QColor(c.ink if is_enabled else c.disabled)
        radius, veil_ink = CONTROL_RADIUS, None
        if face.is_inverse:
            if is_enabled:
                ink = QColor(c.inv if face.kind is ButtonKind.PRIMARY else c.inv_ink)
            fill = c.inv_ink if face.kind is ButtonKind.PRIMARY else None
            theme.paint_box(painter, box, fill, c.inv_ink2 if face.kind is ButtonKind.SECONDARY else None)
            veil_ink = ink
        elif face.kind is ButtonKind.PRIMARY:
            theme.paint_box(painter, box, c.inv if is_enabled else c.track)
            if is_enabled:
                ink = veil_ink = QColor(c.inv_ink)
        elif face.kind is ButtonKind.SEGMENT:
            radius = CONTROL_RADIUS - 1  # within the frame round all
            ink = QColor(c.disabled if not is_enabled else c.ink if is_on else c.ink2)
            if is_on:
                theme.paint_box(painter, box, c.surface, c.ink, 1.75, radius)
        elif is_on:
            theme.paint_box(painter, box, c.surface, c.ink, 1.75)
        elif face.kind is not ButtonKind.QUIET:
            theme.paint_box(painter, box, c.surface, c.control)
        is_touched = bool(option.state & (State.State_MouseOver | State.State_Sunken))
        if is_touched and is_enabled and not (face.kind is ButtonKind.SEGMENT and is_on):
            veil = theme.veil(bool(option.state & State.State_Sunken), veil_ink)
            theme.paint_box(painter, box, veil, radius=radius)
        if face.is_inverse and option.state & State.State_HasFocus:
            # the usual ring would be ink on ink
            inset = 3 * theme.scale
            theme.paint_box(painter, box.adjusted(inset, inset, -inset, -inset), None, ink, 2, radius - 1.5)
        return ink

    def _paint_two_lines(self, face: ButtonFace, option: QStyleOptionButton, painter: QPainter, ink: QColor) -> None:
        theme, rect = self.theme, option.rect
        height, note_height = theme.px(20), theme.px(16) if face.note else 0
        top = (rect.height() - height - note_height) // 2
        painter.setPen(ink)
        painter.setFont(theme.font(14, SEMIBOLD if option.state & State.State_On else MEDIUM))
        painter.drawText(0, top, rect.width(), height, CENTRE, option.text)
        painter.setPen(QColor(theme.colours.ink2))  # also when switched off: the reason is to be read
        painter.setFont(theme.font(12))
        painter.drawText(0, top + height, rect.width(), note_height, CENTRE, face.note)

    # grounds, fields, choices, menus, bars

    def _paint_ground(self, ground: Ground, rect: QRect, painter: QPainter) -> None:
        theme, inset = self.theme, ground.inset
        fill, line = (getattr(theme.colours, token) if token else None for token in (ground.fill, ground.line))
        if ground.edge is None:
            box = QRectF(rect).adjusted(inset, inset, -inset, -inset)
            theme.paint_box(painter, box, fill, line, ground.width, ground.radius)
            return
        if fill is not None:
            painter.fillRect(rect, QColor(fill))
        if line is not None:
            painter.setPen(theme.pen(line, ground.width))
            is_above = ground.edge is Qt.Edge.TopEdge
            painter.drawLine(
                *((rect.topLeft(), rect.topRight()) if is_above else (rect.bottomLeft(), rect.bottomRight()))
            )

    def _paint_field(self, option: QStyleOption, painter: QPainter, widget: QWidget | None) -> None:
        if not isinstance(option, QStyleOptionFrame) or option.lineWidth <= 0:
            return  # the line within another control
        theme, c = self.theme, self.theme.colours
        is_wrong = widget is not None and bool(widget.property(IS_WRONG))
        is_enabled = bool(option.state & State.State_Enabled)
        line = c.caution_edge if is_wrong else c.control if is_enabled else c.line
        theme.paint_box(
            painter, _framed(option), c.caution if is_wrong else c.surface, line, 1.75 if is_wrong else 1.25
        )
        if is_enabled and option.state & State.State_MouseOver and not option.state & State.State_HasFocus:
            theme.paint_box(painter, _framed(option), theme.veil(is_pressed=False))

    def _paint_choice_label(self, option: QStyleOption, painter: QPainter) -> None:
        assert isinstance(option, QStyleOptionComboBox)
        theme = self.theme
        words = option.rect.adjusted(theme.px(CHOICE_PADDING), 0, -theme.px(CHOICE_PADDING + CHOICE_ICON), 0)
        painter.setPen(QColor(theme.colours.ink))
        fitting = option.fontMetrics.elidedText(option.currentText, Qt.TextElideMode.ElideRight, words.width())
        painter.drawText(words, LEFT, fitting)

    def _menu_item_size(self, option: QStyleOptionMenuItem) -> QSize:
        px = self.theme.px
        if option.menuItemType is QStyleOptionMenuItem.MenuItemType.Separator:
            return QSize(px(2 * MENU_PADDING), px(9))
        words, _, keys = option.text.partition("\t")
        metrics = QFontMetrics(option.font)
        width = metrics.size(Qt.TextFlag.TextShowMnemonic.value, words).width()
        width += metrics.horizontalAdvance(keys) + px(24) if keys else 0
        return QSize(width + px(3 * MENU_PADDING + MENU_ICON), px(MENU_ROW))

    def _paint_menu_item(self, option: QStyleOption, painter: QPainter) -> None:
        """Paint one line of a menu or of an open box of choices; the one in force has a check at its right."""
        assert isinstance(option, QStyleOptionMenuItem)
        c, px, rect = self.theme.colours, self.theme.px, option.rect
        if option.menuItemType is QStyleOptionMenuItem.MenuItemType.Separator:
            painter.fillRect(rect.left(), rect.center().y(), rect.width(), 1, QColor(c.line))
            return
        is_enabled = bool(option.state & State.State_Enabled)
        is_selected = is_enabled and bool(option.state & State.State_Selected)
        ink = QColor(c.inv_ink if is_selected else c.ink if is_enabled else c.disabled)
        painter.fillRect(rect.adjusted(1, 1, -1, -1), QColor(c.inv if is_selected else c.surface))
        words, _, keys = option.text.partition("\t")
        line = rect.adjusted(px(MENU_PADDING), 0, -px(MENU_PADDING), 0)
        font = QFont(option.font)
        font.setWeight(SEMIBOLD if option.checked else QFont.Weight.Normal)
        painter.setPen(ink)
        painter.setFont(font)
        painter.drawText(line, int(LEFT.value) | Qt.TextFlag.TextShowMnemonic.value, words)
        painter.drawText(line, RIGHT, keys)
        if option.checked:
            side = px(MENU_ICON)
            mark = QRectF(line.right() + 1 - side, rect.center().y() + 0.5 - side / 2, side, side)
            paint_icon(painter, Icon.CHECK, mark, ink)

    def _paint_progress(self, option: QStyleOption, painter: QPainter, widget: QWidget | None) -> None:
        assert isinstance(option, QStyleOptionProgressBar)
        theme, c, box = self.theme, self.theme.colours, QRectF(option.rect)
        span = option.maximum - option.minimum
        if span <= 0:  # how long it takes is not known: half a bar goes to and fro, or rests in the middle
            turn = 0.5
            if duration_ms(round(1000 * BUSY_S), theme):
                self._ask_for_next_frame(option, widget)
                theme.paint_box(painter, box, c.track, radius=4)
                turn = monotonic() / BUSY_S % 2
            box.setWidth(box.width() / 2)
            box.translate(box.width() * min(turn, 2 - turn), 0)
        else:
            box.setWidth(box.width() * (option.progress - option.minimum) / span)
        if box.width() > 0:
            theme.paint_box(painter, box, c.ink, radius=4)

    def _ask_for_next_frame(self, option: QStyleOption, widget: QWidget | None) -> None:
        """Let Fusion move the bar on; what it paints for that is out of sight, else it would show at round corners."""
        unseen = QPixmap(1, 1)
        painter = QPainter(unseen)
        super().drawControl(Control.CE_ProgressBarContents, option, painter, widget)
        painter.end()

    def _scroll_bar_part(self, option: QStyleOptionSlider, part: QStyle.SubControl) -> QRect:
        """Give where handle, groove and what lies before and after the handle are; there are no arrows."""
        rect, is_upright = option.rect, option.orientation is Qt.Orientation.Vertical
        length = rect.height() if is_upright else rect.width()
        span = option.maximum - option.minimum
        handle = length
        if span > 0:
            share = option.pageStep / (span + option.pageStep)
            handle = min(max(round(length * share), self.theme.px(LEAST_HANDLE)), length)
        start = QStyle.sliderPositionFromValue(
            option.minimum, option.maximum, option.sliderPosition, length - handle, option.upsideDown
        )
        begin, size = {
            QStyle.SubControl.SC_ScrollBarGroove: (0, length),
            QStyle.SubControl.SC_ScrollBarSlider: (start, handle),
            QStyle.SubControl.SC_ScrollBarSubPage: (0, start),
            QStyle.SubControl.SC_ScrollBarAddPage: (start + handle, length - start - handle),
        }.get(part, (0, 0))
        if is_upright:
            return QRect(rect.left(), rect.top() + begin, rect.width(), size)
        return QRect(rect.left() + begin, rect.top(), size, rect.height())


def _framed(option: QStyleOption) -> QRectF:
    return QRectF(option.rect).adjusted(FRAME, FRAME, -FRAME, -FRAME)
