"""Draw the manual's picture of differences: `python packaging/draw_difference.py`, without a screen.

Four differences between the legs, judged by the code that judges those of patients, in its own words. Each language
and theme has its picture in `resources/help`. Run it after a change of limits, words or colours.
"""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from PySide6.QtCore import QRectF, Qt
    from PySide6.QtGui import QFont, QImage, QPainter

    from app.theme.theme import Theme
    from core.verdicts.measurement_error import Difference

ROOT = Path(__file__).resolve().parents[1]
HELP = ROOT / "resources" / "help"
FOLDERS = {"en": HELP / "pictures", "de": HELP / "de" / "pictures"}
COLUMN, MEAN_DEG, SD_DEG, ERROR_DEG = "knee_range_deg", 55.0, 2.0, 1.0
CASES = ((17.0, 24), (9.5, 24), (4.0, 24), (12.0, 6))  # difference in degrees, strides of each leg
WIDTH, HEIGHT, PIXELS = 760, 388, 2  # of the drawing, and so many pixels each
EDGE, TOP, ROW, AXIS = 24, 56, 75, 32
LEAST_DEG, MOST_DEG, STEP_DEG = -15, 30, 5
WORDS = 0.54  # of the width, right of the axis's end: what each difference is called
DOT, POINT, CAP = 6, 3.5, 7


def main() -> None:
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    sys.path.insert(0, str(ROOT))
    from PySide6.QtWidgets import QApplication

    from app.theme.current import current_theme, load_fonts, set_dark
    from app.wording.translation import use_language

    _application = QApplication([])
    load_fonts()
    for language, folder in FOLDERS.items():
        use_language(language)
        for is_dark, suffix in ((False, ""), (True, "-dark")):
            set_dark(is_dark)
            drawn(current_theme()).save(str(folder / f"difference{suffix}.png"))


def differences() -> "list[Difference]":
    """Left less right of each case, judged as those of a patient are."""
    from core.verdicts.measurement_error import compare
    from core.verdicts.sigmas import ComparisonKind
    from core.verdicts.stride_means import MeanOfStrides

    right = MEAN_DEG
    return [
        compare(
            COLUMN,
            ComparisonKind.LEGS,
            MeanOfStrides(right + difference, SD_DEG, strides, ERROR_DEG, 0.0),
            MeanOfStrides(right, SD_DEG, strides, ERROR_DEG, 0.0),
            (),
        )
        for difference, strides in CASES
    ]


def drawn(theme: "Theme") -> "QImage":
    """The whole picture in the theme and in the language that is spoken."""
    from PySide6.QtCore import QRectF, Qt
    from PySide6.QtGui import QColor, QImage, QPainter

    from app.widgets.text import SEMIBOLD
    from app.wording.measures import measure_name
    from app.wording.translation import tr

    image = QImage(PIXELS * WIDTH, PIXELS * HEIGHT, QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(PIXELS)
    image.fill(QColor(theme.colours.surface))
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    found = differences()
    left = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
    title = f"{measure_name(COLUMN, is_between=True)} (°)"
    _write(painter, QRectF(EDGE, 4, WIDTH - 2 * EDGE, 26), theme, title, 16, left, SEMIBOLD)
    stated = tr("Grey: 95 of 100 healthy people.")
    _write(painter, QRectF(EDGE, 28, WIDTH - 2 * EDGE, 20), theme, stated, 13, left)
    _paint_ground(painter, theme, found[0].healthy)
    for number, one in enumerate(found):
        _paint_difference(painter, theme, one, TOP + (number + 0.5) * ROW)
    painter.end()
    return image


def x_of(value_deg: float) -> float:
    """The place of a difference, in units of the drawing."""
    right = WORDS * WIDTH - EDGE
    return EDGE + (value_deg - LEAST_DEG) / (MOST_DEG - LEAST_DEG) * (right - EDGE)


def _paint_ground(painter: "QPainter", theme: "Theme", healthy_deg: float) -> None:
    """Paint the band of healthy legs, the line of no difference and the axis."""
    from PySide6.QtCore import QPointF, QRectF, Qt
    from PySide6.QtGui import QColor

    from app.wording.numbers import MINUS

    bottom = HEIGHT - AXIS
    band = QRectF(x_of(-healthy_deg), TOP, x_of(healthy_deg) - x_of(-healthy_deg), bottom - TOP)
    painter.fillRect(band, QColor(theme.colours.band_2sd))
    painter.setPen(theme.pen(theme.colours.ink2, 1.5))
    painter.drawLine(QPointF(x_of(0), TOP), QPointF(x_of(0), bottom))
    painter.setPen(theme.pen(theme.colours.control, 1))
    painter.drawLine(QPointF(x_of(LEAST_DEG), bottom), QPointF(x_of(MOST_DEG), bottom))
    for value in range(LEAST_DEG, MOST_DEG + 1, STEP_DEG):
        painter.setPen(theme.pen(theme.colours.control, 1))
        painter.drawLine(QPointF(x_of(value), bottom), QPointF(x_of(value), bottom + 4))
        words = f"{value:+d}".replace("-", MINUS) if value else "0"
        centre = Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop
        _write(painter, QRectF(x_of(value) - 20, bottom + 6, 40, 18), theme, words, 12, centre)


def _paint_difference(painter: "QPainter", theme: "Theme", found: "Difference", middle: float) -> None:
    """One difference: interval, the mark that tables have, what it is beyond, and what is known of it."""
    from PySide6.QtCore import QPointF, QRectF, Qt
    from PySide6.QtGui import QColor

    from app.summary.interval_words import evidence
    from app.summary.numbers_in_words import in_words, signed
    from app.widgets.text import SEMIBOLD
    from app.wording.translation import capitalised, tr
    from core.verdicts.measurement_error import Mark

    colour = QColor(theme.colours.ink)
    painter.setPen(theme.pen(colour, 2))
    if found.is_judged:
        low, high = map(x_of, found.interval)
        painter.drawLine(QPointF(low, middle), QPointF(high, middle))
        for end in (low, high):
            painter.drawLine(QPointF(end, middle - CAP), QPointF(end, middle + CAP))
    painter.setBrush(QColor(theme.colours.surface) if found.mark is Mark.ERROR else colour)
    size = DOT if found.mark is not Mark.NONE else POINT
    painter.drawEllipse(QPointF(x_of(found.difference), middle), size, size)
    room = QRectF(WORDS * WIDTH + EDGE, middle - 10, (1 - WORDS) * WIDTH - 2 * EDGE, ROW)
    top = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop
    title = f"{signed(found.difference, 1)}°: {in_words(found)}"
    _write(painter, room, theme, title, 15, top, SEMIBOLD)
    known = evidence(COLUMN, found) or capitalised(f"{tr('not judged: measurement error not known')}.")
    _write(painter, room.adjusted(0, 21, 0, 0), theme, known, 12, top)


def _write(
    painter: "QPainter",
    room: "QRectF",
    theme: "Theme",
    words: str,
    size: float,
    alignment: "Qt.AlignmentFlag",
    weight: "QFont.Weight | None" = None,
) -> None:
    from PySide6.QtCore import Qt
    from PySide6.QtGui import QColor

    from app.widgets.text import REGULAR

    painter.setFont(theme.font(size, REGULAR if weight is None else weight))
    painter.setPen(QColor(theme.colours.ink2 if weight is None else theme.colours.ink))
    painter.drawText(room, int(Qt.TextFlag.TextWordWrap.value) | alignment.value, words)


if __name__ == "__main__":
    main()
