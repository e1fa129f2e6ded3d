"""Who works with this library, in the settings: who comes, and whose leaving gives it a new key."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.home.settings.settings_card import SettingsCard
from app.system.passphrases import REFUSED, strength_in_words, strength_of
from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.choice import Choice
from app.widgets.field import Field
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, Text
from app.wording.translation import tr


@dataclass(frozen=True, slots=True)
class OperatorLine:
    """Who works here; `role` in words. `has_key`: the passphrase opens the library."""

    code: str
    name: str
    role: str
    is_active: bool
    is_self: bool
    has_key: bool = True


class OperatorsCard(SettingsCard):
    """`clinic` holds the clinic's name, which is in no passphrase."""

    added = Signal(str, str, str, str)  # code, name, role, passphrase
    removed = Signal(str)  # code

    def __init__(self, shortest: int, roles: Sequence[tuple[str, str]], clinic: Field) -> None:
        self._shortest, self._clinic = shortest, clinic
        self._leaving = ""
        self.rows = QVBoxLayout()
        self.leaving_words = Text(wraps=True)
        self.remove = Button(tr("Remove and change the key"))
        self.keep = Button(tr("Cancel"), ButtonKind.QUIET)
        self.code = Field(tr("Code of a new user"), is_code=True)
        self.name = Field(tr("Name"))
        self.role = Choice(tr("Role"))
        for key, words in roles:
            self.role.addItem(words, key)
        self.first = Field(tr("Initial passphrase, to be changed by the user"), is_secret=True)
        self.add = Button(tr("Add user"), ButtonKind.SECONDARY, Icon.ADD)
        super().__init__(tr("Users of this library"))
        self.column.addLayout(self.rows)
        scaled(self.rows.setSpacing, 4)
        self.fill(self.leaving_words)
        self.add_left(self.remove, self.keep)
        self.fill(self.code, self.name, Text(tr("Role"), weight=MEDIUM))
        self.add_left(self.role)
        self.fill(self.first)
        self.add_left(self.add)
        self._show_leaving("")
        self.add.clicked.connect(self._on_add)
        self.remove.clicked.connect(self._on_remove)
        self.keep.clicked.connect(self._on_keep)
        for field in self._fields:
            field.edited.connect(self._on_edited)

    def show_operators(self, operators: Sequence[OperatorLine]) -> None:
        while (item := self.rows.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for operator in operators:
            row = _OperatorRow(operator)
            row.switched.connect(self._on_switched)
            self.rows.addWidget(row)
        hear_as_laid_out(self)

    def refuse(self, sentence: str) -> None:
        """Say why the new operator was not added."""
        self.code.set_wrong(sentence)

    def forget_typed(self) -> None:
        for field in self._fields:
            field.set_text("")
            field.set_wrong("")

    def show_key_change(self, sentence: str, *, is_running: bool) -> None:
        """Say how far the change of the library's key is, or how it ended."""
        self.leaving_words.setText(sentence)
        self.leaving_words.setVisible(bool(sentence))
        for button in (self.remove, self.keep):
            button.hide()
        self.setEnabled(not is_running)

    @property
    def _fields(self) -> tuple[Field, ...]:
        return self.code, self.name, self.first

    def _show_leaving(self, code: str) -> None:
        """Ask before somebody is removed, and say what is out of reach; without a code nothing is asked."""
        self._leaving = code
        self.show_key_change(
            tr(
                "After this, {code} can no longer open this library. The library gets a new key. An old copy "
                "of its key file then opens nothing on this computer, even with the passphrase of {code}. All "
                "other users keep their passphrases. Earlier backups keep their old key: anyone who has such "
                "a backup can still read it with the old passphrase. Nothing can be recorded until the key "
                "change is complete."
            ).format(code=code)
            if code
            else "",
            is_running=False,
        )
        for button in (self.remove, self.keep):
            button.setVisible(bool(code))

    def _on_switched(self, operator: OperatorLine) -> None:
        if operator.is_active or operator.has_key:
            self._show_leaving(operator.code)
            return
        self._show_leaving("")
        self.code.set_text(operator.code)
        self.name.set_text(operator.name)
        self.role.setCurrentIndex(max(self.role.findText(operator.role), 0))
        self.first.set_wrong(tr("Enter an initial passphrase. The user's old passphrase is no longer valid."))
        self.first.setFocus()

    def _on_remove(self) -> None:
        self.removed.emit(self._leaving)

    def _on_keep(self) -> None:
        self._show_leaving("")

    def _on_edited(self, _text: str) -> None:
        for field in self._fields:
            field.set_wrong("")

    def _on_add(self) -> None:
        first, known = self.first.text or "-", (self.code.text, self.name.text, self._clinic.text)
        if not self.code.text.strip():
            self.code.set_wrong(tr("Enter a code."))
        elif not self.name.text.strip():
            self.name.set_wrong(tr("Enter a name."))
        elif strength_of(first, self._shortest, known) in REFUSED:
            self.first.set_wrong(strength_in_words(first, self._shortest, known))
        else:
            name = self.name.text.strip()
            self.added.emit(self.code.text.strip(), name, str(self.role.currentData()), self.first.text)


class _OperatorRow(QWidget):
    switched = Signal(object)  # OperatorLine

    def __init__(self, operator: OperatorLine) -> None:
        super().__init__()
        self._operator = operator
        words = ", ".join([operator.code, operator.name, operator.role])
        row = lay_out(QHBoxLayout(self), (Text(words, size=15, wraps=True), 1), margins=0)
        self.button = Button(
            tr("Remove user")
            if operator.is_active
            else tr("Change the key now")
            if operator.has_key
            else tr("Reactivate user"),
            height=44,
        )
        self.button.setAccessibleName(f"{self.button.text()}, {operator.code}")
        self.button.setVisible(not operator.is_self)
        self.button.clicked.connect(self._on_clicked)
        row.addWidget(self.button)

    def _on_clicked(self) -> None:
        self.switched.emit(self._operator)
