"""One frame of a clip, decoded as large as it is shown, with tags over it: what it is, how sure its time is, values."""

from collections.abc import Sequence
from typing import NamedTuple

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QAccessible,
    QColor,
    QFont,
    QFontMetrics,
    QHideEvent,
    QImage,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QResizeEvent,
    QShowEvent,
)
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import CARD_RADIUS, CHIP_RADIUS
from app.video.decoding import FrameDecoder, Request
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, LEFT, PaintedText
from app.wording.translation import tr
from core.body import Side
from core.video.clip import Clip

LEAST = (200, 112)
TAG, GAP, INSET = 24, 4, 12  # px: height of a tag, between two, from the corner
PADDING = 8
VEIL = 0.78  # of ink, under the words of a tag
DRAGGED_PX = 6.0  # by so much the mouse is drawn from frame to frame


class ValueTag(NamedTuple):
    """A value at the cursor: "knee 50°" beside the chip of its side."""

    side: Side
    words: str


class ClipPlayer(Painted):
    """`dragged` gives by how many frames the picture was drawn along with Shift. `painted`: a new frame is in sight."""

    accessible_role = QAccessible.Role.Graphic

    dragged = Signal(int)
    clicked = Signal()
    painted = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.clip: Clip | None = None
        self.frame: int | None = None  # asked for
        self.shown_frame: int | None = None
        self.picture = QImage()
        self.what = ""
        self.state = ""
        self.is_caution = False
        self.note = ""  # in place of a picture
        self.values: Sequence[ValueTag] = ()
        self._held_x: float | None = None
        self._is_new = False
        self._decoder = FrameDecoder(self)
        self._decoder.decoded.connect(self._on_decoded)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def minimumSizeHint(self) -> QSize:
        return QSize(px(LEAST[0]), px(LEAST[1]))

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def show_clip(self, clip: Clip, what: str, state: str, *, is_caution: bool) -> None:
        """Show frames of this clip from now on; `what` and `state` are its tags."""
        if self.clip is None or self.clip.id != clip.id:
            self.clear()
        self.clip, self.what, self.state, self.is_caution = clip, what, state, is_caution
        self.setAccessibleName(tr("Video: {what}").format(what=what))
        self.describe()
        self.update()

    def show_frame(self, number: int | None) -> None:
        """Show a frame as soon as it is decoded; None: there is none here, which `note` explains."""
        if number == self.frame:
            return
        self.frame = number
        if number is None:
            self.shown_frame, self.picture = None, QImage()
        self._ask()
        self.update()

    def show_values(self, values: Sequence[ValueTag]) -> None:
        self.values = values
        self.update()

    def describe(self) -> None:
        """Give readers of screens what the tags state."""
        values = [f"{tag.side.letter} {tag.words}" for tag in self.values]
        self.setAccessibleDescription(", ".join(filter(None, [self.state, self.note, *values])))

    def clear(self) -> None:
        """Drop the picture, and let nothing that is being decoded come any more."""
        self._decoder.finish()
        self.clip = self.frame = self.shown_frame = None
        self.picture, self.values, self.note = QImage(), (), ""
        self.what = self.state = ""
        self.update()

    def draw(self, painter: QPainter) -> None:
        theme, box = current_theme(), QRectF(self.rect())
        shape = QPainterPath()
        shape.addRoundedRect(box, px(CARD_RADIUS), px(CARD_RADIUS))
        painter.fillPath(shape, QColor(theme.colours.track))
        if not self.picture.isNull():
            painter.save()
            picture = self.picture_box
            if picture.contains(QRectF(self.rect())):  # else its corners lie within the round ones
                painter.setClipPath(shape)
            is_resized = self.picture.size() != picture.size().toSize() * self.devicePixelRatioF()
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, is_resized)
            painter.drawImage(picture, self.picture)
            painter.restore()
        for text, fill in self._tags():
            theme.paint_box(painter, text.box, fill, radius=CHIP_RADIUS)
        for tag, box in zip(self.values, self._value_boxes(), strict=True):
            theme.paint_box(painter, box, theme.colours.surface, theme.colours.line, 1, CHIP_RADIUS)
            inset = (box.height() - px(CHIP)) / 2
            paint_chip(painter, QRectF(box.left() + inset, box.top() + inset, px(CHIP), px(CHIP)), tag.side, theme)
        if self._is_new and self.shown_frame is not None:
            self._is_new = False
            self.painted.emit(self.shown_frame)

    @property
    def picture_box(self) -> QRectF:
        """Where the picture lies, in the middle and whole, on whole pixels: on others it takes many times as long."""
        size = self.picture.size().scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
        left, top = (self.width() - size.width()) // 2, (self.height() - size.height()) // 2
        return QRectF(left, top, size.width(), size.height())

    def painted_texts(self) -> list[PaintedText]:
        found = [text for text, _ in self._tags()]
        for tag, box in zip(self.values, self._value_boxes(), strict=True):
            words = box.adjusted(px(CHIP) + px(PADDING), 0, 0, 0)
            found.append(PaintedText(tag.words, words, _font(), "ink", LEFT))
        if self.note and self.picture.isNull():
            box = QRectF(self.rect()).adjusted(px(INSET), px(2 * TAG), -px(INSET), -px(TAG))
            found.append(PaintedText(self.note, box, current_theme().font(14), "ink2", CENTRE, wraps=True))
        return found

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self.setFocus(Qt.FocusReason.MouseFocusReason)
        if event.button() is Qt.MouseButton.LeftButton:
            if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
                self._held_x = event.position().x()
            else:
                self.clicked.emit()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._held_x is None:
            return
        frames = int((event.position().x() - self._held_x) / px(DRAGGED_PX))
        if frames:
            self._held_x += frames * px(DRAGGED_PX)
            self.dragged.emit(frames)

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:
        self._held_x = None

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._ask()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._ask()

    def hideEvent(self, event: QHideEvent) -> None:
        self._decoder.finish()
        super().hideEvent(event)

    def _ask(self) -> None:
        """Nothing is decoded for a window that nobody sees."""
        if self.clip is not None and self.frame is not None and self.isVisible():
            room = QSize(self.size() * self.devicePixelRatioF())
            self._decoder.ask(Request(self.clip, self.frame, room))

    def _on_decoded(self, request: Request, picture: QImage) -> None:
        if self.clip is None or request.clip.id != self.clip.id or self.frame is None:
            return  # it was cleared, or shows another clip
        self.picture, self.shown_frame, self._is_new = picture, request.number, True
        self.note = tr("This frame cannot be read.") if picture.isNull() else ""
        self.update()

    def _tags(self) -> list[tuple[PaintedText, QColor]]:
        """What it is at the left, how well it is synchronised at the right; under one another where that is narrow."""
        theme, found = current_theme(), list[tuple[PaintedText, QColor]]()
        ink = QColor(theme.colours.inv)
        ink.setAlphaF(VEIL)
        widths = [_width(words) for words in (self.what, self.state)]
        are_beside = sum(widths) + 2 * px(INSET) + px(GAP) <= self.width()
        for number, words in enumerate((self.what, self.state)):
            if not words:
                continue
            is_caution = number == 1 and self.is_caution
            width = min(widths[number], self.width() - 2 * px(INSET))
            left = self.width() - px(INSET) - width if number and are_beside else px(INSET)
            top = px(INSET) + (px(TAG + GAP) if number and not are_beside else 0)
            if number == 0:
                words = QFontMetrics(_font()).elidedText(words, Qt.TextElideMode.ElideRight, width - 2 * px(PADDING))
            tone, fill = ("caution_ink", QColor(theme.colours.caution)) if is_caution else ("inv_ink", ink)
            found.append((PaintedText(words, QRectF(left, top, width, px(TAG)), _font(), tone, CENTRE), fill))
        return found

    def _value_boxes(self) -> list[QRectF]:
        """From the lower corners up, L at the left and R at the right, first value on top."""
        boxes = []
        for number, tag in enumerate(self.values):
            beneath = sum(other.side is tag.side for other in self.values[number + 1 :])
            width = px(CHIP) + px(PADDING) + _width(tag.words) - px(PADDING)
            left = px(INSET) if tag.side is Side.LEFT else self.width() - px(INSET) - width
            top = self.height() - px(INSET) - px(TAG) - beneath * px(TAG + GAP)
            boxes.append(QRectF(QPointF(left, top), QSize(width, px(TAG)).toSizeF()))
        return boxes


def _font() -> QFont:
    return current_theme().font(13, QFont.Weight.DemiBold)


def _width(words: str) -> int:
    return QFontMetrics(_font()).horizontalAdvance(words) + 2 * px(PADDING) + 1 if words else 0
