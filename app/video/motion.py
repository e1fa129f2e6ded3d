"""Offset of a clip, from the motion in its pictures and that of the sensors."""

from contextlib import suppress

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QSize
from PySide6.QtGui import QImage

from app.system.progress import Report
from app.video.jpeg import JpegDecoder
from core.session import Recording
from core.video.clip import Clip, Sync
from core.video.synchronising import LIVE_SEARCH_S, WHOLE_SEARCH_S, picture_motion, sync_from_motion

ROOM = QSize(160, 160)  # more shows nothing more of how much moves


def sync_of(
    clip: Clip, recording: Recording, decoder: JpegDecoder, report: Report, *, is_imported: bool
) -> Sync | None:
    """Find the offset of a clip; None where the motion leaves it open. `report` may end the work."""
    count = len(clip.pictures)
    pictures, taken_s = list[NDArray[np.uint8]](), list[float]()
    for number in range(count):
        report(number / count, "")
        with suppress(OSError):  # a damaged frame
            picture = decoder.decoded(clip.pictures.jpeg(number), ROOM)
            if not picture.isNull() and (not pictures or _size(picture) == pictures[0].shape):
                pictures.append(_grey(picture))
                taken_s.append(clip.stamped_s[number])
    if not pictures:
        return None
    frame_s = np.array(taken_s)
    motion = picture_motion(np.stack(pictures), frame_s)
    return sync_from_motion(frame_s, motion, recording.imu, search_s=WHOLE_SEARCH_S if is_imported else LIVE_SEARCH_S)


def _size(picture: QImage) -> tuple[int, int]:
    return picture.height(), picture.width()


def _grey(picture: QImage) -> NDArray[np.uint8]:
    image = picture.convertToFormat(QImage.Format.Format_Grayscale8)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : image.width()].copy()
