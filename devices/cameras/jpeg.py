"""Encode pictures as JPEGs, each by itself."""

from fractions import Fraction

from av.codec.context import CodecContext
from av.video.codeccontext import VideoCodecContext
from av.video.frame import VideoFrame

# of 2 (best) to 31: a room at 1280 x 720 takes about 55 KB, a patient's sole against the floor is still sharp
QUALITY = 4
TICK = Fraction(1, 30)  # of no meaning: the times go beside the pictures
PIXELS = "yuvj420p"  # JPEG's own range of brightness


class JpegEncoder:
    """Makes JPEGs of one size, whatever the size of the pictures."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        encoder = CodecContext.create("mjpeg", "w")
        assert isinstance(encoder, VideoCodecContext)
        encoder.width, encoder.height, encoder.pix_fmt = width, height, PIXELS
        encoder.time_base = TICK
        encoder.qmin = encoder.qmax = QUALITY
        encoder.thread_count = 1  # a frame at once; threads would hold some back
        self._encoder = encoder
        self._count = 0

    def encode(self, frame: VideoFrame) -> bytes:
        """The picture as a JPEG; what the frame holds of its time may be lost."""
        picture = frame.reformat(width=self.width, height=self.height, format=PIXELS)
        picture.pts, picture.time_base = self._count, TICK
        self._count += 1
        return b"".join(bytes(packet) for packet in self._encoder.encode(picture))


def fitted(width: int, height: int, most_width: int, most_height: int) -> tuple[int, int]:
    """The largest even size of the same shape within a limit; never larger than the picture."""
    scale = min(1.0, most_width / width, most_height / height)
    return max(2, 2 * round(width * scale / 2)), max(2, 2 * round(height * scale / 2))
