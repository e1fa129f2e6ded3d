"""How long videos are kept: shorter than what was measured, for they show faces.

A setting of the library states for how many days, 365 where nobody set it and as long as their session with 0. It is
counted as the thirty days of what was deleted are (`app.storage.retention`): a clock that is wrong destroys nothing.
"""

import datetime
from collections.abc import Callable

from app.storage.library import now_utc
from app.storage.opened import OpenedLibrary
from app.storage.retention import overdue_before
from app.storage.videos.destroying import destroy_all

VIDEO_DAYS = "video_days"  # the setting
USUAL_DAYS = 365


def video_days(opened: OpenedLibrary) -> int:
    """For how many days videos are kept; 0: as long as their session; raises LibraryError."""
    found = opened.library.settings.get(VIDEO_DAYS, USUAL_DAYS)
    return found if type(found) is int and found >= 0 else USUAL_DAYS


def destroy_overdue_clips(opened: OpenedLibrary, now: Callable[[], datetime.datetime] = now_utc) -> int:
    """Destroy the videos whose days are over, at every start; how many; raises LibraryError or OSError."""
    days = video_days(opened)
    before = overdue_before(opened, now(), datetime.timedelta(days)) if days else None
    clips = opened.library.clips.made_before(before) if before is not None else ()
    return destroy_all(opened, [clip.id for clip in clips])
