"""Icons drawn in the theme's ink: 24 px grid, stroke of 1.75, round ends. Never alone, never coloured."""

from collections.abc import Callable
from enum import StrEnum

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPainterPath, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme import Look
from core.findings import Severity


class Icon(StrEnum):
    FOLDER = "folder"
    PLAY = "play"
    STOP = "stop"
    CHEVRON = "chevron"
    CLOSE = "close"
    WHOLE = "whole"
    CHECK = "check"
    UNCHECKED = "unchecked"
    INFO = "info"
    WARNING = "warning"
    GRAVE = "grave"
    BACK = "back"
    REPEAT = "repeat"
    SOUND = "sound"
    SOUND_OFF = "sound_off"
    HOME = "home"
    SETTINGS = "settings"
    HELP = "help"
    LIGHT_OR_DARK = "light_or_dark"
    IMPORT = "import"
    ADD = "add"
    WAVE = "wave"
    STILL = "still"
    SILENT = "silent"
    RECORDING = "recording"
    BEND = "bend"
    NEXT = "next"
    SEARCH = "search"
    DELETE = "delete"
    LOCK = "lock"
    PRINT = "print"
    LIGHT = "light"
    GRIP = "grip"


SEVERITY_ICONS = {Severity.INFO: Icon.INFO, Severity.WARNING: Icon.WARNING, Severity.GRAVE: Icon.GRAVE}


def paint_icon(painter: QPainter, icon: Icon, rect: QRectF, ink: QColor | str) -> None:
    """Draw `icon` into the square `rect`."""
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.translate(rect.topLeft())
    painter.scale(rect.width() / 24, rect.height() / 24)
    pen = QPen(QColor(ink), 1.75)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    painter.setPen(pen)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    _DRAWINGS[icon](painter, QColor(ink))
    painter.restore()


class IconMark(QWidget):
    """An icon beside words. The words say what it says, so a reader of screens passes over it."""

    def __init__(self, look: Look, icon: Icon, size: float = 20, tone: str = "ink") -> None:
        super().__init__()
        self._look, self._icon, self._size, self._tone = look, icon, size, tone
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        look.changed.connect(self._on_look_changed)

    def set_icon(self, icon: Icon) -> None:
        self._icon = icon
        self.update()

    def sizeHint(self) -> QSize:
        side = self._look.theme.px(self._size)
        return QSize(side, side)

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        paint_icon(painter, self._icon, QRectF(self.rect()), getattr(self._look.theme.colours, self._tone))

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.update()


def _lines(painter: QPainter, *points: tuple[float, float]) -> None:
    painter.drawPolyline(QPolygonF([QPointF(x, y) for x, y in points]))


def _filled(painter: QPainter, ink: QColor, *points: tuple[float, float]) -> None:
    painter.setBrush(QBrush(ink))
    painter.drawPolygon(QPolygonF([QPointF(x, y) for x, y in points]))


def _folder(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (3, 18.5), (3, 5.5), (9.5, 5.5), (11.5, 8), (21, 8), (21, 18.5), (3, 18.5))


def _play(painter: QPainter, ink: QColor) -> None:
    _filled(painter, ink, (7, 5.5), (18.5, 12), (7, 18.5))


def _stop(painter: QPainter, ink: QColor) -> None:
    _filled(painter, ink, (7, 7), (17, 7), (17, 17), (7, 17))


def _chevron(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (6, 9), (12, 15), (18, 9))


def _close(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (6, 6), (18, 18))
    _lines(painter, (18, 6), (6, 18))


def _whole(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (3, 5), (3, 19))
    _lines(painter, (21, 5), (21, 19))
    _lines(painter, (6.5, 12), (17.5, 12))
    _lines(painter, (9.5, 9), (6.5, 12), (9.5, 15))
    _lines(painter, (14.5, 9), (17.5, 12), (14.5, 15))


def _check(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (5, 12.5), (10, 17.5), (19, 7))


def _unchecked(painter: QPainter, _ink: QColor) -> None:
    painter.drawEllipse(QPointF(12, 12), 7, 7)


def _info(painter: QPainter, _ink: QColor) -> None:
    painter.drawEllipse(QPointF(12, 12), 9, 9)
    _lines(painter, (12, 11), (12, 16.5))
    painter.drawPoint(QPointF(12, 7.6))


def _warning(painter: QPainter, _ink: QColor) -> None:
    painter.drawPolygon(QPolygonF([QPointF(12, 3.5), QPointF(21.5, 20), QPointF(2.5, 20)]))
    _lines(painter, (12, 9.5), (12, 14.2))
    painter.drawPoint(QPointF(12, 17))


def _grave(painter: QPainter, ink: QColor) -> None:
    """An octagon filled with ink, a bar cut out of it: the heaviest shape stands for the gravest word."""
    corners = [(8, 2.5), (16, 2.5), (21.5, 8), (21.5, 16), (16, 21.5), (8, 21.5), (2.5, 16), (2.5, 8)]
    shape = QPainterPath()  # filled by odd and even, so that what lies inside is a hole
    shape.addPolygon(QPolygonF([QPointF(x, y) for x, y in corners]))
    shape.closeSubpath()
    shape.addRoundedRect(QRectF(10.8, 6.2, 2.4, 7.6), 1.2, 1.2)
    shape.addEllipse(QPointF(12, 17), 1.5, 1.5)
    painter.fillPath(shape, QBrush(ink))


def _back(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (15, 6), (9, 12), (15, 18))


def _repeat(painter: QPainter, _ink: QColor) -> None:
    painter.drawArc(QRectF(4, 4, 16, 16), 35 * 16, 300 * 16)
    _lines(painter, (18.8, 3.2), (18.6, 7.6), (14.2, 7.4))


def _speaker(painter: QPainter) -> None:
    _lines(painter, (3.5, 9.5), (3.5, 14.5), (7, 14.5), (11.5, 18.5), (11.5, 5.5), (7, 9.5), (3.5, 9.5))


def _sound(painter: QPainter, _ink: QColor) -> None:
    _speaker(painter)
    painter.drawArc(QRectF(10.5, 8.5, 7, 7), -50 * 16, 100 * 16)
    painter.drawArc(QRectF(8.5, 5, 14, 14), -50 * 16, 100 * 16)


def _sound_off(painter: QPainter, _ink: QColor) -> None:
    _speaker(painter)
    _lines(painter, (15.5, 9.5), (20.5, 14.5))
    _lines(painter, (20.5, 9.5), (15.5, 14.5))


def _home(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (3, 11.5), (12, 3.5), (21, 11.5))
    _lines(painter, (5.5, 9.8), (5.5, 20), (9.5, 20), (9.5, 14), (14.5, 14), (14.5, 20), (18.5, 20), (18.5, 9.8))


def _settings(painter: QPainter, _ink: QColor) -> None:
    for y, knob in ((6, 14.5), (12, 8.5), (18, 16)):
        _lines(painter, (3, y), (knob - 2.2, y))
        _lines(painter, (knob + 2.2, y), (21, y))
        painter.drawEllipse(QPointF(knob, y), 2.2, 2.2)


def _help(painter: QPainter, _ink: QColor) -> None:
    painter.drawEllipse(QPointF(12, 12), 9, 9)
    curve = QPainterPath(QPointF(9.3, 9.6))
    curve.cubicTo(9.4, 5.9, 14.9, 6.1, 14.7, 9.5)
    curve.cubicTo(14.6, 11.6, 12, 11.6, 12, 13.9)
    painter.drawPath(curve)
    painter.drawPoint(QPointF(12, 16.9))


def _light_or_dark(painter: QPainter, ink: QColor) -> None:
    painter.drawEllipse(QPointF(12, 12), 9, 9)
    painter.setBrush(QBrush(ink))
    painter.drawChord(QRectF(3, 3, 18, 18), 90 * 16, 180 * 16)


def _import(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (12, 3.5), (12, 14.5))
    _lines(painter, (7.5, 10), (12, 14.5), (16.5, 10))
    _lines(painter, (3.5, 16), (3.5, 20), (20.5, 20), (20.5, 16))


def _add(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (12, 4.5), (12, 19.5))
    _lines(painter, (4.5, 12), (19.5, 12))


def _wave(painter: QPainter, _ink: QColor) -> None:
    curve = QPainterPath(QPointF(2.5, 12))
    curve.cubicTo(5, 12, 5.5, 5, 8, 5)
    curve.cubicTo(11, 5, 13, 19, 16, 19)
    curve.cubicTo(18.5, 19, 19, 12, 21.5, 12)
    painter.drawPath(curve)


def _bend(painter: QPainter, _ink: QColor) -> None:
    """A thigh, a shank below it, and the way the shank swings."""
    _lines(painter, (2.5, 6), (11, 6.5), (8, 19.5))
    painter.drawArc(QRectF(-1, -5.5, 24, 24), -72 * 16, 54 * 16)
    _lines(painter, (18.2, 10.6), (22.4, 9.4), (23, 13.6))


def _next(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (9, 6), (15, 12), (9, 18))


def _still(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (3, 12), (21, 12))


def _silent(painter: QPainter, _ink: QColor) -> None:
    painter.drawEllipse(QPointF(12, 12), 9, 9)
    _lines(painter, (5.8, 5.8), (18.2, 18.2))


def _recording(painter: QPainter, ink: QColor) -> None:
    painter.setBrush(QBrush(ink))
    painter.drawEllipse(QPointF(12, 12), 7, 7)


def _search(painter: QPainter, _ink: QColor) -> None:
    painter.drawEllipse(QPointF(10.5, 10.5), 6.5, 6.5)
    _lines(painter, (15.4, 15.4), (20.5, 20.5))


def _delete(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (4, 6.5), (20, 6.5))
    _lines(painter, (9, 6.5), (9, 3.5), (15, 3.5), (15, 6.5))
    _lines(painter, (6, 6.5), (7, 20.5), (17, 20.5), (18, 6.5))
    _lines(painter, (10, 10.5), (10, 16.5))
    _lines(painter, (14, 10.5), (14, 16.5))


def _lock(painter: QPainter, _ink: QColor) -> None:
    painter.drawRoundedRect(QRectF(4.5, 10.5, 15, 10), 2, 2)
    painter.drawArc(QRectF(7.5, 3.5, 9, 10), 0, 180 * 16)
    _lines(painter, (7.5, 8.5), (7.5, 10.5))
    _lines(painter, (16.5, 8.5), (16.5, 10.5))
    _lines(painter, (12, 14.5), (12, 16.5))


def _print(painter: QPainter, _ink: QColor) -> None:
    _lines(painter, (7, 8.5), (7, 3.5), (17, 3.5), (17, 8.5))
    _lines(painter, (7, 17), (3.5, 17), (3.5, 8.5), (20.5, 8.5), (20.5, 17), (17, 17))
    painter.drawRect(QRectF(7, 13.5, 10, 7))


def _light(painter: QPainter, _ink: QColor) -> None:
    """A bulb: the sensor's own light is meant, which is lit to find it."""
    path = QPainterPath(QPointF(9.2, 16.5))
    path.cubicTo(QPointF(9.2, 14), QPointF(5.5, 13), QPointF(5.5, 8.8))
    path.cubicTo(QPointF(5.5, 5.1), QPointF(8.4, 2.5), QPointF(12, 2.5))
    path.cubicTo(QPointF(15.6, 2.5), QPointF(18.5, 5.1), QPointF(18.5, 8.8))
    path.cubicTo(QPointF(18.5, 13), QPointF(14.8, 14), QPointF(14.8, 16.5))
    path.closeSubpath()
    painter.drawPath(path)
    _lines(painter, (9.8, 20.5), (14.2, 20.5))


def _grip(painter: QPainter, ink: QColor) -> None:
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QBrush(ink))
    for x in (8.5, 15.5):
        for y in (5.5, 12, 18.5):
            painter.drawEllipse(QPointF(x, y), 1.7, 1.7)


_DRAWINGS: dict[Icon, Callable[[QPainter, QColor], None]] = {
    Icon.FOLDER: _folder,
    Icon.PLAY: _play,
    Icon.STOP: _stop,
    Icon.CHEVRON: _chevron,
    Icon.CLOSE: _close,
    Icon.WHOLE: _whole,
    Icon.CHECK: _check,
    Icon.UNCHECKED: _unchecked,
    Icon.INFO: _info,
    Icon.WARNING: _warning,
    Icon.GRAVE: _grave,
    Icon.BACK: _back,
    Icon.REPEAT: _repeat,
    Icon.SOUND: _sound,
    Icon.SOUND_OFF: _sound_off,
    Icon.HOME: _home,
    Icon.SETTINGS: _settings,
    Icon.HELP: _help,
    Icon.LIGHT_OR_DARK: _light_or_dark,
    Icon.IMPORT: _import,
    Icon.ADD: _add,
    Icon.WAVE: _wave,
    Icon.STILL: _still,
    Icon.SILENT: _silent,
    Icon.RECORDING: _recording,
    Icon.BEND: _bend,
    Icon.NEXT: _next,
    Icon.SEARCH: _search,
    Icon.DELETE: _delete,
    Icon.LOCK: _lock,
    Icon.PRINT: _print,
    Icon.LIGHT: _light,
    Icon.GRIP: _grip,
}
