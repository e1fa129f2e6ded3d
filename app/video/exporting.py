"""Write a clip as a file that any player shows: WebM, with the faces in it or with the upper third blurred."""

from errno import EIO
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QImage, QPainter

from app.storage.files import replacing
from app.system.progress import Report
from core.video.clip import Clip

BLURRED_SHARE = 1 / 3  # of the height, from above: where a face is while somebody walks upright
BLOCKS = 12  # so many squares are left of the width
BITS_A_PIXEL = 0.12
MILLISECOND = Fraction(1, 1000)


def write_video(clip: Clip, path: Path, *, is_blurred: bool, report: Report) -> None:
    """Write `path`, whole or not at all; a damaged frame is left out. Raises OSError, ModuleNotFoundError (PyAV)."""
    import av  # an extra, and only for this

    with replacing(path) as file, av.open(file, "w", format="webm") as container:
        stream = container.add_stream("libvpx-vp9", rate=max(1, round(clip.rate_hz)))
        stream.width, stream.height, stream.pix_fmt = clip.width // 2 * 2, clip.height // 2 * 2, "yuv420p"
        stream.bit_rate = round(BITS_A_PIXEL * clip.width * clip.height * clip.rate_hz)
        stream.codec_context.time_base = MILLISECOND  # else times are rounded to whole frames
        stream.options = {"deadline": "realtime", "cpu-used": "6", "row-mt": "1"}
        begin_s, last_ms = float(clip.time_s[0]), -1
        for number in range(len(clip.pictures)):
            report(number / len(clip.pictures), "")
            try:
                image = QImage.fromData(clip.pictures.jpeg(number))
            except OSError as error:
                if error.errno == EIO:  # this picture alone
                    continue
                raise
            time_ms = round((float(clip.time_s[number]) - begin_s) * 1000)
            if image.isNull() or time_ms <= last_ms:
                continue
            if is_blurred:
                blur_upper_part(image)
            whole = image.scaled(stream.width, stream.height)  # of a camera that was slowed down they are smaller
            frame = av.VideoFrame.from_ndarray(_rgb(whole), "rgb24")
            frame.pts, frame.time_base, last_ms = time_ms, MILLISECOND, time_ms
            container.mux(stream.encode(frame))
        if last_ms < 0:
            raise OSError(EIO, "no picture of this video can be read")
        container.mux(stream.encode(None))


def blur_upper_part(image: QImage) -> None:
    """Leave so few squares of the upper third that nobody is recognised there."""
    upper = QRect(0, 0, image.width(), round(image.height() * BLURRED_SHARE))
    few = image.copy(upper).scaled(
        BLOCKS,
        max(1, round(BLOCKS * upper.height() / upper.width())),
        Qt.AspectRatioMode.IgnoreAspectRatio,
        Qt.TransformationMode.SmoothTransformation,
    )
    painter = QPainter(image)
    painter.drawImage(upper, few)
    painter.end()


def _rgb(image: QImage) -> NDArray[np.uint8]:
    converted = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(converted.constBits(), np.uint8).reshape(converted.height(), converted.bytesPerLine())
    return rows[:, : 3 * converted.width()].reshape(converted.height(), converted.width(), 3).copy()
