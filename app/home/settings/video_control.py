"""What follows when something about videos is set: it is kept in the library."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Slot

from app.home.settings.video_card import VideoCard
from app.storage.videos.retention import VIDEO_DAYS, video_days
from app.workers.library_controller import LibraryController

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary

VIDEOS_IN_BACKUPS = "videos_in_backups"  # the library's setting


class VideoControl(QObject):
    def __init__(self, controller: LibraryController, card: VideoCard) -> None:
        super().__init__(card)
        self._controller, self._card = controller, card
        card.days_chosen.connect(self._on_days_chosen)
        card.in_backups.toggled.connect(self._on_in_backups_toggled)

    def read(self) -> None:
        """Show what is set in the library that is open."""
        self._controller.run(_settings_of, self._on_read, None, self)

    def _on_read(self, kept: tuple[int, bool]) -> None:
        days, is_in_backups = kept
        self._card.show_settings(days, is_in_backups=is_in_backups)

    @Slot(int)
    def _on_days_chosen(self, days: int) -> None:
        self._put(VIDEO_DAYS, days)

    @Slot(bool)
    def _on_in_backups_toggled(self, is_on: bool) -> None:
        self._put(VIDEOS_IN_BACKUPS, is_on)

    def _put(self, name: str, value: int | bool) -> None:
        self._controller.run(lambda opened: opened.library.settings.put(name, value), None, None, self)


def _settings_of(opened: "OpenedLibrary") -> tuple[int, bool]:
    return video_days(opened), are_in_backups(opened)


def are_in_backups(opened: "OpenedLibrary") -> bool:
    """Whether backups are to hold the videos."""
    return opened.library.settings.get(VIDEOS_IN_BACKUPS, False) is True
