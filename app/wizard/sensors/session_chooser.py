"""Chooser of the stored session to be replayed: one of the library's, or a session folder."""

from collections.abc import Sequence
from uuid import UUID

from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QStackedWidget, QVBoxLayout, QWidget

from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.line_list import LineList, PatientLine
from app.widgets.notice import Notice
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr

LEAST_LIST = 101  # a line and a part of the next, so that it is seen that there are more


class SessionChooser(QWidget):
    """`sessions` states which is chosen and which is to be played; `folder` and `back` lead elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        title = Text(tr("Choose a session to replay"), 20, SEMIBOLD, wraps=True)
        why = Text(
            tr("The session plays as if measured now, but it is a replay. All its results are marked SIMULATED."),
            14,
            tone="ink2",
            wraps=True,
        )
        self.notice = Notice(size=16)
        self.sessions = LineList(tr("Stored sessions"))
        self.sessions.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Ignored)  # it scrolls by itself
        self._none = Text(tr("This library contains no other session with recordings."), 15, wraps=True)
        self.folder = Button(tr("Choose a session folder"), ButtonKind.SECONDARY, Icon.FOLDER)
        self.back = Button(tr("Other sources"), ButtonKind.QUIET)
        self._lists = QStackedWidget()
        self._lists.addWidget(self.sessions)
        self._lists.addWidget(self._none)
        card = Card(padding=0)
        heading = lay_out(QVBoxLayout(), title, why, self.notice, margins=(24, 16, 24, 4), spacing=4)
        lay_out(card.column, heading, (self._lists, 1))
        verbs = lay_out(QHBoxLayout(), self.folder, self.back, 1, spacing=12)
        lay_out(QVBoxLayout(self), (card, 1), verbs, margins=0, spacing=12)
        scaled(self._none.setContentsMargins, 24, 8, 24, 16)
        scaled(self.sessions.setMinimumHeight, LEAST_LIST)
        self.show_sessions(())
        self.show_message("")

    @property
    def session(self) -> UUID | None:
        """The one that is chosen."""
        line = self.sessions.line
        return line.id if line is not None else None

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.sessions, self.folder, self.back]

    def focus(self) -> None:
        (self.sessions if self.sessions.lines else self.folder).setFocus()

    def show_sessions(self, lines: Sequence[PatientLine]) -> None:
        """Offer these, latest first; the one that was chosen stays chosen."""
        self.sessions.show_lines(lines, self.session)
        self._lists.setCurrentWidget(self.sessions if lines else self._none)

    def show_message(self, what: str, then: str = "") -> None:
        """Say why a session cannot be replayed, above those that may be tried instead; "" takes it back."""
        self.notice.show_message(Icon.WARNING if what else None, what, then, is_caution=bool(what))
        self.notice.setVisible(bool(what))
