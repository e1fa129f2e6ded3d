"""What follows when a clinic's stations are set up, copied or given up in the settings."""

import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.home.login.controller import ADMINISTRATOR
from app.home.settings.clinic_cards import StationView
from app.home.settings.settings_page import SettingsPage
from app.storage.clinic.handing_over import count_waiting
from app.storage.clinic.moving import BEFORE, bring_back
from app.storage.clinic.station import shown_address
from app.storage.opened import OpenedLibrary
from app.system.progress import Report
from app.widgets.folder_dialog import ask_for_folder
from app.wording.translation import tr, tr_n
from app.workers.library_controller import LibraryController
from app.workers.library_state import OpenedState

if TYPE_CHECKING:
    from app.storage.clinic.moving import Moved

MASKED = ":***@"  # where a password is
VIEWER = "viewer"  # as app.storage.stored has it


class ClinicSettings(QObject):
    """Fills the two cards of the settings' page, and does what they ask for."""

    moved = Signal(object)  # OpenedState: the library is at a clinic's server now, or no longer

    def __init__(self, controller: LibraryController, page: SettingsPage) -> None:
        super().__init__(page)
        self._controller, self._page = controller, page
        self._is_station = False
        self._copied_to = Path()
        station, more = page.station, page.more_stations
        station.copy_requested.connect(self._on_copy_requested)
        station.stop_requested.connect(self._on_stop_requested)
        station.back_requested.connect(self._on_back_requested)
        more.move_requested.connect(self._on_move_requested)
        more.choose.clicked.connect(self._on_place_requested)

    def show_library(self, state: OpenedState) -> None:
        """Show what the operator who is logged in may do with the library that was opened."""
        self._is_station = state.library.shared is not None
        role = state.operator.role.value
        self._page.station.show_may(may_copy=role != VIEWER, may_bring_back=role == ADMINISTRATOR)
        self._page.station.show_copy("")
        self._page.station.show_back("")
        self._page.more_stations.show_move("")
        station, shared = state.library.library.station, state.library.shared
        if station is not None and shared is not None:
            self._page.station.show_station(StationView(_shown(station.database), shared.place))
            self.read_waiting()

    def read_waiting(self) -> None:
        """Show how many recordings wait at this station by now."""
        if self._is_station:
            self._controller.run(_view_of, self._on_view, self._on_waiting_unknown, self)

    def copy_into(self, folder: str) -> None:
        """Make a library of its own of the clinic's, in a new folder in this one."""
        self._copied_to = copied_to = Path(folder) / f"gaitwright {datetime.datetime.now():%Y-%m-%d %H-%M-%S}"

        def work(opened: OpenedLibrary, report: Report) -> "Moved":
            return bring_back(opened, copied_to, report, is_copy=True)

        self._page.station.show_copy(tr("Copying"), is_running=True)
        self._controller.run_long(work, self._on_copied, self._on_copy_refused, self._on_copy_progressed, self)

    def _on_view(self, view: StationView | None) -> None:
        if view is not None:
            self._page.station.show_station(view)

    def _on_waiting_unknown(self, _what: str, _remedy: str) -> None:
        """That the server does not answer is stated already."""

    def _on_copy_requested(self) -> None:
        ask_for_folder(self._page, tr("Choose where to save the copy"), self.copy_into)

    def _on_copy_progressed(self, share: float, _what: str) -> None:
        sentence = tr("Copying, {percent} %").format(percent=round(share * 100))
        self._page.station.show_copy(sentence, is_running=True)

    def _on_copied(self, moved: "Moved") -> None:
        stated = tr("{what} were copied to {folder}. The same passphrases open the copy.")
        self._page.station.show_copy(stated.format(what=_counted(moved), folder=self._copied_to))

    def _on_copy_refused(self, what: str, remedy: str) -> None:
        self._page.station.show_copy(f"{what} {remedy}")

    def _on_stop_requested(self) -> None:
        self._page.station.show_copy(tr("Stopping"))
        self._controller.stop_long(self._on_stopped)

    def _on_stopped(self, is_done: bool) -> None:
        stopped, done = tr("Stopped. There is no copy."), tr("The copy finished before it could be stopped.")
        self._page.station.show_copy(done if is_done else stopped)

    def _on_move_requested(self, address: str, password: str, place: str) -> None:
        if "://" not in place and not Path(place).is_absolute():
            sentence = tr("Enter the full folder path, or s3://bucket/folder.")
            self._page.more_stations.server.refuse(sentence, is_place=True)
            return
        self._page.more_stations.show_move(tr("Moving"), is_running=True)
        self._controller.reopen(
            lambda holder, report: holder.move_to_server(address, password, place, report),
            self._on_moved,
            self._on_move_refused,
            self._on_move_progressed,
            self,
        )

    def _on_place_requested(self) -> None:
        ask_for_folder(
            self._page, tr("Choose a folder that all workstations reach"), self._page.more_stations.show_place
        )

    def _on_move_progressed(self, share: float, _what: str) -> None:
        sentence = tr("Moving, {percent} %").format(percent=round(share * 100))
        self._page.more_stations.show_move(sentence, is_running=True)

    def _on_moved(self, moved: "Moved") -> None:
        self._show_moved()
        stated = tr(
            "{what} are now on the clinic's server, checked row by row. Other workstations can join now. "
            "The previous library is kept as {file}. Remove that file once you are sure that nothing is "
            "missing."
        )
        self._page.station.show_copy(stated.format(what=_counted(moved), file=BEFORE))

    def _on_move_refused(self, what: str, remedy: str) -> None:
        self._page.more_stations.refuse(f"{what} {remedy}")

    def _on_back_requested(self) -> None:
        self._page.station.show_back(tr("Moving back"), is_running=True)
        self._controller.reopen(
            lambda holder, report: holder.bring_back(report),
            self._on_back,
            self._on_back_refused,
            self._on_back_progressed,
            self,
        )

    def _on_back_progressed(self, share: float, _what: str) -> None:
        sentence = tr("Moving back, {percent} %").format(percent=round(share * 100))
        self._page.station.show_back(sentence, is_running=True)

    def _on_back(self, moved: "Moved") -> None:
        self._show_moved()
        stated = tr(
            "{what} are on this computer again. The library on the server is closed to all workstations. "
            "Once you are sure that nothing is missing, have its database and recordings removed there."
        )
        self._page.more_stations.show_move(stated.format(what=_counted(moved)))

    def _on_back_refused(self, what: str, remedy: str) -> None:
        self._page.station.show_back(f"{what} {remedy}")

    def _show_moved(self) -> None:
        if (state := self._controller.state) is not None:
            self.moved.emit(state)


def _view_of(opened: OpenedLibrary) -> StationView | None:
    station, shared = opened.library.station, opened.shared
    if station is None or shared is None:  # it was brought back meanwhile
        return None
    return StationView(_shown(station.database), shared.place, count_waiting(opened))


def _shown(address: str) -> str:
    return shown_address(address).replace(MASKED, "@")


def _counted(moved: "Moved") -> str:
    """How much was taken along, in words."""
    patients = tr_n("{count} patient", "{count} patients", moved.patients).format(count=moved.patients)
    sessions = tr_n("{count} session", "{count} sessions", moved.sessions).format(count=moved.sessions)
    recordings = tr_n("{count} recording", "{count} recordings", moved.recordings).format(count=moved.recordings)
    return tr("{patients}, {sessions} and {recordings}").format(
        patients=patients, sessions=sessions, recordings=recordings
    )
