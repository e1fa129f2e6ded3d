"""Log-in by the passphrase of a library, at the start and when nobody was here for a while.

As a cover it is alone in the window and shows nothing of a patient, and whether a recording goes on.
"""

import math
from collections.abc import Sequence

from PySide6.QtCore import QTimer, Signal
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.home.login.typed_entry import EntryPage
from app.system.passphrases import REFUSED, strength_in_words, strength_of
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.field import Field
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wording.translation import tr

SECOND_MS = 1000


class LogInPage(EntryPage):
    opened = Signal(str, str, bool)  # operator, passphrase, whether this computer is to remember it
    recovered = Signal(str, str, str)  # operator, recovery key, new passphrase
    remembered = Signal(str)  # operator, whom this computer remembers
    away_requested = Signal(str, str)  # operator, passphrase: to work without the clinic's server
    own_chosen = Signal(str)  # an own passphrase, by whom somebody else gave one
    left = Signal()  # another operator, from the cover or instead of choosing an own passphrase
    demonstration_requested = Signal()

    def __init__(self, shortest: int) -> None:
        super().__init__()
        self._shortest, self._left_s = shortest, 0.0
        self._is_cover = self._is_recording = self._is_recovering = self._is_busy = self._can_remember = False
        self._is_asked_for = False  # the cover, by whoever is logged in
        self._can_work_away = self._must_choose_own = False
        self._remembered: tuple[str, ...] = ()
        self._title = Text(size=26, weight=SEMIBOLD, wraps=True)
        self.library = Text(tone="ink2", wraps=True)
        self._why_own = Text(
            tr("Another person chose your passphrase and knows it. Choose one that only you know."),
            tone="ink2",
            wraps=True,
        )
        self._recording = QWidget()
        self._recording_words = Text(tr("Recording continues"), size=20, weight=SEMIBOLD, wraps=True)
        self.operator_label = Text(tr("User"), weight=MEDIUM)
        self.operator = Choice(tr("User"))
        self.recovery_key = Field(tr("Recovery key"), is_code=True)
        self.passphrase = Field(tr("Passphrase"), is_secret=True)
        self.new_passphrase = Field(tr("New passphrase"), is_secret=True)
        self.again = Field(tr("Repeat new passphrase"), is_secret=True)
        self._strength = Text(tone="ink2", wraps=True)
        self.remember = Toggle(tr("Remember on this computer"), "", is_on=False)
        self.go = Button(tr("Open"), ButtonKind.PRIMARY, None, tr("Enter"))
        self.work_away = Button(tr("Work without the server"), ButtonKind.SECONDARY)
        self.use_remembered = Button(tr("Open with this computer's keyring"), ButtonKind.SECONDARY)
        self.use_recovery = Button(tr("Use the recovery key"), ButtonKind.QUIET, height=44)
        self.leave = Button(tr("Another user"), ButtonKind.QUIET, height=44)
        self.demonstration = Button(tr("Open demonstration"), ButtonKind.QUIET, Icon.PLAY, height=44)
        self._second = QTimer(self)
        self._second.setInterval(SECOND_MS)
        self._build()
        self._connect()
        self.show_library("")
        self._show()

    @property
    def tab_order(self) -> list[QWidget]:
        return [
            self.operator,
            self.recovery_key.line_edit,
            self.passphrase.line_edit,
            self.new_passphrase.line_edit,
            self.again.line_edit,
            self.remember,
            self.go,
            self.work_away,
            self.use_remembered,
            self.use_recovery,
            self.leave,
            self.demonstration,
        ]

    @property
    def _fields(self) -> list[Field]:
        return [self.recovery_key, self.passphrase, self.new_passphrase, self.again]

    @property
    def code(self) -> str:
        return str(self.operator.currentData() or "")

    def show_operators(
        self, codes: Sequence[str], remembered: Sequence[str] = (), latest: str = "", *, can_remember: bool = False
    ) -> None:
        """Show who may log in, and whom this computer remembers."""
        self._remembered, self._can_remember = tuple(remembered), can_remember
        self.operator.clear()
        for code in codes:
            self.operator.addItem(code, code)
        self.operator.setCurrentIndex(max(self.operator.findData(latest), 0))
        self._is_cover = self._is_recovering = self._must_choose_own = False
        self._show()

    def show_library(self, words: str) -> None:
        """Say which library it is that is logged in to; nothing where it is this computer's own."""
        self.library.setText(words)
        self.library.setVisible(bool(words))

    def show_cover(self, code: str, is_recording: bool, *, is_asked_for: bool = False) -> None:
        """Cover the window until the passphrase of the operator who is logged in is typed, and say why."""
        self.show_operators((code,))
        self._is_cover, self._is_asked_for = True, is_asked_for
        self.forget_typed()
        self.show_recording(is_recording)

    def ask_for_own(self, code: str) -> None:
        """Ask the operator who is logged in for a passphrase in place of the one that somebody else chose."""
        self.show_operators((code,))
        self._must_choose_own = True
        self.forget_typed()
        self.focus()

    def show_recording(self, is_recording: bool) -> None:
        self._is_recording = is_recording
        self._show()

    def show_busy(self, is_busy: bool) -> None:
        """Say that the passphrase is being tried; that takes a moment on purpose."""
        self._is_busy = is_busy
        self._show()

    def refuse(self, sentence: str, left_s: float = 0.0) -> None:
        """Say why it does not open, and for how long no other try is taken."""
        self._left_s = left_s
        self._first_field.set_wrong(sentence)
        self._is_busy = False
        if left_s > 0:
            self._second.start()
        self._show()
        self.focus()
        self.passphrase.line_edit.selectAll()

    def offer_away(self) -> None:
        """Let the operator work without the clinic's server, which does not answer."""
        self._can_work_away = True
        self._show()
        self.work_away.setFocus()

    def forget_typed(self) -> None:
        """Keep nothing of what was typed."""
        self._can_work_away = False
        for field in self._fields:
            field.set_text("")
            field.set_wrong("")
        self._second.stop()
        self._left_s, self._is_busy = 0.0, False
        self._show()

    def focus(self) -> None:
        self._first_field.setFocus()

    @property
    def _first_field(self) -> Field:
        if self._must_choose_own:
            return self.new_passphrase
        return self.recovery_key if self._is_recovering else self.passphrase

    def _build(self) -> None:
        lay_out(QHBoxLayout(self._recording), IconMark(Icon.RECORDING, 24), (self._recording_words, 1), margins=0)
        self._card = Card(padding=24, spacing=16)
        who = lay_out(QVBoxLayout(), self.operator_label, self.operator, spacing=6)
        lay_out(self._card.column, who, self.recovery_key, self.passphrase, self.new_passphrase)
        lay_out(
            self._card.column, self._strength, self.again, self.remember, self.go, self.work_away, self.use_remembered
        )
        lines = (lay_out(QHBoxLayout(), one, 1) for one in (self.use_recovery, self.leave, self.demonstration))
        quiet = lay_out(QVBoxLayout(), *lines, spacing=4)
        lay_out(self.column, self._title, self.library, self._why_own, self._recording, self._card, quiet)

    def _connect(self) -> None:
        self.go.clicked.connect(self._on_go)
        self.work_away.clicked.connect(self._on_work_away)
        for field in self._fields:
            field.line_edit.returnPressed.connect(self._on_go)
            field.edited.connect(self._on_edited)
        self.use_remembered.clicked.connect(self._on_remembered)
        self.use_recovery.clicked.connect(self._on_use_recovery)
        self.leave.clicked.connect(self.left)
        self.demonstration.clicked.connect(self.demonstration_requested)
        self.operator.currentIndexChanged.connect(self._on_operator_changed)
        self._second.timeout.connect(self._on_second)

    def _show(self) -> None:
        is_recovering, must_choose = self._is_recovering, self._must_choose_own
        is_setting = is_recovering or must_choose
        self._why_own.setVisible(must_choose)
        if self._is_cover and self._is_asked_for:
            self._title.setText(tr("Locked by {user}").format(user=self.code))
        elif self._is_cover:
            self._title.setText(tr("Locked after five minutes without activity"))
        else:
            self._title.setText(tr("A new passphrase") if is_setting else tr("Log in"))
        self._recording.setVisible(self._is_cover and self._is_recording)
        has_choice = self.operator.count() > 1 or self._is_cover or must_choose
        self.operator_label.setVisible(has_choice)
        self.operator.setVisible(has_choice)
        self.operator.setEnabled(self.operator.count() > 1)
        self.recovery_key.setVisible(is_recovering)
        self.passphrase.setVisible(not is_setting)
        self.new_passphrase.setVisible(is_setting)
        self._strength.setVisible(is_setting)
        self.again.setVisible(is_setting)
        self._strength.setText(strength_in_words(self.new_passphrase.text, self._shortest, (self.code,)))
        is_remembered = self.code in self._remembered
        is_closed = not is_setting and not self._is_cover
        self.remember.setVisible(self._can_remember and is_closed and not is_remembered)
        self.use_remembered.setVisible(is_remembered and is_closed)
        self.work_away.setVisible(self._can_work_away and is_closed)
        self.use_recovery.setText(tr("Use the passphrase") if is_recovering else tr("Use the recovery key"))
        self.use_recovery.setVisible(not self._is_cover and not must_choose)
        self.demonstration.setVisible(not self._is_cover and not must_choose)
        self.leave.setVisible(must_choose or (self._is_cover and not self._is_recording))
        self._show_go()

    def _show_go(self) -> None:
        is_waiting = self._left_s > 0 and not self._is_recovering  # nobody guesses a recovery key
        self.go.setEnabled(not self._is_busy and not is_waiting)
        words = tr("Open")
        if self._is_cover:
            words = tr("Continue")
        if self._is_recovering:
            words = tr("Set and open")
        if self._must_choose_own:
            words = tr("Set passphrase")
        if self._is_busy:
            words = tr("Opening")
        if is_waiting:
            words = tr("Next try in {seconds} s").format(seconds=math.ceil(self._left_s))
        self.go.setText(words)
        self.go.setAccessibleName(words)
        self.go.update()

    def _on_go(self) -> None:
        if not self.go.isEnabled():
            return
        if not self._is_recovering and not self._must_choose_own:
            if not self.passphrase.text:
                self.passphrase.set_wrong(tr("Enter the passphrase."))
                return
            self.opened.emit(
                self.code, self.passphrase.text, not self.remember.isHidden() and self.remember.isChecked()
            )
            return
        new, known = self.new_passphrase.text or "-", (self.code,)
        if strength_of(new, self._shortest, known) in REFUSED:
            self.new_passphrase.set_wrong(strength_in_words(new, self._shortest, known))
        elif self.new_passphrase.text != self.again.text:
            self.again.set_wrong(tr("The two passphrases do not match. Enter the second one again."))
        elif self._must_choose_own:
            self.own_chosen.emit(self.new_passphrase.text)
        else:
            self.recovered.emit(self.code, self.recovery_key.text, self.new_passphrase.text)

    def _on_edited(self, _text: str) -> None:
        for field in self._fields:
            field.set_wrong("")
        self._strength.setText(strength_in_words(self.new_passphrase.text, self._shortest, (self.code,)))

    def _on_work_away(self) -> None:
        if not self._is_busy:
            self.away_requested.emit(self.code, self.passphrase.text)

    def _on_remembered(self) -> None:
        self.remembered.emit(self.code)

    def _on_use_recovery(self) -> None:
        self._is_recovering = not self._is_recovering
        self.forget_typed()
        self.focus()

    def _on_operator_changed(self, _index: int) -> None:
        self._show()

    def _on_second(self) -> None:
        self._left_s = max(0.0, self._left_s - SECOND_MS / 1000)
        if self._left_s == 0:
            self._second.stop()
        self._show_go()
