"""Clips of a simulated walk for tests: each frame a JPEG in which both legs are drawn as lines, and its number."""

import math
from collections.abc import Sequence
from uuid import UUID

import numpy as np
from PySide6.QtCore import QBuffer, QIODevice, QPointF, Qt
from PySide6.QtGui import QColor, QImage, QImageWriter, QPainter, QPen

from core.body import Side, ankle_of, knee_of
from core.results import RecordingAnalysis
from core.video.clip import Clip, Sync, SyncBy

RATE_HZ = 30.0
COLOURS = {Side.LEFT: "#d55e00", Side.RIGHT: "#0072b2"}
SURE = Sync(0.0, 0.01, SyncBy.MOTION)


class Jpegs:
    """Frames in memory; those of `damaged` cannot be read. `asked`: the numbers of those that were."""

    def __init__(self, jpegs: Sequence[bytes], damaged: Sequence[int] = ()) -> None:
        self._jpegs, self._damaged = jpegs, frozenset(damaged)
        self.asked: list[int] = []

    def __len__(self) -> int:
        return len(self._jpegs)

    def jpeg(self, number: int) -> bytes:
        self.asked.append(number)
        if number in self._damaged:
            raise OSError(f"frame {number} is damaged")
        return self._jpegs[number]


def drawn_clip(
    walk: RecordingAnalysis,
    *,
    number: int = 1,
    camera: int = 1,
    view: str = "from the left",
    size: tuple[int, int] = (1280, 720),
    sync: Sync | None = SURE,
    stamped_later_s: float = 0.0,
    length_s: float = math.inf,
    damaged: Sequence[int] = (),
) -> Clip:
    """The walk as a camera saw it from its first sample on; its stamps are later by so much."""
    first_s, last_s = float(walk.time_s[0]), float(walk.time_s[-1])
    time_s = np.arange(first_s, min(last_s, first_s + length_s), 1 / RATE_HZ)
    jpegs = [_jpeg(walk, float(at), size) for at in time_s]
    return Clip(
        UUID(int=number), walk.name, camera, view, *size, RATE_HZ, time_s + stamped_later_s, sync, Jpegs(jpegs, damaged)
    )


def plain_clip(*, sync: Sync | None = SURE, damaged: Sequence[int] = (), frames: int = 25) -> Clip:
    """Of no walk: the picture of frame k is grey, 10 k bright."""
    jpegs = []
    for k in range(frames):
        image = QImage(320, 180, QImage.Format.Format_RGB32)
        image.fill(QColor(10 * k, 10 * k, 10 * k))
        jpegs.append(jpeg_of(image))
    stamped_s = np.arange(frames) / RATE_HZ
    return Clip(UUID(int=9), "walk 1", 1, "", 320, 180, RATE_HZ, stamped_s, sync, Jpegs(jpegs, damaged))


def jpeg_of(image: QImage, quality: int = 80) -> bytes:
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    writer = QImageWriter(buffer, b"jpeg")
    writer.setQuality(quality)
    writer.write(image)
    return bytes(buffer.data().data())


def _jpeg(walk: RecordingAnalysis, time_s: float, size: tuple[int, int]) -> bytes:
    image = QImage(*size, QImage.Format.Format_RGB32)
    image.fill(QColor("#b9bdc1"))
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.fillRect(0, int(size[1] * 0.86), size[0], size[1], QColor("#77705f"))
    hip = QPointF(size[0] * 0.5, size[1] * 0.25)
    for side in Side:
        knee, ankle = (
            float(np.interp(time_s, walk.time_s, np.nan_to_num(walk.joints[joint].angle_rad)))
            if joint in walk.joints
            else 0.0
            for joint in (knee_of(side), ankle_of(side))
        )
        painter.setPen(QPen(QColor(COLOURS[side]), size[1] * 0.04, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        lean = 0.45 * math.sin(2 * math.pi * time_s / 1.1 + (math.pi if side is Side.RIGHT else 0.0))
        at = hip
        for length, tilt in ((0.3, lean), (0.28, lean - knee), (0.1, lean - knee + ankle + math.pi / 2)):
            end = at + QPointF(math.sin(tilt), math.cos(tilt)) * length * size[1]
            painter.drawLine(at, end)
            at = end
    painter.end()
    return jpeg_of(image)
