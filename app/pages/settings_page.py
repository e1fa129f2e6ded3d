"""What can be set: how everything looks and sounds, what opens the library, its second copy, who works with it."""

from collections.abc import Sequence
from dataclasses import dataclass
from uuid import UUID

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.icons import Icon
from app.pages.clinic_cards import MoreStationsCard, StationCard
from app.passphrases import REFUSED, strength_in_words, strength_of
from app.theme import SCALES, ThemeNotifier
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.field import Field
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.segmented import Segmented
from app.widgets.tall_page import TallPage
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wording import LANGUAGES, languages, tr

COLUMN = 720
FRONT, BEHIND = "front", "behind"
AS_SYSTEM, LESS_MOTION = "system", "less"


@dataclass(frozen=True, slots=True)
class OperatorLine:
    """Who works here; `role` in words. `has_key`: the passphrase opens the library."""

    code: str
    name: str
    role: str
    is_active: bool
    is_self: bool
    has_key: bool = True


@dataclass(frozen=True, slots=True)
class DeletedLine:
    """What was deleted and can still be had back: a patient with all sessions, or one session."""

    id: UUID
    words: str
    is_patient: bool


class SettingsPage(TallPage):
    """The parts about a library are hidden where they mean nothing: in the demonstration, and for who may not."""

    language_chosen = Signal(str)
    scheme_chosen = Signal(str)
    scale_chosen = Signal(float)
    side_chosen = Signal(bool)  # from behind
    motion_chosen = Signal(bool)  # less
    sound_chosen = Signal(bool)
    passphrase_wished = Signal(str, str)  # old, new
    recovery_key_wished = Signal()
    print_wished = Signal(str)
    save_wished = Signal(str)
    backup_wished = Signal()
    backup_folder_wished = Signal()
    stop_wished = Signal()
    error_report_wished = Signal()
    operator_added = Signal(str, str, str, str)  # code, name, role, passphrase
    operator_removed = Signal(str)  # code
    clinic_named = Signal(str)
    restore_wished = Signal(object, bool)  # id, whether it is a patient's

    def __init__(self, look: ThemeNotifier, shortest: int, roles: Sequence[tuple[str, str]]) -> None:
        super().__init__()
        self._look, self._shortest, self._roles = look, shortest, roles
        self._own: tuple[str, ...] = ()
        self._title = Text(look, tr("Settings"), size=26, weight=SEMIBOLD)
        self.column.addWidget(self._title)
        self._build_screen()
        self._build_access()
        self._build_backup()
        self.station = StationCard(look)
        self.more_stations = MoreStationsCard(look)
        for card in (self.station, self.more_stations):
            self.column.addWidget(card)
        self._build_deleted()
        self._build_clinic()
        self._build_operators()
        self._build_trouble()
        self.column.addStretch(1)
        self._connect()
        self._on_look_changed()

    @property
    def tab_order(self) -> list[QWidget]:
        return [
            *self.language.segments,
            *self.scheme.segments,
            self.scale,
            *self.side.segments,
            *self.motion.segments,
            self.sound,
            *(field.line_edit for field in (self.old, self.new, self.again)),
            self.change,
            self.renew,
            self.back_up,
            self.choose_folder,
            *self.station.tab_order,
            *self.more_stations.tab_order,
            self.report_error,
        ]

    def focus(self) -> None:
        self.language.focus()

    def show_screen(
        self, language: str, scheme: str, scale: float, *, is_from_behind: bool, has_sound: bool, has_less_motion: bool
    ) -> None:
        self.language.choose(language)
        self.scheme.choose(scheme)
        nearest = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - scale))
        self.scale.setCurrentIndex(nearest)
        self.side.choose(BEHIND if is_from_behind else FRONT)
        self.motion.choose(LESS_MOTION if has_less_motion else AS_SYSTEM)
        self.sound.setChecked(has_sound)

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
        self.deleted_card.setVisible(has_deleted)
        self.station.setVisible(is_station)
        self.more_stations.setVisible(may_move)
        self._clinic.setVisible(has_operators)
        self.operators_card.setVisible(has_operators)
        self.forget_typed()
        self.show_recovery_key("")

    def forget_typed(self) -> None:
        for field in (self.old, self.new, self.again, self.code, self.name, self.first):
            field.set_text("")
            field.set_wrong("")
        self.more_stations.server.forget_typed()
        self._said.setText("")
        self._strength.setText(strength_in_words("", self._shortest))

    def show_passphrase_changed(self) -> None:
        self.forget_typed()
        self._said.setText(tr("The passphrase is changed. Only backups made before still open with the old one."))

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

    def show_operators(self, operators: Sequence[OperatorLine]) -> None:
        while (item := self.operator_rows.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for operator in operators:
            row = _OperatorRow(self._look, operator)
            row.switched.connect(self._on_operator_switched)
            self.operator_rows.addWidget(row)
        hear_as_laid_out(self.operators_card)

    def show_deleted(self, lines: Sequence[DeletedLine]) -> None:
        """Show what can still be had back."""
        while (item := self.deleted_rows.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for line in lines:
            row = _DeletedRow(self._look, line)
            row.restored.connect(self.restore_wished)
            self.deleted_rows.addWidget(row)
        self.none_deleted.setVisible(not lines)

    def refuse_operator(self, sentence: str) -> None:
        self.code.set_wrong(sentence)

    def _build_screen(self) -> None:
        look = self._look
        self.language = Segmented(look, tr("Language"), [(key, LANGUAGES[key], "") for key in languages()])
        self.scheme = Segmented(
            look,
            tr("Light or dark"),
            [("system", tr("As the system"), ""), ("light", tr("Light"), ""), ("dark", tr("Dark"), "")],
        )
        self.scale = Choice(look, tr("Size of everything"))
        for scale in SCALES:
            self.scale.addItem(tr("{percent} %").format(percent=round(scale * 100)), scale)
        self.side = Segmented(
            look, tr("The patient is seen"), [(FRONT, tr("From the front"), ""), (BEHIND, tr("From behind"), "")]
        )
        self.motion = Segmented(
            look,
            tr("Motion on the screen"),
            [(AS_SYSTEM, tr("As the system"), ""), (LESS_MOTION, tr("Less motion"), "")],
        )
        self.sound = Toggle(look, tr("Sounds"), "", is_on=True)
        self._screen = self._card(tr("Screen and sound"))
        for label, control in (
            (tr("Language"), self.language),
            (tr("Light or dark"), self.scheme),
            (tr("Size of everything"), self.scale),
            (tr("The patient is seen"), self.side),
            (tr("Motion on the screen"), self.motion),
        ):
            self._screen.column.addWidget(Text(look, label, weight=MEDIUM))
            self._add_left(self._screen, control)
        self._add_left(self._screen, self.sound)

    def _build_access(self) -> None:
        look = self._look
        self.access_card = self._card(tr("Your passphrase and the recovery key"))
        self.old = Field(look, tr("Passphrase until now"), is_secret=True)
        self.new = Field(look, tr("New passphrase"), is_secret=True)
        self._strength = Text(look, strength_in_words("", self._shortest), tone="ink2", wraps=True)
        self.again = Field(look, tr("New passphrase again"), is_secret=True)
        self.change = Button(look, tr("Change the passphrase"))
        self._said = Text(look, tone="ink2", wraps=True)
        self.renew = Button(look, tr("Make a new recovery key"))
        self._key_words = Text(look, size=20, weight=SEMIBOLD, is_code=True, wraps=True)
        self._key_hint = Text(
            look,
            tr(
                "The old recovery key opens only backups made before. Print this one or write it down; it is not shown "
                "again. You are asked to type it back at your next log in."
            ),
            tone="ink2",
            wraps=True,
        )
        self.print = Button(look, tr("Print"), ButtonKind.SECONDARY, Icon.PRINT)
        self.save = Button(look, tr("Save as a file"), ButtonKind.SECONDARY, Icon.IMPORT)
        self.access_card.column.addWidget(self.old)
        self.access_card.column.addWidget(self.new)
        self.access_card.column.addWidget(self._strength)
        self.access_card.column.addWidget(self.again)
        self._add_left(self.access_card, self.change)
        self.access_card.column.addWidget(self._said)
        self._add_left(self.access_card, self.renew)
        self.access_card.column.addWidget(self._key_words)
        self.access_card.column.addWidget(self._key_hint)
        self._add_left(self.access_card, self.print, self.save)
        self.show_recovery_key("")

    def _build_backup(self) -> None:
        look = self._look
        self._is_backing_up = False
        self.backup_card = self._card(tr("Backup"))
        hint = tr(
            "A second copy of all patients and recordings, encrypted, best on another disk. What is deleted here is "
            "in older copies for up to 90 days."
        )
        self.backup_folder = Text(look, tone="ink2", wraps=True)
        self.backup_said = Text(look, weight=MEDIUM, wraps=True)
        self.back_up = Button(look, tr("Back up now"))
        self.choose_folder = Button(look, tr("Choose the folder"), ButtonKind.QUIET, Icon.FOLDER)
        self.backup_card.column.addWidget(Text(look, hint, tone="ink2", wraps=True))
        self.backup_card.column.addWidget(self.backup_folder)
        self.backup_card.column.addWidget(self.backup_said)
        self._add_left(self.backup_card, self.back_up, self.choose_folder)
        self.show_backup("", "")

    def _build_deleted(self) -> None:
        look = self._look
        self.deleted_card = self._card(tr("Deleted in the last 30 days"))
        self.deleted_rows = QVBoxLayout()
        self.none_deleted = Text(
            look, tr("Nothing. What is deleted can be had back from here."), tone="ink2", wraps=True
        )
        self.deleted_card.column.addLayout(self.deleted_rows)
        self.deleted_card.column.addWidget(self.none_deleted)

    def _build_clinic(self) -> None:
        self._clinic = self._card(tr("Your clinic"))
        self.clinic = Field(self._look, tr("Name, as reports print it"), is_optional=True)
        self._clinic.column.addWidget(self.clinic)

    def _build_operators(self) -> None:
        look = self._look
        self.operators_card = self._card(tr("Who works with this library"))
        self.operator_rows = QVBoxLayout()
        self.operators_card.column.addLayout(self.operator_rows)
        self._leaving = ""
        self.leaving_words = Text(look, wraps=True)
        self.remove = Button(look, tr("Remove and change the key"))
        self.keep = Button(look, tr("Cancel"), ButtonKind.QUIET)
        self.operators_card.column.addWidget(self.leaving_words)
        self._add_left(self.operators_card, self.remove, self.keep)
        self._show_leaving("")
        self.code = Field(look, tr("Code of a new operator"), is_code=True)
        self.name = Field(look, tr("Name"))
        self.role = Choice(look, tr("Role"))
        for key, words in self._roles:
            self.role.addItem(words, key)
        self.first = Field(look, tr("First passphrase, to be changed by its owner"), is_secret=True)
        self.add = Button(look, tr("Add the operator"), ButtonKind.SECONDARY, Icon.ADD)
        self.operators_card.column.addWidget(self.code)
        self.operators_card.column.addWidget(self.name)
        self.operators_card.column.addWidget(Text(look, tr("Role"), weight=MEDIUM))
        self._add_left(self.operators_card, self.role)
        self.operators_card.column.addWidget(self.first)
        self._add_left(self.operators_card, self.add)

    def _build_trouble(self) -> None:
        look = self._look
        self.trouble_card = self._card(tr("If something went wrong"))
        hint = tr(
            "An error report says which versions run here, on which kind of computer, and the end of the log: no "
            "codes, names or paths, and nothing typed. It is saved as a text that you can read; sending it is "
            "up to you."
        )
        self.trouble_card.column.addWidget(Text(look, hint, tone="ink2", wraps=True))
        self.report_error = Button(look, tr("Save an error report"), ButtonKind.SECONDARY, Icon.IMPORT)
        self._add_left(self.trouble_card, self.report_error)
        self._trouble_said = Text(look, tone="ink2", wraps=True)
        self.trouble_card.column.addWidget(self._trouble_said)
        self._trouble_said.hide()

    @property
    def trouble_said(self) -> str:
        return self._trouble_said.text()

    def show_error_report(self, path: str) -> None:
        """Say where the report is that was just saved."""
        self._trouble_said.setText(tr("Saved as {path}.").format(path=path))
        self._trouble_said.show()

    def _connect(self) -> None:
        self.language.chosen.connect(self.language_chosen)
        self.scheme.chosen.connect(self.scheme_chosen)
        self.scale.activated.connect(self._on_scale_chosen)
        self.side.chosen.connect(self._on_side_chosen)
        self.motion.chosen.connect(self._on_motion_chosen)
        self.sound.toggled.connect(self.sound_chosen)
        self.change.clicked.connect(self._on_change)
        self.renew.clicked.connect(self.recovery_key_wished)
        self.print.clicked.connect(self._on_print)
        self.save.clicked.connect(self._on_save)
        self.back_up.clicked.connect(self._on_back_up)
        self.choose_folder.clicked.connect(self.backup_folder_wished)
        self.add.clicked.connect(self._on_add)
        self.remove.clicked.connect(self._on_remove)
        self.keep.clicked.connect(self._on_keep)
        self.clinic.committed.connect(self._on_clinic_named)
        self.report_error.clicked.connect(self.error_report_wished)
        for field in (self.old, self.new, self.again, self.code, self.name, self.first):
            field.edited.connect(self._on_edited)

    def show_key_change(self, sentence: str, *, is_running: bool) -> None:
        """Say how far the change of the library's key is, or how it ended."""
        self.leaving_words.setText(sentence)
        self.leaving_words.setVisible(bool(sentence))
        for button in (self.remove, self.keep):
            button.hide()
        self.operators_card.setEnabled(not is_running)

    def _show_leaving(self, code: str) -> None:
        """Ask before somebody is removed, and say what is out of reach; without a code nothing is asked."""
        self._leaving = code
        self.show_key_change(
            tr(
                "{code} then opens this library no longer, and it gets a new key: an old copy of its key file, with "
                "the passphrase of {code}, opens nothing that is on this computer from then on. All others keep "
                "their passphrases. Backups that were made before keep their old key: with the old passphrase, who "
                "has one can still read it. Nothing can be recorded until the change is done."
            ).format(code=code)
            if code
            else "",
            is_running=False,
        )
        for button in (self.remove, self.keep):
            button.setVisible(bool(code))

    def _on_operator_switched(self, operator: OperatorLine) -> None:
        if operator.is_active or operator.has_key:
            self._show_leaving(operator.code)
            return
        self._show_leaving("")
        self.code.set_text(operator.code)
        self.name.set_text(operator.name)
        self.role.setCurrentIndex(max(self.role.findText(operator.role), 0))
        self.first.set_wrong(tr("Type a first passphrase: the old one opens nothing any more."))
        self.first.setFocus()

    def _on_remove(self) -> None:
        self.operator_removed.emit(self._leaving)

    def _on_keep(self) -> None:
        self._show_leaving("")

    def show_backup(self, sentence: str, folder: str, *, is_running: bool = False) -> None:
        """Say how the latest backup went, and where backups go."""
        self.backup_said.setText(sentence)
        self.backup_said.setVisible(bool(sentence))
        self.backup_folder.setText(
            tr("Backups go to {folder}.").format(folder=folder)
            if folder
            else tr("No folder is chosen for backups yet.")
        )
        self.back_up.setText(tr("Stop") if is_running else tr("Back up now"))
        self.back_up.updateGeometry()
        self._is_backing_up = is_running
        self.choose_folder.setEnabled(not is_running)

    def _card(self, title: str) -> Card:
        card = Card(self._look, padding=20, spacing=10)
        card.column.addWidget(Text(self._look, title, size=16, weight=SEMIBOLD, wraps=True))
        self.column.addWidget(card)
        return card

    def _add_left(self, card: Card, *widgets: QWidget) -> None:
        """Give controls the width that they need, one beside the other."""
        row = QHBoxLayout()
        for widget in widgets:
            row.addWidget(widget)
        row.addStretch(1)
        card.column.addLayout(row)

    def _on_scale_chosen(self, _index: int) -> None:
        self.scale_chosen.emit(float(self.scale.currentData()))

    def _on_side_chosen(self, key: str) -> None:
        self.side_chosen.emit(key == BEHIND)

    def _on_motion_chosen(self, key: str) -> None:
        self.motion_chosen.emit(key == LESS_MOTION)

    def _on_edited(self, _text: str) -> None:
        for field in (self.old, self.new, self.again, self.code, self.name, self.first):
            field.set_wrong("")
        self._strength.setText(strength_in_words(self.new.text, self._shortest, self._known))

    def _on_change(self) -> None:
        self._on_edited("")
        new = self.new.text or "-"
        if strength_of(new, self._shortest, self._known) in REFUSED:
            self.new.set_wrong(strength_in_words(new, self._shortest, self._known))
        elif self.new.text != self.again.text:
            self.again.set_wrong(tr("The two are not the same. Type the second one again."))
        else:
            self.passphrase_wished.emit(self.old.text, self.new.text)

    def _on_clinic_named(self) -> None:
        self.clinic_named.emit(self.clinic.text.strip())

    def _on_print(self) -> None:
        self.print_wished.emit(self.recovery_key)

    def _on_save(self) -> None:
        self.save_wished.emit(self.recovery_key)

    def _on_back_up(self) -> None:
        (self.stop_wished if self._is_backing_up else self.backup_wished).emit()

    @property
    def _known(self) -> tuple[str, ...]:
        return *self._own, self.clinic.text

    def _on_add(self) -> None:
        first, known = self.first.text or "-", (self.code.text, self.name.text, self.clinic.text)
        if not self.code.text.strip():
            self.code.set_wrong(tr("Type a code."))
        elif not self.name.text.strip():
            self.name.set_wrong(tr("Type a name."))
        elif strength_of(first, self._shortest, known) in REFUSED:
            self.first.set_wrong(strength_in_words(first, self._shortest, known))
        else:
            name = self.name.text.strip()
            self.operator_added.emit(self.code.text.strip(), name, str(self.role.currentData()), self.first.text)

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self.setMaximumWidth(px(COLUMN + 48))
        self.column.setContentsMargins(px(24), px(16), px(24), px(20))
        self.column.setSpacing(px(16))
        self.operator_rows.setSpacing(px(4))
        self.deleted_rows.setSpacing(px(4))


class _OperatorRow(QWidget):
    switched = Signal(object)  # OperatorLine

    def __init__(self, look: ThemeNotifier, operator: OperatorLine) -> None:
        super().__init__()
        self._operator = operator
        row = QBoxLayout(QBoxLayout.Direction.LeftToRight, self)
        row.setContentsMargins(0, 0, 0, 0)
        words = ", ".join([operator.code, operator.name, operator.role])
        row.addWidget(Text(look, words, size=15, wraps=True), 1)
        self.button = Button(
            look,
            tr("Works here no longer")
            if operator.is_active
            else tr("Change the key now")
            if operator.has_key
            else tr("Works here again"),
            height=44,
        )
        self.button.setAccessibleName(f"{self.button.text()}, {operator.code}")
        self.button.setVisible(not operator.is_self)
        self.button.clicked.connect(self._on_clicked)
        row.addWidget(self.button)

    def _on_clicked(self) -> None:
        self.switched.emit(self._operator)


class _DeletedRow(QWidget):
    restored = Signal(object, bool)

    def __init__(self, look: ThemeNotifier, line: DeletedLine) -> None:
        super().__init__()
        self._line = line
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(Text(look, line.words, size=15, wraps=True), 1)
        self.button = Button(look, tr("Restore"), height=44)
        self.button.setAccessibleName(f"{self.button.text()}, {line.words}")
        self.button.clicked.connect(self._on_clicked)
        row.addWidget(self.button)

    def _on_clicked(self) -> None:
        self.restored.emit(self._line.id, self._line.is_patient)
