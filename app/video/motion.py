"""Offset of a clip, from the motion in its pictures and that of the sensors."""

from collections.abc import Iterator
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QSize
from PySide6.QtGui import QImage

from app.system.progress import Report
from app.video.jpeg import JpegDecoder
from core.session import Recording
from core.video.clip import Clip, Sync
from core.video.synchronising import LIVE_SEARCH_S, WHOLE_SEARCH_S, motion_per_frame, picture_changes, sync_from_motion

ROOM = QSize(160, 160)  # more shows nothing more of how much moves


def sync_of(
    clip: Clip, recording: Recording, decoder: JpegDecoder, report: Report, *, is_imported: bool
) -> Sync | None:
    """Find the offset of a clip; None where the motion leaves it open. `report` may end the work."""
    taken_s = list[float]()
    changes = picture_changes(_sound_pictures(clip, decoder, report, taken_s))
    if not taken_s:
        return None
    frame_s = np.array(taken_s)
    motion = motion_per_frame(changes, frame_s)
    return sync_from_motion(frame_s, motion, recording.imu, search_s=WHOLE_SEARCH_S if is_imported else LIVE_SEARCH_S)


def _sound_pictures(
    clip: Clip, decoder: JpegDecoder, report: Report, taken_s: list[float]
) -> Iterator[NDArray[np.uint8]]:
    """One by one those of the first one's size, with the time of each put into `taken_s`."""
    count, size = len(clip.pictures), QSize()
    for number in range(count):
        report(number / count, "")
        with suppress(OSError):  # a damaged frame
            picture = decoder.decoded(clip.pictures.jpeg(number), ROOM)
            if not picture.isNull() and size in (QSize(), picture.size()):
                size = picture.size()
                taken_s.append(clip.stamped_s[number])
                yield _grey(picture)


def _grey(picture: QImage) -> NDArray[np.uint8]:
    image = picture.convertToFormat(QImage.Format.Format_Grayscale8)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : image.width()].copy()
