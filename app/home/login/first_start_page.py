"""First start: whose library it is, what opens it, and what opens it when that is forgotten.

All on one page. The recovery key is shown once; the way on opens when its last two groups have been typed from the
paper or file. One that was never confirmed is kept nowhere, and is asked for whole. Where a library was opened here
before and is missing, the page reports it, and makes a new one only if that is asked for.
"""

from collections.abc import Callable

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QWidget

from app.home.login.typed_entry import COLUMN, EntryPage
from app.system.passphrases import REFUSED, strength_in_words, strength_of
from app.theme.current import on_theme, px
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.field import Field
from app.widgets.key_groups import KeyGroups
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr, tr_n

LONGEST_CODE = 12


class FirstStartPage(EntryPage):
    """`is_end_of_key` compares the groups that were typed with the end of the recovery key that was shown."""

    made = Signal(str, str, str)  # code, name, passphrase
    print_requested = Signal(str)  # the recovery key
    save_requested = Signal(str)
    done = Signal()  # the end of the recovery key was typed
    typed_back = Signal(str)  # a recovery key that is not shown here, to be compared with the library's
    demonstration_requested = Signal()

    def __init__(self, shortest: int, is_end_of_key: Callable[[str, str], bool]) -> None:
        super().__init__()
        self._shortest, self._is_end_of_key, self.recovery_key = shortest, is_end_of_key, ""
        self._missing = ""
        self._is_asking = False
        self._missing_title = Text(tr("Your library is missing"), size=26, weight=SEMIBOLD, wraps=True)
        self.missing_lead = Text(tone="ink2", wraps=True)
        self.look_again = Button(tr("Search again"), ButtonKind.PRIMARY, None, tr("Enter"))
        self.make_another = Button(tr("Create a new, empty library instead"), ButtonKind.QUIET, height=44)
        self._title = Text(tr("Your library"), size=26, weight=SEMIBOLD, wraps=True)
        self._lead = Text(
            tr("Patients and recordings stay on this computer, encrypted. The passphrase you choose here opens them."),
            tone="ink2",
            wraps=True,
        )
        self.code = Field(tr("Your code, for example your initials"), is_code=True)
        self.name = Field(tr("Your name, as shown on reports"))
        self.passphrase = Field(tr("Passphrase"), is_secret=True)
        self._strength = Text(tone="ink2", wraps=True)
        self.again = Field(tr("Repeat passphrase"), is_secret=True)
        self.make = Button(tr("Create library"), ButtonKind.PRIMARY, None, tr("Enter"))
        self.demonstration = Button(tr("View the demonstration first"), ButtonKind.QUIET, Icon.PLAY, height=44)
        self.join = Button(tr("Join the clinic's library"), ButtonKind.QUIET, Icon.NEXT, height=44)
        self._key_title = Text(tr("Your recovery key"), size=26, weight=SEMIBOLD, wraps=True)
        self._key_lead = Text(
            tr(
                "It is the only way to open the library if the passphrase is forgotten. Nobody has a copy. It "
                "is shown only once: print it or write it down. Keep it away from this computer."
            ),
            tone="ink2",
            wraps=True,
        )
        self._asking_lead = Text(
            tr(
                "This key was created but never confirmed, so it may be lost. It is the only way to open the "
                "library if the passphrase is forgotten. Type it from the printout or the file. If you cannot "
                "find it, create a new one. The old key then opens only older backups."
            ),
            tone="ink2",
            wraps=True,
        )
        self._key_words = KeyGroups()
        self.print = Button(tr("Print"), ButtonKind.SECONDARY, Icon.PRINT)
        self.save = Button(tr("Save as a file"), ButtonKind.SECONDARY, Icon.IMPORT)
        self.typed = Field("", is_code=True)
        self.go = Button(tr("Continue"), ButtonKind.PRIMARY, None, tr("Enter"))
        self.renew = Button(tr("Create a new recovery key"))
        self.later = Button(tr("Later: ask at next login"), ButtonKind.QUIET, height=44)
        self._build()
        self._connect()
        self._show()
        on_theme(self._fit)

    @property
    def tab_order(self) -> list[QWidget]:
        fields = [self.code, self.name, self.passphrase, self.again]
        first = [*(field.line_edit for field in fields), self.make, self.join, self.demonstration]
        second = [self._key_words, self.print, self.save, self.typed.line_edit, self.go, self.renew, self.later]
        return [self.look_again, self.make_another, *first, *second]

    @property
    def is_missing(self) -> bool:
        """Whether the page states that a library is missing."""
        return bool(self._missing)

    def show_missing(self, folder: str, waiting: int = 0) -> None:
        """Report the library missing from `folder`, empty: how to make one; `waiting`: recordings still here."""
        self._missing, self.recovery_key, self._is_asking = folder, "", False
        reported = [tr("It was in {folder} and is no longer there.").format(folder=folder)]
        if waiting:
            kept = tr_n(
                "{count} recording stays on this computer until its library is back.",
                "{count} recordings stay on this computer until their library is back.",
                waiting,
            )
            reported.append(kept.format(count=waiting))
        reported.append(tr("Connect its disk, or put its folder back. It then opens automatically."))
        self.missing_lead.setText(" ".join(reported))
        self._show()

    def show_recovery_key(self, key: str) -> None:
        """Show the key, once, and forget the passphrase."""
        self.recovery_key, self._is_asking = key, False
        groups = key.split("-")
        self._key_words.show_groups(groups)
        for field in (self.passphrase, self.again, self.typed):
            field.set_text("")
        self._show()
        self.focus()

    def ask_for_recovery_key(self) -> None:
        """Let the key be typed back that was shown earlier."""
        self.recovery_key, self._is_asking = "", True
        self._key_words.show_groups([])
        self.typed.set_text("")
        self._show()
        self.focus()

    def show_typed_wrong(self, sentence: str) -> None:
        """Say why what was typed back is not taken."""
        self.typed.set_wrong(sentence)
        self.typed.setFocus()

    def show_busy(self, is_busy: bool) -> None:
        """Say that the library is being made."""
        self.make.setEnabled(not is_busy)
        self.make.setText(tr("Creating the library") if is_busy else tr("Create library"))

    def refuse(self, sentence: str) -> None:
        """Say why no library was made."""
        self.show_busy(False)
        self.code.set_wrong(sentence)
        self.code.setFocus()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        """The other ways stand beside each other where there is the room."""
        room = min(px(COLUMN), self.width() - px(48))
        needed = self.join.sizeHint().width() + self.demonstration.sizeHint().width() + px(4)
        way = QBoxLayout.Direction.LeftToRight if needed <= room else QBoxLayout.Direction.TopToBottom
        self._other_ways.setDirection(way)

    def focus(self) -> None:
        key_part = self.typed if self._is_asking else self.print if self.recovery_key else None
        (key_part or (self.look_again if self._missing else self.code)).setFocus()

    def _build(self) -> None:
        self._first = Card(padding=24, spacing=16)
        lay_out(self._first.column, self.code, self.name, self.passphrase, self._strength, self.again, self.make)
        self._other_ways = QBoxLayout(QBoxLayout.Direction.LeftToRight)
        left = Qt.AlignmentFlag.AlignLeft
        lay_out(self._other_ways, (self.join, 0, left), (self.demonstration, 0, left), 1, spacing=4)
        self._second = Card(padding=24, spacing=16)
        keep_row = lay_out(QHBoxLayout(), (self.print, 1), (self.save, 1), spacing=12)
        lay_out(self._second.column, self._key_words, keep_row, self.typed, self.go, self.renew, self.later)
        self._missing_card = Card(padding=24, spacing=16)
        lay_out(self._missing_card.column, self.look_again, self.make_another)
        lay_out(self.column, self._missing_title, self.missing_lead, self._missing_card)
        lay_out(self.column, self._title, self._lead, self._first, self._other_ways)
        lay_out(self.column, self._key_title, self._key_lead, self._asking_lead, self._second)

    def _connect(self) -> None:
        self.make_another.clicked.connect(self._on_make_another)
        self.make.clicked.connect(self._on_make)
        self.demonstration.clicked.connect(self.demonstration_requested)
        self.print.clicked.connect(self._on_print)
        self.save.clicked.connect(self._on_save)
        self.go.clicked.connect(self._on_go)
        self.typed.line_edit.returnPressed.connect(self._on_go)
        self.typed.edited.connect(self._on_typed)
        for field in (self.code, self.name, self.passphrase, self.again):
            field.edited.connect(self._on_edited)
            field.line_edit.returnPressed.connect(self._on_make)

    def _show(self) -> None:
        has_key, is_asking = bool(self.recovery_key), self._is_asking
        is_first = not has_key and not is_asking
        for block in (self._missing_title, self.missing_lead, self._missing_card):
            block.setVisible(is_first and self.is_missing)
        for block in (self._title, self._lead, self._first):
            block.setVisible(is_first and not self.is_missing)
        self.demonstration.setVisible(is_first)
        self.join.setVisible(is_first and not self.is_missing)
        for block in (self._key_title, self._second):
            block.setVisible(has_key or is_asking)
        for part in (self._key_lead, self._key_words, self.print, self.save):
            part.setVisible(has_key)
        for part in (self._asking_lead, self.renew, self.later):
            part.setVisible(is_asking)
        whole = tr("Type it from the printout or the file")
        self.typed.set_label(whole if is_asking else tr("Last two groups, from the printout or the file"))
        self._strength.setText(strength_in_words(self.passphrase.text, self._shortest, self._known))

    @property
    def _known(self) -> tuple[str, ...]:
        return self.code.text, self.name.text

    def _on_make_another(self) -> None:
        self.show_missing("")
        self.focus()

    def _on_edited(self, _text: str) -> None:
        for field in (self.code, self.name, self.passphrase, self.again):
            field.set_wrong("")
        self._strength.setText(strength_in_words(self.passphrase.text, self._shortest, self._known))

    def _on_make(self) -> None:
        code = self.code.text.strip()
        wrong: list[tuple[Field, str]] = []
        if not code.isalnum() or len(code) > LONGEST_CODE:
            wrong.append((self.code, tr("Enter 1 to {most} letters and digits.").format(most=LONGEST_CODE)))
        if not self.name.text.strip():
            wrong.append((self.name, tr("Enter your name.")))
        if strength_of(self.passphrase.text or "-", self._shortest, self._known) in REFUSED:
            why = strength_in_words(self.passphrase.text or "-", self._shortest, self._known)
            wrong.append((self.passphrase, why))
        elif self.passphrase.text != self.again.text:
            wrong.append((self.again, tr("The two passphrases do not match. Enter the second one again.")))
        for field, sentence in wrong:
            field.set_wrong(sentence)
        if wrong:
            wrong[0][0].setFocus()
        elif self.make.isEnabled():
            self.made.emit(code, self.name.text.strip(), self.passphrase.text)

    def _on_print(self) -> None:
        self.print_requested.emit(self.recovery_key)

    def _on_save(self) -> None:
        self.save_requested.emit(self.recovery_key)

    def _on_typed(self, _text: str) -> None:
        self.typed.set_wrong("")

    def _on_go(self) -> None:
        if self._is_asking:
            self.typed_back.emit(self.typed.text)
            return
        if not self._is_end_of_key(self.typed.text, self.recovery_key):
            self.typed.set_wrong(tr("These are not the last two groups above. Compare them."))
            self.typed.setFocus()
            return
        self.recovery_key = ""
        self._key_words.show_groups([])
        self.typed.set_text("")
        self.done.emit()
