"""Why a camera gives no frames, and what is stated of it then."""

from devices.cameras.camera import CameraInfo, CameraLostError

ABSENT, BUSY, DENIED, UNUSABLE, GONE = "absent", "busy", "denied", "unusable", "gone"
SILENT, CRASHED, MISSING = "silent", "crashed", "missing"


def missing_library() -> CameraLostError:
    """The refusal where no camera can be opened at all."""
    return CameraLostError("Cameras cannot be used: a software library is missing", "Install gaitwright[video]")


def lost(cause: str, info: CameraInfo) -> CameraLostError:
    """The refusal for a cause; one that is not known is taken for a crash."""
    camera = info.name
    if cause == MISSING:
        return missing_library()
    stated = {
        ABSENT: CameraLostError(
            "{camera} is not connected", "Check its cable, then search for cameras again", camera=camera
        ),
        BUSY: CameraLostError(
            "{camera} does not start; another program may be using it",
            "Close the other program, then start the camera again",
            camera=camera,
        ),
        DENIED: CameraLostError(
            "This computer does not let Gaitwright use {camera}",
            "Allow it in the computer's settings for cameras",
            camera=camera,
        ),
        UNUSABLE: CameraLostError("{camera} sends no usable pictures", "Choose another camera", camera=camera),
        GONE: CameraLostError(
            "{camera} was disconnected", "Check its cable, then start the camera again", camera=camera
        ),
        SILENT: CameraLostError(
            "{camera} sends no pictures", "Check its cable, then start the camera again", camera=camera
        ),
    }
    if cause in stated:
        return stated[cause]
    return CameraLostError("Recording from {camera} stopped early", "Start the camera again", camera=camera)
