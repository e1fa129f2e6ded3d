"""Chooser of the stored session to be replayed: one of the library's, or a session folder."""

from collections.abc import Sequence
from uuid import UUID

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QStackedWidget, QVBoxLayout, QWidget

from app.theme.current import current_theme
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.line_list import LineList, PatientLine
from app.widgets.notice import Notice
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed
from app.wording.translation import tr

LINES_AT_LEAST = 1.4  # in sight, so that it is seen that there are more
LINE = 72


class SessionChooser(Themed):
    """
    Signals
    -------
    chosen
        Another session is chosen: its id, or None.
    opened
        The id of a session that is to be replayed.
    folder_pressed
        A session folder is asked for instead.
    back_pressed
        No session is asked for after all.
    """

    chosen = Signal(object)
    opened = Signal(object)
    folder_pressed = Signal()
    back_pressed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._title = Text(tr("Choose a session to replay"), 20, SEMIBOLD, wraps=True)
        self._why = Text(
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
        self._card = Card(padding=0)
        self._heading = QVBoxLayout()
        self._heading.addWidget(self._title)
        self._heading.addWidget(self._why)
        self._heading.addWidget(self.notice)
        self._card.column.addLayout(self._heading)
        self._card.column.addWidget(self._lists, 1)
        self._verbs = QHBoxLayout()
        self._verbs.addWidget(self.folder)
        self._verbs.addWidget(self.back)
        self._verbs.addStretch(1)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.addWidget(self._card, 1)
        self._column.addLayout(self._verbs)
        self.sessions.chosen.connect(self.chosen)
        self.sessions.opened.connect(self.opened)
        self.folder.clicked.connect(self.folder_pressed)
        self.back.clicked.connect(self.back_pressed)
        self._apply_theme()
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

    def _apply_theme(self) -> None:
        px = current_theme().px
        self._column.setSpacing(px(12))
        self._verbs.setSpacing(px(12))
        self._heading.setContentsMargins(px(24), px(16), px(24), px(4))
        self._heading.setSpacing(px(4))
        self._none.setContentsMargins(px(24), px(8), px(24), px(16))
        self.sessions.setMinimumHeight(px(round(LINE * LINES_AT_LEAST)))
