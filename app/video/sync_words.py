"""How well a clip and the samples have one time, in words."""

import math

from app.wording.translation import tr, tr_n
from core.video.clip import Clip


def frames_off(clip: Clip) -> int:
    """The standard deviation of the clip's times in whole frames, one at least."""
    assert clip.sync is not None
    return max(1, math.ceil(clip.sync.sd_s * clip.rate_hz - 1e-6))


def sync_in_words(clip: Clip) -> str:
    if clip.sync is None:
        return tr("Not synchronised")
    if not clip.is_synchronised:
        return tr("Not synchronised, computer's clock only")
    frames = frames_off(clip)
    return tr_n("Synchronised, ±{count} frame", "Synchronised, ±{count} frames", frames).format(count=frames)
