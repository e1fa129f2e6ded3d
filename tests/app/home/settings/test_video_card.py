"""Tests that how long videos are kept, and whether backups hold them, is kept in the library and used."""

from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.home.settings.video_card import VideoCard
from app.home.settings.video_control import VideoControl, are_in_backups
from app.storage.opened import OpenedLibrary
from app.storage.videos.retention import video_days
from app.workers.library_controller import LibraryController
from tests.app.library_answers import asked


def kept(qtbot: QtBot, controller: LibraryController) -> object:
    def read(opened: OpenedLibrary) -> tuple[int, bool]:
        return video_days(opened), are_in_backups(opened)

    return asked(qtbot, controller, read)


def test_what_is_chosen_is_kept_and_shown_again(qtbot: QtBot, home: Home, controller: LibraryController) -> None:
    card = home.settings.page.video
    assert kept(qtbot, controller) == (365, False)
    assert (card.days.choice, card.in_backups.isChecked()) == ("365", False)
    for key, days in (("90", 90), ("0", 0), ("365", 365), ("90", 90)):
        next(one for one in card.days.segments if one.accessibleName().startswith(WORDS[key])).click()
        assert kept(qtbot, controller) == (days, False)
    card.in_backups.click()
    assert kept(qtbot, controller) == (90, True)
    again = VideoCard()
    qtbot.addWidget(again)
    VideoControl(controller, again).read()
    kept(qtbot, controller)
    assert (again.days.choice, again.in_backups.isChecked()) == ("90", True)


WORDS = {"90": "90 days", "365": "1 year", "0": "As long as"}
