"""The picture that the patient sees, drawn once for 1280 by 800 and scaled to whatever room there is.

Fonts follow the room and not the size of everything: it is read from two metres, not from a desk.
"""

from dataclasses import replace
from typing import NamedTuple

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QFontMetricsF, QPainter, QPainterPath, QPen, QPolygonF

from app.patient_screen.patient_view import (
    NO_VALUE,
    SHOWN_STRIDES,
    PatientView,
    figure,
    next_step_words,
    reached_words,
    so_far_words,
    steps_words,
    title_of,
    tone_words,
    unit_words,
)
from app.theme.current import current_theme
from app.theme.icons import Icon, paint_icon
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import Theme
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording.numbers import MINUS
from app.wording.translation import tr
from core.body import Side
from core.targets import Target

WIDTH, HEIGHT = 1280, 800
BAR = QRectF(80, 400, 1120, 136)
BELOW, ABOVE = 25, 15  # in the measure's unit: how far the bar reaches on either side of the target
TICK = 10
STEPS_LEFT, STEP_EVERY, STEP_WIDTH, STEP_BASE = 479, 73, 58, 752
STEP_AT_TARGET, STEP_PER_UNIT, STEP_HEIGHTS = 81, 8, (16, 113)
LEFT, RIGHT = 80, 1200
MIDDLE, AT_LEFT, AT_RIGHT = (
    Qt.AlignmentFlag.AlignCenter,
    Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter,
    Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter,
)


SMALL_BELOW = 0.6  # of the scale: in a corner of the clinician's screen small letters could not be read


class _Sizes(NamedTuple):
    """What is larger, or left out, where all else is small."""

    is_small: bool
    chip: float
    title: float
    word: float
    target: float
    note: float


USUAL, IN_CORNER = _Sizes(False, 56, 40, 40, 96, 22), _Sizes(True, 84, 62, 60, 110, 40)


class _Inks(NamedTuple):
    """What a leg's bar is drawn with; of both legs together in the ink of the text, for no hue is theirs."""

    full: QColor
    pale: QColor
    soft: QColor


def paint_patient_view(painter: QPainter, room: QRectF, view: PatientView) -> None:
    """Fill `room` with what the patient is shown."""
    theme = replace(current_theme(), scale=1.0)
    painter.fillRect(room, QColor(theme.colours.surface))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    scale = min(room.width() / WIDTH, room.height() / HEIGHT)
    painter.save()
    painter.translate(room.center())
    painter.scale(scale, scale)
    painter.translate(-WIDTH / 2, -HEIGHT / 2)
    if view.target is None and (view.steps is None or view.is_waiting):
        _text(painter, theme, QRectF(0, 0, WIDTH, HEIGHT), tr("One moment"), 96, flags=MIDDLE)
    elif view.target is None:
        _text(painter, theme, QRectF(0, 190, WIDTH, 300), str(view.steps), 320, flags=MIDDLE)
        _text(painter, theme, QRectF(LEFT, 520, RIGHT - LEFT, 80), so_far_words(view.steps or 0), 64, flags=MIDDLE)
    else:
        _paint(painter, view, view.target, theme, IN_CORNER if scale < SMALL_BELOW else USUAL)
    painter.restore()


def _paint(painter: QPainter, view: PatientView, target: Target, theme: Theme, sizes: _Sizes) -> None:
    inks = _inks(target.side, theme)
    _paint_heading(painter, view, target, theme, sizes)
    if view.is_waiting or view.is_standing:
        words = tr("One moment") if view.is_waiting else next_step_words()
        _paint_words(painter, theme, QRectF(LEFT, 160, 510, 200), words)
    else:
        shown = NO_VALUE if view.value is None else figure(view.value, target.measure)
        _text(painter, theme, QRectF(LEFT, 150, 560, 216), shown, 240 if len(shown) <= 3 else 184, fits=True)
    _paint_target(painter, target, theme, sizes)
    _paint_bar(painter, view, target, theme, inks, sizes)
    painter.fillRect(QRectF(LEFT, 612, RIGHT - LEFT, 1), QColor(theme.colours.line))
    if not view.is_waiting:
        _paint_last(painter, view, target, theme, inks, sizes)


def _inks(side: Side | None, theme: Theme) -> _Inks:
    c = theme.colours
    if side is None:
        return _Inks(QColor(c.ink), QColor(c.sunken), QColor(c.control))
    return _Inks(theme.curve(side), theme.pale(side), theme.soft(side))


def _paint_heading(painter: QPainter, view: PatientView, target: Target, theme: Theme, sizes: _Sizes) -> None:
    left = LEFT
    if target.side is not None:
        painter.save()
        painter.translate(LEFT, 92 - sizes.chip / 2)
        painter.scale(sizes.chip / CHIP, sizes.chip / CHIP)
        paint_chip(painter, QRectF(0, 0, CHIP, CHIP), target.side, theme)
        painter.restore()
        left += round(sizes.chip) + 24
    tone = tone_words(target) if view.has_sound else tr("sound off")
    width = QFontMetricsF(theme.font(sizes.note)).horizontalAdvance(tone) + 2
    if sizes.is_small:  # the icon says it
        width = 0.0
    else:
        box = QRectF(RIGHT - width, 64, width, 56)
        _text(painter, theme, box, tone, sizes.note, "ink2", weight=MEDIUM, flags=AT_RIGHT)
    icon, side = Icon.SOUND if view.has_sound else Icon.SOUND_OFF, sizes.note + 12
    paint_icon(painter, icon, QRectF(RIGHT - width - side - 14, 92 - side / 2, side, side), theme.colours.ink2)
    room = QRectF(left, 64, RIGHT - width - side - 38 - left, 56)
    _text(painter, theme, room, title_of(target), sizes.title, fits=True)


def _paint_words(painter: QPainter, theme: Theme, box: QRectF, words: str, most: float = 80, tone: str = "ink") -> None:
    """In as many lines as they need, `most` px large or as large as they have room."""
    flags, size = int(AT_LEFT.value) | Qt.TextFlag.TextWordWrap.value, most
    while size > 8:
        found = QFontMetricsF(theme.font(size, SEMIBOLD)).boundingRect(box, flags, words)
        if found.width() <= box.width() and found.height() <= box.height():
            break
        size -= 2
    painter.setFont(theme.font(size, SEMIBOLD))
    painter.setPen(QColor(getattr(theme.colours, tone)))
    painter.drawText(box, flags, words)


def _paint_target(painter: QPainter, target: Target, theme: Theme, sizes: _Sizes) -> None:
    at = _x(target, target.value)
    label = QRectF(at - 180, 236 - sizes.word, 360, sizes.word + 6)
    _text(painter, theme, label, tr("Target"), sizes.word, "ink2", weight=MEDIUM, flags=MIDDLE)
    shown = figure(target.value, target.measure)
    _text(painter, theme, QRectF(at - 180, 248, 360, 98), shown, sizes.target, flags=MIDDLE, fits=True)
    words = unit_words(target.measure)
    if words:
        half = 0.5 * min(QFontMetricsF(theme.font(sizes.target, SEMIBOLD)).horizontalAdvance(shown), 360.0)
        left = at + max(130.0, half + 16.0)
        _paint_words(painter, theme, QRectF(left, 236, RIGHT - left, 132), words, sizes.note, "ink2")


def _paint_bar(painter: QPainter, view: PatientView, target: Target, theme: Theme, inks: _Inks, sizes: _Sizes) -> None:
    c, at = theme.colours, _x(target, target.value)
    frame = QPainterPath()
    frame.addRoundedRect(BAR, 14, 14)
    painter.save()
    painter.setClipPath(frame)
    painter.fillRect(BAR, QColor(c.track))
    beyond = QRectF(at, BAR.top(), BAR.right() - at, BAR.height())
    painter.fillRect(beyond, inks.pale)
    _paint_hatch(painter, beyond, inks.soft)
    if view.value is not None:
        painter.fillRect(QRectF(BAR.topLeft(), QPointF(_x(target, view.value), BAR.bottom())), inks.full)
    painter.restore()
    painter.fillRect(QRectF(at - 6, BAR.top(), 12, BAR.height()), QColor(c.surface))  # parts the line from the fill
    painter.fillRect(QRectF(at - 3, 374, 6, 186), QColor(c.ink))
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(c.ink))
    painter.drawPolygon(QPolygonF([QPointF(at - 17, 353), QPointF(at + 17, 353), QPointF(at, 377)]))
    first = -(-(target.value - BELOW) // TICK) * TICK
    for value in range(first, target.value + ABOVE + 1, TICK):
        x, shown = _x(target, value), figure(value, target.measure)
        if abs(x - at) < 24:
            continue  # the line of the target is there
        width = QFontMetricsF(theme.font(sizes.note, MEDIUM)).horizontalAdvance(shown) + 2
        left = min(max(x - width / 2, BAR.left()), BAR.right() - width)
        box = QRectF(left, 553, width, sizes.note + 10)
        _text(painter, theme, box, shown, sizes.note, "ink2", weight=MEDIUM, flags=MIDDLE)


def _paint_hatch(painter: QPainter, box: QRectF, colour: QColor) -> None:
    painter.save()
    painter.setClipRect(box, Qt.ClipOperation.IntersectClip)
    painter.setPen(QPen(colour, 2.5))
    x = box.left() - box.height()
    while x < box.right():
        painter.drawLine(QPointF(x, box.bottom()), QPointF(x + box.height(), box.top()))
        x += 20
    painter.restore()


def _paint_last(painter: QPainter, view: PatientView, target: Target, theme: Theme, inks: _Inks, sizes: _Sizes) -> None:
    c = theme.colours
    box = QRectF(LEFT, 680 - sizes.note - 10, 380, sizes.note + 10)
    _text(painter, theme, box, steps_words(len(view.last)), sizes.note, weight=MEDIUM, fits=True)
    if view.last:
        _text(painter, theme, QRectF(LEFT, 682, 380, 52), reached_words(view), sizes.word, fits=True)
    first = SHOWN_STRIDES - len(view.last)  # the newest is at the right from the first step on
    for number, value in enumerate(view.last, start=first):
        is_reached = target.is_reached(value)
        low, high = STEP_HEIGHTS
        height = min(max(STEP_AT_TARGET + STEP_PER_UNIT * (value - target.value), low), high)
        box = QRectF(STEPS_LEFT + STEP_EVERY * number, STEP_BASE - height, STEP_WIDTH, height)
        painter.setPen(theme.pen(inks.full, 3))
        painter.setBrush(QBrush(inks.full) if is_reached else Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(box.adjusted(1.5, 1.5, -1.5, -1.5), 7, 7)
        if is_reached:
            paint_icon(painter, Icon.CHECK, QRectF(box.center().x() - 12, STEP_BASE - 34, 24, 24), c.surface)
        if sizes.is_small:
            continue
        over = QRectF(box.left() - 10, box.top() - 26, STEP_WIDTH + 20, 24)
        shown, tone = str(value).replace("-", MINUS), "ink" if is_reached else "ink2"
        _text(painter, theme, over, shown, 17, tone, weight=SEMIBOLD if is_reached else MEDIUM, flags=MIDDLE)


def _x(target: Target, value: int) -> float:
    """Where on the bar a value lies; beyond its ends at them."""
    share = (value - target.value + BELOW) / (BELOW + ABOVE)
    return BAR.left() + BAR.width() * min(max(share, 0.0), 1.0)


def _text(
    painter: QPainter,
    theme: Theme,
    box: QRectF,
    text: str,
    size: float,
    tone: str = "ink",
    *,
    weight: QFont.Weight = SEMIBOLD,
    flags: Qt.AlignmentFlag = AT_LEFT,
    fits: bool = False,
) -> None:
    """Draw a line of text; `fits`: smaller where a longer language would not have the room."""
    font = theme.font(size, weight)
    if fits:
        width = QFontMetricsF(font).horizontalAdvance(text)
        if width > box.width():
            font = theme.font(size * box.width() / width, weight)
    painter.setFont(font)
    painter.setPen(QColor(getattr(theme.colours, tone)))
    painter.drawText(box, int(flags.value) | Qt.TextFlag.TextDontClip.value, text)
