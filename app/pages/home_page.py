"""Find the patient, begin: patients at the left with a search, the sessions of the one that is chosen at the right."""

from collections.abc import Sequence
from uuid import UUID

from PySide6.QtCore import QEvent, QObject, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QFontMetrics, QKeyEvent, QKeySequence, QPainter, QPaintEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QLineEdit, QSizePolicy, QVBoxLayout, QWidget

from app.icons import Icon, paint_icon
from app.pages.home_lists import Line, LineList, PatientLine, SessionLine
from app.theme import ThemeNotifier
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.widgets.themed import Themed
from app.wording import tr, tr_n

SEARCH_HEIGHT = 48
PATIENTS_SHARE, SESSIONS_SHARE = 414, 586  # of the picture's 1016, without the gutter
STACKED_BELOW = 660  # px of the design: lists one above the other
ROOMY_FROM = 800
PATIENTS_AT_LEAST = 280
LIST_AT_LEAST = 236  # three lines


class HomePage(Themed):
    """Knows lines and ids. Typing narrows the list down; the arrow keys choose from it while typing goes on."""

    patient_chosen = Signal(object)  # UUID or None
    session_opened = Signal(object)  # UUID
    new_session_wished = Signal()  # Enter
    new_patient_wished = Signal()
    demonstration_wished = Signal()
    patient_deleted = Signal(object)  # UUID: by key or button
    session_deleted = Signal(object)

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self._patients: Sequence[PatientLine] | None = None  # not read yet
        self._title = Text(look, tr("Patients"), size=26, weight=SEMIBOLD)
        self._count = Text(look, tone="ink2")
        self.search = _Search(look)
        self.patients = LineList(look, tr("Patients"))
        self._nobody = _Empty(look)
        self._code = Text(look, size=26, weight=SEMIBOLD, is_code=True, wraps=True)
        self._person = Text(look, tone="ink2", wraps=True)
        self.delete_patient = Button(look, tr("Delete patient"), ButtonKind.QUIET, Icon.DELETE, height=44)
        self._sessions_title = Text(look, tr("Sessions"), size=16, weight=SEMIBOLD)
        self._stored = Text(look, size=12, tone="ink2")
        self.delete_session = Button(look, tr("Delete session"), ButtonKind.QUIET, Icon.DELETE, height=44)
        self.sessions = LineList(look, tr("Sessions"), is_opened_by_click=True)
        self._none_yet = Text(look, tr("No sessions yet."), tone="ink2", wraps=True)
        self._build()
        self._connect()
        self.forget_patients()
        self.show_patient("", "")
        self._on_look_changed()

    @property
    def patient_id(self) -> UUID | None:
        """The patient who is chosen."""
        line = self.patients.line
        return line.id if line is not None else None

    @property
    def tab_order(self) -> list[QWidget]:
        return [
            self.search,
            self.patients,
            *self._nobody.buttons,
            self.delete_patient,
            self.sessions,
            self.delete_session,
        ]

    def focus(self) -> None:
        self.search.setFocus()

    def forget_patients(self) -> None:
        """Show nobody, and do not say that there is nobody: the library has still to be read."""
        self._patients = None
        self._filter(None)
        self.forget_sessions()

    def forget_sessions(self) -> None:
        """Show no session, and do not say that there is none: those of another patient are still to be read."""
        self.show_sessions(())
        self._none_yet.hide()

    def show_patients(self, lines: Sequence[PatientLine], chosen: UUID | None = None) -> None:
        """Show all patients there are, with one of them chosen, else the first that the search lets through."""
        self._patients = tuple(lines)
        self._filter(chosen)

    def show_patient(self, code: str, person: str, stored: str = "") -> None:
        """Say whose sessions stand at the right; nobody's where there is no code."""
        self._code.setText(code)
        self._person.setText(person)
        self._stored.setText(stored)
        for part in (self._code, self._person, self._card, self.delete_patient):
            part.setVisible(bool(code))

    def show_sessions(self, lines: Sequence[SessionLine]) -> None:
        self.sessions.show_lines(lines)
        self.sessions.setVisible(bool(lines))
        self._none_yet.setVisible(not lines)
        self.delete_session.setVisible(False)

    def set_room(self, width: float) -> None:
        """Lay out for a page of this width, in px of the design."""
        way = QBoxLayout.Direction.TopToBottom if width < STACKED_BELOW else QBoxLayout.Direction.LeftToRight
        self._columns.setDirection(way)
        self._stored.setVisible(width >= ROOMY_FROM)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Let the arrow keys move in the list while the search has the focus, and Delete delete in the lists."""
        is_undo = isinstance(event, QKeyEvent) and event.matches(QKeySequence.StandardKey.Undo)
        if event.type() == QEvent.Type.ShortcutOverride and watched is self.search and is_undo:
            event.ignore()  # what was deleted comes back by it, not what was searched for
            return True
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress:
            steps = {Qt.Key.Key_Down: 1, Qt.Key.Key_Up: -1, Qt.Key.Key_PageDown: 6, Qt.Key.Key_PageUp: -6}
            key = Qt.Key(event.key())
            if watched is self.search and key in steps:
                self.patients.step(steps[key])
                return True
            if watched is self.search and key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
                self.new_session_wished.emit()
                return True
            if watched is self.search and key == Qt.Key.Key_Escape and self.search.text():
                self.search.clear()
                return True
            if key == Qt.Key.Key_Delete and watched is self.patients:
                self._on_delete_patient()
                return True
            if key == Qt.Key.Key_Delete and watched is self.sessions:
                self._on_delete_session()
                return True
        return super().eventFilter(watched, event)

    def _build(self) -> None:
        heading = QHBoxLayout()
        heading.addWidget(self._title, 1)
        heading.addWidget(self._count, 0, Qt.AlignmentFlag.AlignBottom)
        self._list_card = Card(self._look, padding=0)
        self._list_card.column.addWidget(self.patients, 1)
        self._list_card.column.addWidget(self._nobody, 1)
        self._left = QVBoxLayout()
        self._left.addLayout(heading)
        self._left.addWidget(self.search)
        self._left.addWidget(self._list_card, 1)
        names = QVBoxLayout()
        names.setSpacing(0)
        names.addWidget(self._code)
        names.addWidget(self._person)
        self._who = QHBoxLayout()
        self._who.addLayout(names, 1)
        self._who.addWidget(self.delete_patient, 0, Qt.AlignmentFlag.AlignBottom)
        self._card = Card(self._look, padding=0)
        self._card_head = QHBoxLayout()
        self._card_head.addWidget(self._sessions_title, 1)
        self._card_head.addWidget(self.delete_session)
        self._card_head.addWidget(self._stored)
        self._card.column.addLayout(self._card_head)
        self._card.column.addWidget(self.sessions, 1)
        self._card.column.addWidget(self._none_yet, 0, Qt.AlignmentFlag.AlignHCenter)
        self._card.column.addStretch(0)
        self._right = QVBoxLayout()
        self._right.addLayout(self._who)
        self._right.addWidget(self._card, 1)
        self._right.addStretch(0)
        self._columns = QBoxLayout(QBoxLayout.Direction.LeftToRight, self)
        self._columns.addLayout(self._left, PATIENTS_SHARE)
        self._columns.addLayout(self._right, SESSIONS_SHARE)

    def _connect(self) -> None:
        self.search.textChanged.connect(self._on_searched)
        self.patients.chosen.connect(self._on_patient_chosen)
        self.patients.opened.connect(self._on_patient_opened)
        self.sessions.opened.connect(self.session_opened)
        self.sessions.chosen.connect(self._on_session_chosen)
        self.delete_patient.clicked.connect(self._on_delete_patient)
        self.delete_session.clicked.connect(self._on_delete_session)
        self._nobody.new_patient.clicked.connect(self.new_patient_wished)
        self._nobody.demonstration.clicked.connect(self.demonstration_wished)
        for watched in (self.search, self.patients, self.sessions):
            watched.installEventFilter(self)

    def _filter(self, chosen: UUID | None) -> None:
        wanted = self.search.text().strip().casefold().split()
        found: list[Line] = [line for line in self._patients or () if all(word in line.searched for word in wanted)]
        ids = {line.id for line in found}
        before = self.patient_id
        if chosen not in ids:
            chosen = before if before in ids else found[0].id if found else None
        self.patients.show_lines(found, chosen)
        self._count.setText(str(len(found)) if self._patients else "")
        self._count.setAccessibleName(tr_n("{count} patient", "{count} patients", len(found)).format(count=len(found)))
        self.patients.setVisible(bool(found))
        self._nobody.setVisible(not found and self._patients is not None)
        self._nobody.show_reason(bool(self._patients))
        if self.patient_id is None:
            self.patient_chosen.emit(None)

    def _on_searched(self, _text: str) -> None:
        self._filter(None)

    def _on_patient_chosen(self, patient_id: UUID | None) -> None:
        if patient_id is not None:
            self.patient_chosen.emit(patient_id)

    def _on_patient_opened(self, _patient_id: UUID) -> None:
        self.new_session_wished.emit()

    def _on_session_chosen(self, session_id: UUID | None) -> None:
        self.delete_session.setVisible(session_id is not None)

    def _on_delete_patient(self) -> None:
        if self.patient_id is not None:
            self.patient_deleted.emit(self.patient_id)

    def _on_delete_session(self) -> None:
        line = self.sessions.line
        if line is not None:
            self.session_deleted.emit(line.id)

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self._columns.setContentsMargins(px(24), px(16), px(24), px(20))
        self._columns.setSpacing(px(16))
        for column in (self._left, self._right):
            column.setSpacing(px(12))
        self._who.setSpacing(px(12))
        self._card_head.setContentsMargins(px(24), px(4), px(24), 0)
        self._card_head.setSpacing(px(12))
        for one in (self.patients, self.sessions, self._nobody):
            one.setMinimumHeight(px(LIST_AT_LEAST))
        self._sessions_title.setMinimumHeight(px(44))
        self._none_yet.setMinimumHeight(px(96))
        self._list_card.setMinimumWidth(px(PATIENTS_AT_LEAST))


class _Empty(Themed):
    """What stands in the list's place: nobody yet, or nobody who is searched for."""

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self._sentence = Text(look, size=16, weight=SEMIBOLD, wraps=True)
        self._sentence.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.new_patient = Button(look, tr("New patient"), ButtonKind.PRIMARY, Icon.ADD)
        self.demonstration = Button(look, tr("Open demonstration"), ButtonKind.QUIET, Icon.PLAY)
        self._column = QVBoxLayout(self)
        self._column.addStretch(1)
        self._column.addWidget(self._sentence)
        self._column.addWidget(self.new_patient, 0, Qt.AlignmentFlag.AlignHCenter)
        self._column.addWidget(self.demonstration, 0, Qt.AlignmentFlag.AlignHCenter)
        self._column.addStretch(1)
        self._on_look_changed()

    @property
    def buttons(self) -> list[QWidget]:
        return [self.new_patient, self.demonstration]

    def show_reason(self, are_there_others: bool) -> None:
        self._sentence.setText(
            tr("Nobody is found. Search for less, or add a new patient.")
            if are_there_others
            else tr("No patients yet. Add a new patient, or open the demonstration.")
        )
        self.demonstration.setVisible(not are_there_others)

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self._column.setContentsMargins(px(2), px(24), px(2), px(24))
        self._column.setSpacing(px(16))


class _Search(QLineEdit):
    """The search, with its sign and its key inside."""

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self.setAccessibleName(tr("Search patients"))
        self.setPlaceholderText(tr("Code, year, device"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        look.changed.connect(self._on_look_changed)
        self.textChanged.connect(self._on_look_changed)
        self._on_look_changed()

    def sizeHint(self) -> QSize:
        return QSize(self._look.theme.px(200), self._look.theme.px(SEARCH_HEIGHT))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def paintEvent(self, event: QPaintEvent) -> None:
        super().paintEvent(event)
        theme = self._look.theme
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        side = px(22)
        paint_icon(painter, Icon.SEARCH, QRectF(px(14), (self.height() - side) / 2, side, side), c.ink2)
        if cap := self._cap():
            theme.paint_cap(painter, cap, tr("Ctrl F"), c.ink2, c.control)

    def _cap(self) -> QRectF | None:
        """The place of the key cap, where it leaves room for the words."""
        theme = self._look.theme
        width = QFontMetrics(theme.font(12, MEDIUM)).horizontalAdvance(tr("Ctrl F")) + theme.px(16)
        words = QFontMetrics(theme.font(16)).horizontalAdvance(self.placeholderText())
        if self.text() or self.width() < words + width + theme.px(84):
            return None
        return QRectF(self.width() - width - theme.px(14), (self.height() - theme.px(22)) / 2, width, theme.px(22))

    def _on_look_changed(self) -> None:
        theme = self._look.theme
        self.setFont(theme.font(16))
        self.setTextMargins(theme.px(44) - 1, 0, theme.px(12) - 1, 0)  # the frame of a line is 1 px wide
        self.updateGeometry()
        self.update()
