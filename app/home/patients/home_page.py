"""Find the patient, begin: patients at the left with a search, the one that is chosen at the right."""

from collections.abc import Sequence
from itertools import pairwise
from uuid import UUID

from PySide6.QtCore import QEvent, QModelIndex, QObject, QRectF, Qt, Signal
from PySide6.QtGui import QFontMetrics, QKeyEvent, QKeySequence, QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QApplication,
    QHBoxLayout,
    QLineEdit,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from app.home.patients.home_empty import EmptyLibrary
from app.home.patients.patient_panel import PatientPanel
from app.summary.course_lanes import CourseVisit
from app.summary.course_words import NextStep
from app.theme.current import NO_LIMIT, current_theme, on_theme, scaled
from app.theme.icons import Icon, paint_icon
from app.widgets.lay_out import lay_out
from app.widgets.line_list import PATIENT_ROW, Line, LineList, PatientLine, SessionLine
from app.widgets.reading_area import scrolled
from app.widgets.segmented import Segmented
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.translation import tr, tr_n
from core.goals import Goal

SEARCH_HEIGHT = 44
EDGE, GUTTER = 24, 24
LIST, WIDE_LIST = 260, 320
WIDE_FROM = 1400  # px of the design: the list takes more
ONE_BELOW = 860  # the list or the patient
PANEL_AT_LEAST = 320
PATIENTS, PATIENT = "patients", "patient"


class HomePage(QWidget):
    """Knows lines and ids. Typing narrows the list down; the arrow keys choose from it while typing goes on.

    Where there is little room, the list or the patient is in sight.
    """

    patient_chosen = Signal(object)  # UUID or None
    session_opened = Signal(object)  # UUID
    new_session_requested = Signal()  # Enter
    demonstration_requested = Signal()
    patient_deleted = Signal(object)  # UUID: by key or menu
    session_deleted = Signal(object)
    video_withdrawn = Signal(object)  # the UUID of a patient whose consent is to be taken back

    def __init__(self) -> None:
        super().__init__()
        self._patients: Sequence[PatientLine] | None = None  # not read yet
        self._is_single = False
        self._title = Text(tr("Patients"), size=26, weight=SEMIBOLD)
        self._count = Text(tone="ink2")
        self.search = _Search()
        self.patients = LineList(tr("Patients"), row=PATIENT_ROW, chosen_on="surface")
        self.nobody = Text(tr("No patient found. Shorten the search, or add a new patient."), wraps=True)
        self.empty = EmptyLibrary()
        self.panel = PatientPanel()
        self._panel_room = scrolled(self.panel)
        self.view = Segmented(tr("View"), [(PATIENTS, tr("Patients"), ""), (PATIENT, tr("Patient"), "")])
        self._build()
        self._connect()
        for before, after in pairwise(self.tab_order):
            self.setTabOrder(before, after)
        self.forget_patients()
        self.show_patient("", "")
        self.set_room(WIDE_FROM - 1)

    @property
    def patient_id(self) -> UUID | None:
        """The patient who is chosen."""
        line = self.patients.line
        return line.id if line is not None else None

    @property
    def sessions(self) -> LineList:
        """Those of the patient who is chosen."""
        return self.panel.sessions

    @property
    def is_empty(self) -> bool:
        """Whether the library was read and has no patient."""
        return self._patients is not None and not self._patients

    @property
    def tab_order(self) -> list[QWidget]:
        return [*self.view.segments, self.search, self.patients, *self.panel.tab_order, *self.empty.buttons]

    def focus(self) -> None:
        (self.empty.new_patient if self.is_empty else self.search).setFocus()

    def forget_patients(self) -> None:
        """Show nobody, and do not say that there is nobody: the library has still to be read."""
        self._patients = None
        self._filter(None)
        self.forget_sessions()

    def change_patient(self, line: PatientLine) -> None:
        """Show one patient's line as it is now, wherever it is."""
        self._patients = tuple(line if one.id == line.id else one for one in self._patients or ())
        self.patients.replace_line(line)

    def forget_sessions(self) -> None:
        """Show no session, and do not say that there is none: those of another patient are still to be read."""
        self.show_sessions(())
        self.panel.none_yet.hide()

    def show_patients(self, lines: Sequence[PatientLine], chosen: UUID | None = None) -> None:
        """Show all patients there are, with one of them chosen, else the first that the search lets through."""
        focused = QApplication.focusWidget()
        is_left = focused is not None and self.empty.isAncestorOf(focused)
        was_read = self._patients is not None
        self._patients = tuple(lines)
        self._filter(chosen, stays=was_read and chosen in (None, self.patient_id))
        if is_left and not self.is_empty:  # what had the focus has gone, and Qt would give it to what is next to it
            self.focus()

    def show_patient(self, code: str, person: str) -> None:
        """Say whose sessions stand at the right; nobody's where there is no code."""
        self.panel.show_patient(code, person)
        self.view.set_word(PATIENT, code or tr("Patient"))
        self._show_parts()

    def show_sessions(
        self,
        lines: Sequence[SessionLine],
        visits: Sequence[CourseVisit] = (),
        step: NextStep | None = None,
        goals: Sequence[Goal] = (),
        *,
        is_simulated: bool = False,
        has_video_consent: bool = False,
    ) -> None:
        """Show sessions, the course over those that are visits with a day, what is next, and what was agreed."""
        self.panel.show_sessions(lines, is_simulated=is_simulated, has_video_consent=has_video_consent)
        self.panel.show_course(visits, goals)
        self.panel.show_next(step)

    def set_room(self, width: float, *, is_compact: bool = False) -> None:
        """Lay out for a page of this width, in px of the design."""
        self._is_single = is_compact or width < ONE_BELOW
        self.empty.set_room(width)
        of_list = WIDE_LIST if width >= WIDE_FROM else LIST
        scaled(self._left_room.setMinimumWidth, of_list)
        scaled(self._left_room.setMaximumWidth, NO_LIMIT if self._is_single else of_list)
        inside = width - 2 * EDGE
        self.panel.set_room(inside if self._is_single else inside - GUTTER - of_list)
        self._show_parts()

    def event(self, event: QEvent) -> bool:
        """Ask for the height that words take in this width: what scrolls round the page asks for the least only."""
        is_done = super().event(event)
        if event.type() in (QEvent.Type.LayoutRequest, QEvent.Type.Resize):
            self.setMinimumHeight(max(0, self._page.minimumHeightForWidth(self.width())))
        return is_done

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
                self.new_session_requested.emit()
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
        heading = lay_out(QHBoxLayout(), (self._title, 1), (self._count, 0, Qt.AlignmentFlag.AlignBottom))
        self._left_room = QWidget()
        self._left = QVBoxLayout(self._left_room)
        lay_out(self._left, heading, self.search, (self.patients, 1), (self.nobody, 1), margins=0, spacing=12)
        self._both = QWidget()
        self._columns = lay_out(
            QHBoxLayout(self._both), self._left_room, (self._panel_room, 1), margins=0, spacing=GUTTER
        )
        self._empty_title = Text(tr("Patients"), size=26, weight=SEMIBOLD)
        self._page = QVBoxLayout(self)
        self._page.addWidget(self.view, 0, Qt.AlignmentFlag.AlignLeft)
        lay_out(
            self._page, self._empty_title, (self.empty, 1), (self._both, 1), margins=(EDGE, 12, EDGE, 12), spacing=12
        )
        scaled(self._panel_room.setMinimumSize, PANEL_AT_LEAST, PANEL_AT_LEAST)

    def _connect(self) -> None:
        self.search.textChanged.connect(self._on_searched)
        self.patients.chosen.connect(self._on_patient_chosen)
        self.patients.opened.connect(self._on_patient_opened)
        self.patients.clicked.connect(self._on_patient_clicked)
        self.view.chosen.connect(self._show_parts)
        self.sessions.opened.connect(self.session_opened)
        self.sessions.selectionModel().currentRowChanged.connect(self._show_row)
        self.panel.course.visit_opened.connect(self.session_opened)
        self.panel.delete_patient.triggered.connect(self._on_delete_patient)
        self.panel.delete_session.triggered.connect(self._on_delete_session)
        self.panel.withdraw_video.triggered.connect(self._on_withdraw_video)
        self.empty.demonstration.clicked.connect(self.demonstration_requested)
        for watched in (self.search, self.patients, self.sessions):
            watched.installEventFilter(self)

    def _show_row(self, index: QModelIndex, _before: QModelIndex) -> None:
        """Have the visit in force in sight, where somebody moves among them."""
        if index.isValid() and self.sessions.hasFocus():
            row = self.sessions.visualRect(index)
            centre = self.sessions.viewport().mapTo(self.panel, row.center())
            self._panel_room.ensureVisible(centre.x(), centre.y(), 0, row.height())

    def _show_parts(self) -> None:
        """The list, the patient, or both; of an empty library neither."""
        is_single, has_any = self._is_single, not self.is_empty
        self.empty.setVisible(not has_any)
        self._empty_title.setVisible(not has_any)
        self._both.setVisible(has_any)
        self.view.setVisible(is_single and has_any)
        self._title.setVisible(not is_single)
        self._left_room.setVisible(not is_single or self.view.choice == PATIENTS)
        self._panel_room.setVisible(not is_single or self.view.choice == PATIENT)

    def _filter(self, chosen: UUID | None, *, stays: bool = False) -> None:
        required = self.search.text().strip().casefold().split()
        found: list[Line] = [line for line in self._patients or () if all(word in line.searched for word in required)]
        ids = {line.id for line in found}
        before = self.patient_id
        if chosen not in ids:
            chosen = before if before in ids else found[0].id if found else None
        self.patients.show_lines(found, chosen, stays=stays)
        self._count.setText(str(len(found)) if self._patients else "")
        self._count.setAccessibleName(tr_n("{count} patient", "{count} patients", len(found)).format(count=len(found)))
        self.patients.setVisible(bool(found))
        self.nobody.setVisible(not found and bool(self._patients))
        self._show_parts()
        if self.patient_id is None:
            self.patient_chosen.emit(None)

    def _on_searched(self, _text: str) -> None:
        self._filter(None)

    def _on_patient_chosen(self, patient_id: UUID | None) -> None:
        if patient_id is not None:
            self.patient_chosen.emit(patient_id)

    def _on_patient_clicked(self, _index: QModelIndex) -> None:
        if self._is_single:
            self.view.choose(PATIENT)

    def _on_patient_opened(self, _patient_id: UUID) -> None:
        self.new_session_requested.emit()

    def _on_delete_patient(self) -> None:
        if self.patient_id is not None:
            self.patient_deleted.emit(self.patient_id)

    def _on_delete_session(self) -> None:
        line = self.sessions.line
        if line is not None:
            self.session_deleted.emit(line.id)

    def _on_withdraw_video(self) -> None:
        if self.patient_id is not None:
            self.video_withdrawn.emit(self.patient_id)


class _Search(QLineEdit):
    """The search, with its sign and its key inside."""

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName(tr("Search patients"))
        self.setPlaceholderText(tr("Code, year, device"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        scaled(self.setFixedHeight, SEARCH_HEIGHT)
        on_theme(self._apply_theme)

    def paintEvent(self, event: QPaintEvent) -> None:
        super().paintEvent(event)
        theme = current_theme()
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        side = px(22)
        paint_icon(painter, Icon.SEARCH, QRectF(px(14), (self.height() - side) / 2, side, side), c.ink2)
        if cap := self._cap():
            theme.paint_cap(painter, cap, tr("Ctrl F"), c.ink2, c.control)

    def _cap(self) -> QRectF | None:
        """The place of the key cap, where it leaves room for the words."""
        theme = current_theme()
        width = QFontMetrics(theme.font(12, MEDIUM)).horizontalAdvance(tr("Ctrl F")) + theme.px(16)
        words = QFontMetrics(theme.font(16)).horizontalAdvance(self.placeholderText())
        if self.text() or self.width() < words + width + theme.px(84):
            return None
        return QRectF(self.width() - width - theme.px(14), (self.height() - theme.px(22)) / 2, width, theme.px(22))

    def _apply_theme(self) -> None:
        theme = current_theme()
        self.setFont(theme.font(16))
        self.setTextMargins(theme.px(44) - 1, 0, theme.px(12) - 1, 0)  # the frame of a line is 1 px wide
