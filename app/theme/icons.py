"""The icons of `resources/icons` in the theme's ink: 24 px grid, stroke of 1.75. Never alone, never coloured."""

from enum import StrEnum
from functools import cache
from importlib.resources import files

from PySide6.QtCore import QByteArray, QRectF
from PySide6.QtGui import QColor, QPainter
from PySide6.QtSvg import QSvgRenderer

from core.findings import Severity
from core.verdicts.model import Verdict


class Icon(StrEnum):
    """The name of each file."""

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
    DIFFERENCE = "difference"
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
    SWAP = "swap"
    NEXT = "next"
    ARROW = "arrow"
    SEARCH = "search"
    DELETE = "delete"
    LOCK = "lock"
    EDIT = "edit"
    PRINT = "print"
    LIGHT = "light"
    GRIP = "grip"
    READ = "read"
    CARE = "care"
    NOT_REPORTED = "withheld"
    LEGS = "legs"
    GROUPS = "groups"
    GOAL = "goal"
    CAMERA = "camera"
    PAUSE = "pause"


VERDICT_ICONS = {  # triangles are for problems of the measurement; a change of the patient has arrows
    Verdict.READ: Icon.READ,
    Verdict.CARE: Icon.CARE,
    Verdict.NOT_REPORTED: Icon.NOT_REPORTED,
    Verdict.NOT_MEASURED: Icon.UNCHECKED,
}
SEVERITY_ICONS = {Severity.INFO: Icon.INFO, Severity.WARNING: Icon.WARNING, Severity.GRAVE: Icon.GRAVE}


def paint_icon(painter: QPainter, icon: Icon, rect: QRectF, ink: QColor | str) -> None:
    """Draw `icon` into the square `rect`, which need not lie on whole pixels."""
    _drawing(icon, QColor(ink).name()).render(painter, rect)


@cache
def _drawing(icon: Icon, ink: str) -> QSvgRenderer:
    """Kept, since painters ask for the same few thousands of times a minute."""
    svg = (files("resources") / "icons" / f"{icon}.svg").read_bytes()
    return QSvgRenderer(QByteArray(svg.replace(b"currentColor", ink.encode())))
