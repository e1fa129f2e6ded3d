"""What befell a camera, in two sentences."""

from app.wording.translation import filled, tr
from devices.cameras.camera import CameraLostError


def camera_gone_words(error: CameraLostError, *, is_recording: bool) -> tuple[str, str]:
    """What happened to it, and what to do; amid a walk that this one is recorded without it."""
    what, remedy = f"{filled(error.what, error.values)}.", f"{filled(error.remedy, error.values)}."
    if is_recording:
        remedy = " ".join([tr("The walk goes on without video."), remedy])
    return what, remedy
