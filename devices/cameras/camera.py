"""A camera, how it is to take its frames, one frame of it, and why there are no more."""

from dataclasses import dataclass

V4L2, DSHOW, AVFOUNDATION = "v4l2", "dshow", "avfoundation"
TEST_PICTURE, FILE = "lavfi", "file"  # stand in for a camera: FFmpeg's test pictures, and a video at its own pace
STAND_INS = (TEST_PICTURE, FILE)
DEFAULT_WIDTH, DEFAULT_HEIGHT, DEFAULT_RATE_HZ = 1280, 720, 30.0


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """A camera: how it calls itself, where it is, and the input of FFmpeg that opens it there."""

    name: str
    place: str
    format: str


@dataclass(frozen=True, slots=True)
class CameraMode:
    """Size of the pictures in pixels, and how many are sent a second."""

    width: int = DEFAULT_WIDTH
    height: int = DEFAULT_HEIGHT
    rate_hz: float = DEFAULT_RATE_HZ


@dataclass(frozen=True, slots=True)
class CapturedFrame:
    """One picture.

    `number` counts every frame that the camera gave: a gap is frames that were left out. `arrival_ns` is of
    `devices.clocks.host_clock`, `pts_ns` of the camera's own clock; None where it has none.
    """

    number: int
    arrival_ns: int
    pts_ns: int | None
    jpeg: bytes


class CameraLostError(Exception):
    """A camera that cannot be used, or no more. States what is wrong and what to do, as `SourceRefusedError` does."""

    def __init__(self, what: str, remedy: str, **values: object) -> None:
        super().__init__(f"{what}. {remedy}.".format(**values) if values else f"{what}. {remedy}.")
        self.what, self.remedy, self.values = what, remedy, values
