"""What can be set: how everything looks and sounds, what opens the library, its second copy, who works with it."""

from collections.abc import Sequence
from dataclasses import dataclass
from uuid import UUID

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.home.settings.clinic_cards import MoreStationsCard, StationCard
from app.home.settings.drivers_card import DriversCard
from app.home.settings.live_output_card import LiveOutputCard
from app.home.settings.operators_card import OperatorsCard
from app.home.settings.settings_card import SettingsCard
from app.home.settings.video_card import VideoCard
from app.system.passphrases import REFUSED, strength_in_words, strength_of
from app.theme.current import SCALES, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.choice import Choice
from app.widgets.field import Field
from app.widgets.lay_out import lay_out
from app.widgets.segmented import Segmented
from app.widgets.tall_page import TallPage
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wording.translation import LANGUAGES, languages, tr

COLUMN = 720
FRONT, BEHIND = "front", "behind"
AS_SYSTEM, LESS_MOTION = "system", "less"


@dataclass(frozen=True, slots=True)
class DeletedLine:
    """What was deleted and can still be had back: a patient with all sessions, or one session.

    `details`: by whom and when, and until when it can be had back.
    """

    id: UUID
    words: str
    is_patient: bool
    details: str = ""


class SettingsPage(TallPage):
    """The parts about a library are hidden where they mean nothing: in the demonstration, and for who may not."""

    scale_chosen = Signal(float)
    side_chosen = Signal(bool)  # from behind
    motion_chosen = Signal(bool)  # less
    passphrase_requested = Signal(str, str)  # old, new
    print_requested = Signal(str)
    save_requested = Signal(str)
    backup_requested = Signal()
    stop_requested = Signal()
    clinic_named = Signal(str)
    restore_requested = Signal(object, bool)  # id, whether it is a patient's

    def __init__(self, shortest: int, roles: Sequence[tuple[str, str]]) -> None:
        super().__init__()
        self._shortest = shortest
        self._own: tuple[str, ...] = ()
        self._title = Text(tr("Settings"), size=26, weight=SEMIBOLD)
        lay_out(self.column, self._title, margins=(24, 16, 24, 20), spacing=16)
        self._build_screen()
        self.live_output = LiveOutputCard()
        self.column.addWidget(self.live_output)
        self._build_access()
        self._build_backup()
        self.video = VideoCard()
        self.column.addWidget(self.video)
        self.station = StationCard()
        self.more_stations = MoreStationsCard()
        lay_out(self.column, self.station, self.more_stations)
        self._build_deleted()
        self._build_clinic()
        self.operators = OperatorsCard(shortest, roles, self.clinic)
        self.column.addWidget(self.operators)
        self.drivers = DriversCard()
        self.column.addWidget(self.drivers)
        self._build_trouble()
        self.column.addStretch(1)
        self._connect()
        scaled(self.setMaximumWidth, COLUMN + 48)
        scaled(self.deleted_rows.setSpacing, 4)

    @property
    def tab_order(self) -> list[QWidget]:
        return [
            *self.language.segments,
            *self.scheme.segments,
            self.scale,
            *self.side.segments,
            *self.motion.segments,
            self.sound,
            self.prompts,
            *self.live_output.tab_order,
            *(field.line_edit for field in (self.old, self.new, self.again)),
            self.change,
            self.renew,
            self.back_up,
            self.choose_folder,
            *self.video.tab_order,
            *self.station.tab_order,
            *self.more_stations.tab_order,
            *self.drivers.toggles,
            self.report_error,
        ]

    def focus(self) -> None:
        self.language.focus()

    def show_screen(
        self,
        language: str,
        scheme: str,
        scale: float,
        *,
        is_from_behind: bool,
        has_sound: bool,
        has_prompts: bool,
        has_less_motion: bool,
    ) -> None:
        self.language.choose(language)
        self.scheme.choose(scheme)
        nearest = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - scale))
        self.scale.setCurrentIndex(nearest)
        self.side.choose(BEHIND if is_from_behind else FRONT)
        self.motion.choose(LESS_MOTION if has_less_motion else AS_SYSTEM)
        self.sound.setChecked(has_sound)
        self.prompts.setChecked(has_prompts)

    def show_library(
        self,
        *,
        has_access: bool,
        has_backup: bool,
        has_operators: bool,
        has_deleted: bool = False,
        is_station: bool = False,
        may_move: bool = False,
        own: tuple[str, ...] = (),
    ) -> None:
        """Show what the operator may set, whose code and name are `own`; nothing typed for another is kept."""
        self._own = own
        self.access_card.setVisible(has_access)
        self.backup_card.setVisible(has_backup)
        self.video.setVisible(has_backup)
        self.deleted_card.setVisible(has_deleted)
        self.station.setVisible(is_station)
        self.more_stations.setVisible(may_move)
        self._clinic.setVisible(has_operators)
        self.operators.setVisible(has_operators)
        self.forget_typed()
        self.show_recovery_key("")

    def forget_typed(self) -> None:
        for field in self._fields:
            field.set_text("")
            field.set_wrong("")
        self.operators.forget_typed()
        self.more_stations.server.forget_typed()
        self._stated.setText("")
        self._strength.setText(strength_in_words("", self._shortest))

    def show_passphrase_changed(self) -> None:
        self.forget_typed()
        self._stated.setText(tr("Passphrase changed. The old passphrase opens only earlier backups."))

    def refuse_passphrase(self, sentence: str) -> None:
        self.old.set_wrong(sentence)
        self.old.setFocus()

    def show_recovery_key(self, key: str) -> None:
        """Show a new recovery key, until another page is shown."""
        self.recovery_key = key
        self._key_words.setText(key.replace("-", "  "))
        for part in (self._key_words, self._key_hint, self.print, self.save):
            part.setVisible(bool(key))

    def show_clinic(self, name: str) -> None:
        self.clinic.set_text(name)

    def show_deleted(self, lines: Sequence[DeletedLine]) -> None:
        """Show what can still be had back."""
        while (item := self.deleted_rows.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for line in lines:
            row = _DeletedRow(line)
            row.restored.connect(self.restore_requested)
            self.deleted_rows.addWidget(row)
        self.none_deleted.setVisible(not lines)

    def _build_screen(self) -> None:
        self.language = Segmented(tr("Language"), [(key, LANGUAGES[key], "") for key in languages()])
        self.scheme = Segmented(
            tr("Appearance"),
            [("system", tr("System setting"), ""), ("light", tr("Light"), ""), ("dark", tr("Dark"), "")],
        )
        self.scale = Choice(tr("Display size"))
        for scale in SCALES:
            self.scale.addItem(tr("{percent} %").format(percent=round(scale * 100)), scale)
        self.side = Segmented(tr("Patient view"), [(FRONT, tr("From the front"), ""), (BEHIND, tr("From behind"), "")])
        self.motion = Segmented(
            tr("Screen animation"),
            [(AS_SYSTEM, tr("System setting"), ""), (LESS_MOTION, tr("Reduced"), "")],
        )
        self.sound = Toggle(tr("Sounds"), "", is_on=True)
        self.prompts = Toggle(tr("Spoken prompts"), "", is_on=False)
        self._screen = self._card(tr("Screen and sound"))
        for label, control in (
            (tr("Language"), self.language),
            (tr("Appearance"), self.scheme),
            (tr("Display size"), self.scale),
            (tr("Patient view"), self.side),
            (tr("Screen animation"), self.motion),
        ):
            self._screen.fill(Text(label, weight=MEDIUM))
            self._screen.add_left(control)
        self._screen.add_left(self.sound)
        self._screen.add_left(self.prompts)
        hint = tr("Speaks each instruction, so you can watch the patient.")
        self._screen.fill(Text(hint, tone="ink2", wraps=True))

    def _build_access(self) -> None:
        self.access_card = self._card(tr("Passphrase and recovery key"))
        self.old = Field(tr("Current passphrase"), is_secret=True)
        self.new = Field(tr("New passphrase"), is_secret=True)
        self._strength = Text(strength_in_words("", self._shortest), tone="ink2", wraps=True)
        self.again = Field(tr("Repeat new passphrase"), is_secret=True)
        self.change = Button(tr("Change passphrase"))
        self._stated = Text(tone="ink2", wraps=True)
        self.renew = Button(tr("Create a new recovery key"))
        self._key_words = Text(size=20, weight=SEMIBOLD, is_code=True, wraps=True)
        self._key_hint = Text(
            tr(
                "The old recovery key opens only earlier backups. Print the new key or write it down; it is "
                "not shown again. At your next login you enter it once to confirm."
            ),
            tone="ink2",
            wraps=True,
        )
        self.print = Button(tr("Print"), ButtonKind.SECONDARY, Icon.PRINT)
        self.save = Button(tr("Save as a file"), ButtonKind.SECONDARY, Icon.IMPORT)
        self.access_card.fill(self.old)
        self.access_card.fill(self.new)
        self.access_card.fill(self._strength)
        self.access_card.fill(self.again)
        self.access_card.add_left(self.change)
        self.access_card.fill(self._stated)
        self.access_card.add_left(self.renew)
        self.access_card.fill(self._key_words)
        self.access_card.fill(self._key_hint)
        self.access_card.add_left(self.print, self.save)
        self.show_recovery_key("")

    def _build_backup(self) -> None:
        self._is_backing_up = False
        self.backup_card = self._card(tr("Backup"))
        hint = tr(
            "A backup is an encrypted copy of all patient data and recordings. It is best kept on another "
            "disk. Deleted data stay in older backups for up to 90 days."
        )
        self.backup_folder = Text(tone="ink2", wraps=True)
        self.backup_stated = Text(weight=MEDIUM, wraps=True)
        self.back_up = Button(tr("Back up now"))
        self.choose_folder = Button(tr("Choose the folder"), ButtonKind.QUIET, Icon.FOLDER)
        self.backup_card.fill(Text(hint, tone="ink2", wraps=True), self.backup_folder, self.backup_stated)
        self.backup_card.add_left(self.back_up, self.choose_folder)
        self.show_backup("", "")

    def _build_deleted(self) -> None:
        self.deleted_card = self._card(tr("Deleted in the last 30 days"))
        self.deleted_rows = QVBoxLayout()
        self.none_deleted = Text(tr("Nothing deleted. Deleted items can be restored here."), tone="ink2", wraps=True)
        self.deleted_card.column.addLayout(self.deleted_rows)
        self.deleted_card.fill(self.none_deleted)

    def _build_clinic(self) -> None:
        self._clinic = self._card(tr("Clinic"))
        self.clinic = Field(tr("Clinic name on reports"), is_optional=True)
        self._clinic.fill(self.clinic)

    def _build_trouble(self) -> None:
        self.trouble_card = self._card(tr("Error report"))
        hint = tr(
            "An error report contains software versions, the type of computer and the end of the log. It "
            "contains no codes, names, paths or typed text. It is saved as a readable text file; you "
            "decide whether to send it."
        )
        self.trouble_card.fill(Text(hint, tone="ink2", wraps=True))
        self.report_error = Button(tr("Save an error report"), ButtonKind.SECONDARY, Icon.IMPORT)
        self.trouble_card.add_left(self.report_error)
        self._trouble_stated = Text(tone="ink2", wraps=True)
        self.trouble_card.fill(self._trouble_stated)
        self._trouble_stated.hide()

    @property
    def trouble_stated(self) -> str:
        return self._trouble_stated.text()

    def show_error_report(self, path: str) -> None:
        """Say where the report is that was just saved."""
        self._trouble_stated.setText(tr("Saved as {path}.").format(path=path))
        self._trouble_stated.show()

    def _connect(self) -> None:
        self.scale.activated.connect(self._on_scale_chosen)
        self.side.chosen.connect(self._on_side_chosen)
        self.motion.chosen.connect(self._on_motion_chosen)
        self.change.clicked.connect(self._on_change)
        self.print.clicked.connect(self._on_print)
        self.save.clicked.connect(self._on_save)
        self.back_up.clicked.connect(self._on_back_up)
        self.clinic.committed.connect(self._on_clinic_named)
        for field in self._fields:
            field.edited.connect(self._on_edited)

    def show_backup(self, sentence: str, folder: str, *, is_running: bool = False) -> None:
        """Say how the latest backup went, and where backups go."""
        self.backup_stated.setText(sentence)
        self.backup_stated.setVisible(bool(sentence))
        self.backup_folder.setText(
            tr("Backup folder: {folder}.").format(folder=folder) if folder else tr("No backup folder chosen yet.")
        )
        self.back_up.setText(tr("Stop") if is_running else tr("Back up now"))
        self._is_backing_up = is_running
        self.choose_folder.setEnabled(not is_running)

    def _card(self, title: str) -> SettingsCard:
        card = SettingsCard(title)
        self.column.addWidget(card)
        return card

    def _on_scale_chosen(self, _index: int) -> None:
        self.scale_chosen.emit(float(self.scale.currentData()))

    def _on_side_chosen(self, key: str) -> None:
        self.side_chosen.emit(key == BEHIND)

    def _on_motion_chosen(self, key: str) -> None:
        self.motion_chosen.emit(key == LESS_MOTION)

    def _on_edited(self, _text: str) -> None:
        for field in self._fields:
            field.set_wrong("")
        self._strength.setText(strength_in_words(self.new.text, self._shortest, self._known))

    def _on_change(self) -> None:
        self._on_edited("")
        new = self.new.text or "-"
        if strength_of(new, self._shortest, self._known) in REFUSED:
            self.new.set_wrong(strength_in_words(new, self._shortest, self._known))
        elif self.new.text != self.again.text:
            self.again.set_wrong(tr("The two passphrases do not match. Enter the second one again."))
        else:
            self.passphrase_requested.emit(self.old.text, self.new.text)

    def _on_clinic_named(self) -> None:
        self.clinic_named.emit(self.clinic.text.strip())

    def _on_print(self) -> None:
        self.print_requested.emit(self.recovery_key)

    def _on_save(self) -> None:
        self.save_requested.emit(self.recovery_key)

    def _on_back_up(self) -> None:
        (self.stop_requested if self._is_backing_up else self.backup_requested).emit()

    @property
    def _fields(self) -> tuple[Field, ...]:
        return self.old, self.new, self.again

    @property
    def _known(self) -> tuple[str, ...]:
        return *self._own, self.clinic.text


class _DeletedRow(QWidget):
    restored = Signal(object, bool)

    def __init__(self, line: DeletedLine) -> None:
        super().__init__()
        self._line = line
        of_line = Text(line.words, size=15, wraps=True), Text(line.details, size=14, tone="ink2", wraps=True)
        words = lay_out(QVBoxLayout(), *of_line, spacing=0)
        self.button = Button(tr("Restore"), height=44)
        self.button.setAccessibleName(f"{self.button.text()}, {line.words}")
        self.button.setAccessibleDescription(line.details)
        self.button.clicked.connect(self._on_clicked)
        lay_out(QHBoxLayout(self), (words, 1), self.button, margins=0)

    def _on_clicked(self) -> None:
        self.restored.emit(self._line.id, self._line.is_patient)
