"""What befell a camera, in two sentences, and what is asked before a consent to video is withdrawn."""

from app.wording.translation import filled, tr
from devices.cameras.camera import CameraLostError


def camera_gone_words(error: CameraLostError, *, is_recording: bool) -> tuple[str, str]:
    """What happened to it, and what to do; amid a walk that this one is recorded without it."""
    what, remedy = f"{filled(error.what, error.values)}.", f"{filled(error.remedy, error.values)}."
    if is_recording:
        remedy = " ".join([tr("The walk goes on without video."), remedy])
    return what, remedy


def withdrawal_words() -> tuple[str, tuple[str, str], str]:
    """The question, what follows, and the answer that does it."""
    follows = (
        tr("All videos of this patient are destroyed at once. The measurements stay."),
        tr("Backups with videos keep them for up to 90 days, the latest one until the next is made."),
    )
    return tr("Withdraw the consent to video?"), follows, tr("Withdraw consent")
