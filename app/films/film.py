"""The films of the manual: which scenes each has, one frame of it, its scenes as stills side by side, its captions."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter

from app.films.free_motion import paint_seated
from app.films.sensor_placement import paint_strapping
from app.theme.theme import Theme
from app.widgets.text import REGULAR, SEMIBOLD
from app.wording.translation import later, tr

SHAPE = 0.5  # height by width of a frame
ROWS_OF_STILLS, STILLS_SHAPE = 2, 0.84
STILL_WORDS = 48  # px below each still
SCENE_S = 3.0
STILL_AT = 0.8  # of a scene: its movement is seen by then
EDGE = 16
SMALLEST = 9
IN_MARKDOWN = re.compile(r"(?m)^!\[[^\]]*\]\(films/([\w-]+)\.webp\)$")
LINE_BREAK = "  \n"  # in Markdown


class Film(StrEnum):
    """The values are the names under which the pages of the manual show them."""

    SENSOR_PLACEMENT = "sensor-placement"
    FREE_MOTION = "free-motion"


@dataclass(frozen=True, slots=True)
class Scene:
    title: str
    words: str


# paints a scene by its number, at a share of it, into a rectangle
Paint = Callable[[QPainter, QRectF, Theme, int, float], None]
PAINTED: dict[Film, Paint] = {Film.SENSOR_PLACEMENT: paint_strapping, Film.FREE_MOTION: paint_seated}
SCENES: dict[Film, tuple[Scene, ...]] = {
    Film.SENSOR_PLACEMENT: (
        Scene(later("Thigh"), later("A hand's width above the knee, on the outside.")),
        Scene(later("Shank"), later("On the flat side of the shin, or on the outside.")),
        Scene(later("Foot"), later("On top of the foot, over the laces.")),
        Scene(
            later("Any orientation"), later("Sensor orientation is detected automatically. The strap must not slip.")
        ),
    ),
    Film.FREE_MOTION: (
        Scene(
            later("Bend the left knee"), later("Back and forth, as far as comfortable. Moving the leg by hand is fine.")
        ),
        Scene(later("Circle the left lower leg"), later("Seated, lying or standing, moved by hand if needed.")),
        Scene(later("Change direction"), later("From time to time, reverse the direction.")),
        Scene(later("Circle the left foot"), later("Circle at the ankle, in both directions.")),
        Scene(later("Then the right leg"), later("The gauges show which joint still needs movement.")),
    ),
}


def duration_s(film: Film) -> float:
    return SCENE_S * len(SCENES[film])


def with_captions(markdown: str) -> str:
    """Put below each film of a page what its scenes show, one line each."""
    return IN_MARKDOWN.sub(lambda found: f"{found[0]}\n\n{captions(Film(found[1]))}", markdown)


def captions(film: Film) -> str:
    """Give the words that are painted on the scenes, in their order, for whom a film moves too fast or not at all."""
    scenes = enumerate(SCENES[film], start=1)
    return LINE_BREAK.join(f"**{number}. {tr(scene.title)}:** {tr(scene.words)}" for number, scene in scenes)


def film_height(width: float, *, is_moving: bool) -> float:
    """How high a picture of this width is: one frame, or all stills."""
    return (SHAPE if is_moving else STILLS_SHAPE) * width


def paint_frame(painter: QPainter, rect: QRectF, theme: Theme, film: Film, time_s: float, hint: str = "") -> None:
    """Draw the film at `time_s`: figure left, words right, progress; `hint`, below, states what stops it."""
    px, scenes = theme.px, SCENES[film]
    number = min(int(time_s / SCENE_S), len(scenes) - 1)
    _paint_ground(painter, rect, theme)
    figure = rect.adjusted(px(EDGE), px(EDGE), -0.52 * rect.width(), -px(EDGE))
    PAINTED[film](painter, figure, theme, number, min(time_s / SCENE_S - number, 1.0))
    words = QRectF(figure.right() + px(EDGE), rect.top(), rect.right() - figure.right() - px(2 * EDGE), rect.height())
    title = QRectF(words.left(), words.top() + 0.24 * words.height(), words.width(), 0.26 * words.height())
    _paint_words(painter, title, theme, tr(scenes[number].title), 24, Qt.AlignmentFlag.AlignBottom, SEMIBOLD)
    below = QRectF(words.left(), title.bottom() + px(8), words.width(), 0.3 * words.height())
    _paint_words(painter, below, theme, tr(scenes[number].words), 16, Qt.AlignmentFlag.AlignTop)
    track = QRectF(words.left(), words.bottom() - px(EDGE + 6), words.width(), px(4))
    painter.fillRect(track, QColor(theme.colours.track))
    share = min(time_s / duration_s(film), 1.0)
    painter.fillRect(
        QRectF(track.left(), track.top(), share * track.width(), track.height()), QColor(theme.colours.ink2)
    )
    if hint:
        above = QRectF(track.left(), track.top() - px(30), track.width(), px(24))
        _paint_words(painter, above, theme, hint, 12, Qt.AlignmentFlag.AlignBottom)


def paint_stills(painter: QPainter, rect: QRectF, theme: Theme, film: Film) -> None:
    """Draw every scene beside the others, in the order of the film: for whom nothing should move."""
    columns = math.ceil(len(SCENES[film]) / ROWS_OF_STILLS)
    width, height = rect.width() / columns, rect.height() / ROWS_OF_STILLS
    _paint_ground(painter, rect, theme)
    for number, scene in enumerate(SCENES[film]):
        row, column = divmod(number, columns)
        box = QRectF(rect.left() + column * width, rect.top() + row * height, width, height)
        figure = box.adjusted(theme.px(EDGE), theme.px(EDGE), -theme.px(EDGE), -theme.px(STILL_WORDS))
        PAINTED[film](painter, figure, theme, number, STILL_AT)
        words = QRectF(box.left() + theme.px(8), figure.bottom(), box.width() - theme.px(16), theme.px(STILL_WORDS))
        stated = f"{number + 1}. {tr(scene.title)}"
        middle = Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignVCenter
        _paint_words(painter, words, theme, stated, 16, middle, SEMIBOLD)


def _paint_ground(painter: QPainter, rect: QRectF, theme: Theme) -> None:
    theme.paint_box(painter, rect.adjusted(1, 1, -1, -1), theme.colours.ground, theme.colours.line, 1)


def _paint_words(
    painter: QPainter,
    rect: QRectF,
    theme: Theme,
    stated: str,
    size: float,
    alignment: Qt.AlignmentFlag,
    weight: QFont.Weight = REGULAR,
) -> None:
    """In `size`, or as much smaller as a long word or a narrow picture asks for."""
    flags = int(Qt.TextFlag.TextWordWrap.value) | alignment.value
    room = rect.toRect()
    while True:
        font = theme.font(size, weight)
        needed = QFontMetrics(font).boundingRect(room, flags, stated)
        if size <= SMALLEST or (needed.width() <= room.width() and needed.height() <= room.height()):
            break
        size -= 1
    painter.setFont(font)
    painter.setPen(QColor(theme.colours.ink if weight == SEMIBOLD else theme.colours.ink2))
    painter.drawText(room, flags, stated)
