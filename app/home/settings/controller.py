"""What follows when something is set: on the screen at once, in the library through its controller."""

import datetime
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from app.editing.words import by_words
from app.home.login.controller import ADMINISTRATOR, SHORTEST
from app.home.login.recovery_key_sheet import KeySheet
from app.home.settings.clinic import ClinicSettings
from app.home.settings.error_report import ErrorReport
from app.home.settings.live_output_control import LiveOutputControl
from app.home.settings.operators_card import OperatorLine
from app.home.settings.settings_page import DeletedLine, SettingsPage
from app.home.settings.video_control import VideoControl, are_in_backups
from app.storage.audit import about
from app.storage.backup import back_up
from app.storage.keys import KeyRefusedError, KeySlots
from app.storage.opened import slots_of
from app.storage.operators import CLINIC
from app.storage.stored import KEPT_DELETED, Operator, Role
from app.system.allowed_drivers import allow_drivers, driver_packages
from app.system.progress import Report
from app.system.settings import Scheme, Settings
from app.theme.current import current_theme
from app.widgets.folder_dialog import ask_for_folder
from app.wording.dates import date
from app.wording.patients import person, when
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from app.workers.library_opening import BACKUP_FOLDER
from app.workers.library_state import OpenedState

if TYPE_CHECKING:
    from app.storage.backup import Backup
    from app.storage.key_change import ChangedKey
    from app.storage.opened import OpenedLibrary
HASH_LETTERS = 16  # of an entry's hash: as much as anybody compares
VIEWER, CLINICIAN = "viewer", "clinician"  # as app.storage.stored has them


class SettingsController(QObject):
    reported = Signal(str, str)
    restored = Signal()  # something that was deleted
    moved = Signal(object)  # OpenedState: the library is at a clinic's server now, or no longer

    def __init__(self, controller: LibraryController, settings: Settings, parent: QWidget) -> None:
        super().__init__(parent)
        self._controller, self._settings = controller, settings
        self._state: OpenedState | None = None
        self._backup_folder = ""
        self.page = SettingsPage(SHORTEST, tuple(_roles().items()))
        self._clinic = ClinicSettings(controller, self.page)
        self._clinic.moved.connect(self._on_moved)
        self._sheet = KeySheet(self.page)
        self._sheet.reported.connect(self.reported)
        self._error_report = ErrorReport(self.page)
        self._error_report.reported.connect(self.reported)
        self._error_report.written.connect(self.page.show_error_report)
        self._live_output = LiveOutputControl(settings, self.page.live_output)
        self._video = VideoControl(controller, self.page.video)
        self._show_screen()
        self._connect()

    def show_library(self, state: OpenedState) -> None:
        """Show what the operator who is logged in may set."""
        self._state = state
        # what a station works with without its server has the clinic's keys and operators
        is_own = not state.is_demonstration and not state.is_away
        # a clinic's server is backed up there, with its own tools
        may_back_up = is_own and state.operator.role.value != VIEWER and state.library.shared is None
        is_administrator = is_own and state.operator.role.value == ADMINISTRATOR
        may_restore = state.operator.role.value != VIEWER
        self.page.show_library(
            has_access=is_own,
            has_backup=may_back_up,
            has_deleted=may_restore,
            has_operators=is_administrator,
            is_station=state.library.shared is not None,
            may_move=is_administrator and state.library.shared is None,
            own=(state.operator.code, state.operator.name),
        )
        self.page.renew.setVisible(is_administrator)
        self.page.choose_folder.setVisible(is_administrator)
        self._clinic.show_library(state)
        self._show_screen()
        self._on_backup_folder_read("")  # the one in sight is another library's
        if is_own:
            self._controller.run(_backup_folder_of, self._on_backup_folder_read, self._on_refused, self)
            # no passphrase holds its name
            self._controller.run(_clinic_of, self.page.show_clinic, self._on_refused, self)
        if may_back_up:
            self._video.read()
        if is_administrator:
            self._read_operators()

    def read_deleted(self) -> None:
        """Show what can be had back now."""
        self._controller.run(_deleted_in, self.page.show_deleted, self._on_refused, self)

    def read(self) -> None:
        """Show what may have changed since the settings were looked at last."""
        self.read_deleted()
        self._live_output.show()
        self._clinic.read_waiting()
        self.page.drivers.show_packages(driver_packages())

    def _on_moved(self, state: OpenedState) -> None:
        self.show_library(state)
        self.moved.emit(state)

    def _on_restore_requested(self, row_id: UUID, is_patient: bool) -> None:
        def restore(opened: "OpenedLibrary") -> None:
            if is_patient:
                opened.library.patients.restore(opened.library.patients.get(row_id))
            else:
                opened.library.sessions.restore(opened.library.sessions.get(row_id))

        self._controller.run(restore, self._on_restored, self._on_refused, self)

    def _on_restored(self, _nothing: object) -> None:
        self.read_deleted()
        self.restored.emit()

    def _connect(self) -> None:
        page = self.page
        page.language.chosen.connect(self._on_language_chosen)
        page.scheme.chosen.connect(self._on_scheme_chosen)
        page.scale_chosen.connect(self._on_scale_chosen)
        page.side_chosen.connect(self._on_side_chosen)
        page.motion_chosen.connect(self._on_motion_chosen)
        page.sound.toggled.connect(self._on_sound_chosen)
        page.prompts.toggled.connect(self._on_prompts_chosen)
        page.passphrase_requested.connect(self._on_passphrase_requested)
        page.renew.clicked.connect(self._on_recovery_key_requested)
        page.print_requested.connect(self._on_print_requested)
        page.save_requested.connect(self._on_save_requested)
        page.backup_requested.connect(self._on_backup_requested)
        page.choose_folder.clicked.connect(self._on_backup_folder_requested)
        page.stop_requested.connect(self._on_stop_requested)
        page.report_error.clicked.connect(self._error_report.save)
        page.operators.added.connect(self._on_operator_added)
        page.operators.removed.connect(self._on_operator_removed)
        page.clinic_named.connect(self._on_clinic_named)
        page.restore_requested.connect(self._on_restore_requested)
        page.drivers.allowed.connect(self._on_drivers_allowed)
        self._settings.changed.connect(self._show_screen)

    def _show_screen(self) -> None:
        kept = self._settings
        self.page.show_screen(
            kept.language,
            kept.scheme,
            current_theme().scale,
            is_from_behind=kept.is_from_behind,
            has_sound=kept.has_sound,
            has_prompts=kept.has_prompts,
            has_less_motion=kept.has_less_motion,
        )

    def _on_language_chosen(self, language: str) -> None:
        self._settings.language = language

    def _on_scheme_chosen(self, scheme: str) -> None:
        self._settings.scheme = Scheme(scheme)

    def _on_scale_chosen(self, scale: float) -> None:
        self._settings.scale = scale

    def _on_side_chosen(self, is_from_behind: bool) -> None:
        self._settings.is_from_behind = is_from_behind

    def _on_motion_chosen(self, has_less_motion: bool) -> None:
        self._settings.has_less_motion = has_less_motion

    def _on_sound_chosen(self, has_sound: bool) -> None:
        self._settings.has_sound = has_sound

    def _on_prompts_chosen(self, has_prompts: bool) -> None:
        self._settings.has_prompts = has_prompts

    def _on_drivers_allowed(self, package: str, version: str, is_allowed: bool) -> None:
        try:
            allow_drivers(package, version, is_allowed=is_allowed)
        except OSError as problem:
            what = tr("This setting was not saved ({why}).").format(why=problem.strerror)
            self.reported.emit(what, tr("Free some space on the disk, then set it again."))
            self.page.drivers.show_packages(driver_packages())

    def _on_passphrase_requested(self, old: str, new: str) -> None:
        def change(opened: "OpenedLibrary") -> None:
            slots, operator = _slots(opened), opened.library.operator
            assert operator is not None  # whoever opens a library is logged in
            known = (operator.name, _clinic_of(opened))
            slots.set_passphrase(slots.open(operator.code, old), operator.code, new, known)

        self._controller.run(change, self._on_passphrase_changed, self._on_passphrase_refused, self)

    def _on_passphrase_changed(self, _nothing: object) -> None:
        self.page.show_passphrase_changed()

    def _on_passphrase_refused(self, what: str, remedy: str) -> None:
        self.page.refuse_passphrase(f"{what} {remedy}")

    def _on_recovery_key_requested(self) -> None:
        def renew(opened: "OpenedLibrary") -> str:
            assert opened.data_key is not None  # hidden in the demonstration
            return _slots(opened).renew_recovery_key(opened.data_key)

        self._controller.run(renew, self.page.show_recovery_key, self._on_refused, self)

    def _on_backup_folder_read(self, folder: str) -> None:
        self._backup_folder = folder
        self.page.show_backup("", folder)

    def _on_backup_folder_requested(self) -> None:
        ask_for_folder(self.page, tr("Choose the folder for backups"), self.set_backup_folder)

    def set_backup_folder(self, folder: str) -> None:
        """Let backups go to this folder from now on."""

        def put(opened: "OpenedLibrary") -> str:
            opened.library.settings.put(BACKUP_FOLDER, folder)
            return folder

        self._controller.run(put, self._on_backup_folder_read, self._on_refused, self)

    def _on_backup_requested(self) -> None:
        if not self._backup_folder:
            self._on_backup_folder_requested()
            return
        into = Path(self._backup_folder)

        def work(opened: "OpenedLibrary", report: Report) -> "Backup":
            return back_up(opened, into, report, with_videos=are_in_backups(opened))

        self.page.show_backup(tr("Backing up"), self._backup_folder, is_running=True)
        self._controller.run_long(work, self._on_backed_up, self._on_backup_refused, self._on_backup_progressed, self)

    def _on_backup_progressed(self, share: float, _what: str) -> None:
        sentence = tr("Backing up, {percent} %").format(percent=round(share * 100))
        self.page.show_backup(sentence, self._backup_folder, is_running=True)

    def _on_backed_up(self, backup: "Backup") -> None:
        size = f"{backup.bytes / 1e6:.0f}"
        sentence = tr("Backed up and checked: {files} files, {size} MB.").format(files=backup.files, size=size)
        end = backup.checkpoint
        if backup.faults:
            count = len(backup.faults)
            sentence = tr(
                "The library is backed up. {count} of its recordings were already missing or damaged."
            ).format(count=count)
        kept = tr(
            "The backup's audit log ends with entry {number}, {hash}. Note both to check later whether "
            "any entry is missing."
        )
        sentence = f"{sentence} {kept.format(number=end.number, hash=end.hash[:HASH_LETTERS])}"
        self.page.show_backup(sentence, self._backup_folder)

    def _on_backup_refused(self, what: str, remedy: str) -> None:
        self.page.show_backup(f"{what} {remedy}", self._backup_folder)

    def _on_stop_requested(self) -> None:
        self._controller.stop_long(self._on_backup_stopped)
        self.page.show_backup(tr("Stopping"), self._backup_folder)

    def _on_backup_stopped(self, is_done: bool) -> None:
        stopped, done = tr("Stopped. There is no new backup."), tr("The backup finished before it could be stopped.")
        self.page.show_backup(done if is_done else stopped, self._backup_folder)

    def _on_clinic_named(self, name: str) -> None:
        def put(opened: "OpenedLibrary") -> None:
            if opened.library.settings.get(CLINIC, "") != name:
                opened.library.settings.put(CLINIC, name)

        self._controller.run(put, None, self._on_refused, self)

    def _read_operators(self) -> None:
        self._controller.run(_operators_of, self._on_operators, self._on_refused, self)

    def _on_operators(self, found: tuple[tuple[Operator, ...], tuple[str, ...]]) -> None:
        operators, codes = found
        if self._state is None:
            return
        own, roles = self._state.operator.code, _roles()
        self.page.operators.show_operators(
            [
                OperatorLine(
                    one.code, one.name, roles[one.role.value], one.is_active, one.code == own, one.code in codes
                )
                for one in operators
            ]
        )

    def _on_print_requested(self, key: str) -> None:
        if self._state is not None:
            self._sheet.print(key, self._state.library.folder)

    def _on_save_requested(self, key: str) -> None:
        if self._state is not None:
            self._sheet.save(key, self._state.library.folder)

    def _on_operator_added(self, code: str, name: str, role: str, passphrase: str) -> None:
        def add(opened: "OpenedLibrary") -> None:
            assert opened.data_key is not None  # hidden in the demonstration
            slots = _slots(opened)
            # the slot first: without one an operator could not log in
            slots.add(opened.data_key, code, passphrase, (name, _clinic_of(opened)), is_given=True)
            try:
                operators = opened.library.operators
                known = next((one for one in operators.list() if one.code == code.casefold()), None)
                if known is None:
                    operators.add(Operator(code, name, Role(role)))
                else:  # who worked here before and has had no key since
                    operators.change(replace(known, name=name, role=Role(role), is_active=True))
            except Exception:
                with suppress(KeyRefusedError):
                    slots.remove(code)
                raise

        self._controller.run(add, self._on_operator_changed, self._on_operator_refused, self)

    def _on_operator_removed(self, code: str) -> None:
        self.page.operators.show_key_change(tr("Changing the library's key"), is_running=True)
        self._controller.reopen(
            lambda holder, report: holder.change_key(code, report),
            self._on_key_changed,
            self._on_key_refused,
            self._on_key_progressed,
            self,
        )

    def _on_key_progressed(self, share: float, _what: str) -> None:
        sentence = tr("Changing the library's key, {percent} %").format(percent=round(share * 100))
        self.page.operators.show_key_change(sentence, is_running=True)

    def _on_key_changed(self, changed: "ChangedKey") -> None:
        stated = [tr("The library has a new key. Earlier backups keep the old key. Make a new backup now.")]
        if changed.left_out:
            stated.append(
                tr(
                    "These users have not logged in for long and need a new passphrase. Add them below: {codes}."
                ).format(codes=", ".join(changed.left_out))
            )
        if changed.recovery_key:
            stated.append(tr("The recovery key is new and shown above."))
            self.page.show_recovery_key(changed.recovery_key)
        self.page.operators.show_key_change(" ".join(stated), is_running=False)
        self._read_operators()

    def _on_key_refused(self, what: str, remedy: str) -> None:
        self.page.operators.show_key_change(f"{what} {remedy}", is_running=False)
        self._read_operators()

    def _on_operator_changed(self, _nothing: object) -> None:
        self.page.forget_typed()
        self._read_operators()

    def _on_operator_refused(self, what: str, remedy: str) -> None:
        self.page.operators.refuse(f"{what} {remedy}")

    def _on_refused(self, what: str, remedy: str) -> None:
        self.reported.emit(what, remedy)


def _operators_of(opened: "OpenedLibrary") -> tuple[tuple[Operator, ...], tuple[str, ...]]:
    """Who is known here, and who has a key."""
    return opened.library.operators.list(), _slots(opened).codes


def _clinic_of(opened: "OpenedLibrary") -> str:
    return str(opened.library.settings.get(CLINIC, ""))


def _backup_folder_of(opened: "OpenedLibrary") -> str:
    return str(opened.library.settings.get(BACKUP_FOLDER, ""))


def _deleted_in(opened: "OpenedLibrary") -> tuple[DeletedLine, ...]:
    now = datetime.datetime.now().astimezone()
    patients = opened.library.patients.search(is_deleted=True)
    sessions = opened.library.sessions.list(is_deleted=True)
    subjects = [about("patient", one.id) for one in patients] + [about("session", one.id) for one in sessions]
    by = {subject: entry.operator for subject, entry in opened.library.audit.deletions(subjects).items()}

    def details(subject: str, at: datetime.datetime | None) -> str:
        if at is None:  # restored since it was listed
            return ""
        until = date((at + KEPT_DELETED).astimezone().date())
        who = by_words(by.get(subject, ""), at, now)
        return tr("Deleted by: {who}. Can be restored until {day}.").format(who=who, day=until)

    return (
        *(
            DeletedLine(
                one.id,
                ", ".join(filter(None, [one.details.code, person(one.details)])),
                True,
                details(about("patient", one.id), one.deleted_at),
            )
            for one in patients
        ),
        *(
            DeletedLine(
                one.id,
                f"{one.patient_code}, {when(one.started, now)}",
                False,
                details(about("session", one.id), one.deleted_at),
            )
            for one in sessions
        ),
    )


def _slots(opened: "OpenedLibrary") -> KeySlots:
    opened.refuse_gone()  # another library's keys may be in its place
    return slots_of(opened.folder)


def _roles() -> dict[str, str]:
    return {
        CLINICIAN: tr("clinician: record and view"),
        VIEWER: tr("viewer: view only"),
        ADMINISTRATOR: tr("administrator: full access, manage users"),
    }
