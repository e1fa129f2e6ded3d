"""Home: whose sessions are in the library, what begins from here, what comes in, what goes out of sight for 30 days."""

from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeySequence, QResizeEvent, QShortcut
from PySide6.QtWidgets import QHBoxLayout, QScrollArea, QStackedWidget, QVBoxLayout, QWidget

from app.home.again.analyse_again_page import AnalyseAgainPage
from app.home.again.controller import AnalysingAgain
from app.home.cohort.cohort_page import QuestionsPage
from app.home.cohort.controller import Questions
from app.home.goals.controller import GoalsOfPatient
from app.home.goals.goals_page import GoalsPage
from app.home.importing.controller import Importing
from app.home.importing.import_page import ImportPage
from app.home.patients.controller import PatientsAtHome
from app.home.patients.courses import ComputingCourses
from app.home.patients.deleting import Deleting
from app.home.patients.demonstration import FillingDemonstration
from app.home.patients.home_page import HomePage
from app.home.patients.notices import LibraryNotices
from app.home.patients.recovering import Recovering
from app.home.patients.withdrawing import Withdrawing
from app.home.repeatability.controller import Repeatability
from app.home.repeatability.repeatability_page import RepeatabilityPage
from app.home.settings.controller import SettingsController
from app.home.settings.settings_page import SettingsPage
from app.summary.course_words import NextKind, NextStep
from app.system.settings import Scheme, Settings
from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.icons import Icon
from app.widgets.action_bar import ActionBar, BarAction, BarState
from app.widgets.banner import Banner
from app.widgets.grid import COMPACT_BELOW
from app.widgets.lay_out import lay_out
from app.widgets.rail_row import RailForm, RailRow, StepState
from app.widgets.reading_area import scrolled
from app.widgets.start_pages import WorkingPage
from app.widgets.step_rail import StepRail, home_below
from app.widgets.toast import Toast
from app.wording.findings import place
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from app.workers.library_state import OpenedState
from app.workers.long_work import LongWork

WIDE_FROM = 1800
PATIENTS, DEMONSTRATION, IMPORT, QUESTIONS = range(4)


class Home(QWidget):
    session_requested = Signal(object)  # the StoredPatient of a new session, or None: a new patient
    session_opened = Signal(object)  # UUID
    report_requested = Signal(object)  # UUID of the session
    demonstration_requested = Signal()
    own_library_requested = Signal()  # from the demonstration back
    lock_requested = Signal()
    help_requested = Signal(str)
    settings_left = Signal()

    def __init__(self, controller: LibraryController, settings: Settings) -> None:
        super().__init__()
        self._controller, self._settings = controller, settings
        self.state: OpenedState | None = None
        self.rail = StepRail()
        self.banner = Banner()
        self.notices = LibraryNotices(controller, self)
        self.recovering = Recovering(controller, self.banner, self)
        self.page = HomePage()
        self.importing = Importing(controller, self)
        self._settings_controller: SettingsController | None = None
        self._questions: Questions | None = None
        self._again: AnalysingAgain | None = None
        self._goals: GoalsOfPatient | None = None
        self._repeatability: Repeatability | None = None
        self.working = WorkingPage()
        self.bar = ActionBar()
        self.toast = Toast(self)
        self.deleting = Deleting(controller, self)
        self.withdrawing = Withdrawing(controller, self)
        self.computing = ComputingCourses(controller, self)
        self.filling = FillingDemonstration(controller, self)
        self.patients = PatientsAtHome(controller, self.page, self.filling.is_awaited, self)
        self._build()
        self._connect()
        self._go_to(self.page)
        scaled(self._banner_row.setContentsMargins, 24, 0, 24, 0)
        on_theme(self._fit)

    @property
    def settings(self) -> SettingsController:
        """The settings, made when they are first asked for: beside the rest of home they would hold up the screen."""
        return self._settings_controller or self._make_settings()

    @property
    def questions(self) -> Questions:
        """The questions over many sessions, made when they are first asked for, as the settings are."""
        return self._questions or self._make_questions()

    @property
    def again(self) -> AnalysingAgain:
        """What is analysed again, made when it is first asked for."""
        if self._again is None:
            made = self._again = AnalysingAgain(self._controller, self)
            self._add_page(made.page)
            made.changed.connect(self._show)
            self._follow(made)
            made.done.connect(self._on_analysed_again)
            made.table_made.connect(self._on_table_made)
        return self._again

    @property
    def goals(self) -> GoalsOfPatient:
        """The goals of the patient, made when they are first asked for."""
        if self._goals is None:
            made = self._goals = GoalsOfPatient(self._controller, self)
            self._add_page(made.page)
            made.kept.connect(self.patients.read)
            made.reported.connect(self.banner.show_message)
            self._fit()
        return self._goals

    @property
    def repeatability(self) -> Repeatability:
        """The clinic's own error figures, made when they are first asked for."""
        if self._repeatability is None:
            made = self._repeatability = Repeatability(self._controller, self)
            self._add_page(made.page)
            made.changed.connect(self._show)
            self._follow(made)
            made.done.connect(self._show_repeatability)
            made.chosen.connect(self.patients.read)
        return self._repeatability

    def prepare(self) -> bool:
        """Make the next part before somebody asks for it; whether there was one."""
        if self._settings_controller is None:
            self._make_settings()
        elif self._questions is None:
            self._make_questions()
        else:
            return False
        return True

    def finish(self) -> None:
        """Wait for what runs, when the window was closed."""
        self.filling.stop()
        self.importing.finish()
        if self._questions is not None:
            self._questions.finish()

    def _make_settings(self) -> SettingsController:
        made = self._settings_controller = SettingsController(self._controller, self._settings, self)
        self._add_page(made.page)
        made.reported.connect(self.banner.show_message)
        made.restored.connect(self.patients.read)
        made.moved.connect(self._on_moved)
        self.deleting.undone.connect(made.read_deleted)
        if self.state is not None:
            made.show_library(self.state)
        return made

    def _make_questions(self) -> Questions:
        made = self._questions = Questions(self._settings, self)
        self._add_page(made.page)
        made.changed.connect(self._show)
        made.reported.connect(self.banner.show_message)
        made.again_requested.connect(self._begin_again)
        made.repeatability_requested.connect(self._begin_repeatability)
        made.making_requested.connect(self._on_table_requested)
        self._fit()
        return made

    def show_library(self, state: OpenedState) -> None:
        """Show a library that was just opened, and bring back what was being recorded when it was last in use."""
        self.state = state
        self.banner.hide()
        self.patients.forget()
        if self._settings_controller is not None:
            self._settings_controller.show_library(state)
        if state.is_end_lost:
            self.banner.show_message(
                tr("The library was not closed properly. The data saved last are damaged."),
                tr("Check the latest session."),
            )
        self.notices.show(state)
        self.recovering.begin(state)
        self.filling.begin(state)
        self.patients.read()
        self._go_to(self.page)

    def clear(self) -> None:
        """Keep nothing of any patient, for whoever comes next."""
        self.state = None
        if self._again is not None:
            self._again.page.forget()
        if self._goals is not None:
            self._goals.forget()
        if self._repeatability is not None:
            self._repeatability.forget()
        self.importing.forget()
        self.filling.stop()
        if self._questions is not None:
            self._questions.forget()
        self.deleting.forget()
        self.toast.hide()
        self.banner.hide()
        self.notices.forget()
        self.patients.forget()

    def _on_moved(self, state: OpenedState) -> None:
        self.state = state
        self._show()
        self.patients.read()

    def show_settings(self) -> None:
        self.settings.read()
        self._go_to(self.settings.page)

    def escape(self) -> None:
        """End what runs, else go back to the patients, else search no longer."""
        if self.current is self.working:
            self._on_stop()
        elif self.current is not self.page:
            self._on_back()
        else:
            self.page.search.clear()

    def focus(self) -> None:
        page = self.current
        if isinstance(
            page,
            AnalyseAgainPage | GoalsPage | HomePage | ImportPage | RepeatabilityPage | SettingsPage | QuestionsPage,
        ):
            page.focus()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def _build(self) -> None:
        self._pages = QStackedWidget()
        for page in (self.page, self.importing.page, self.working):
            self._add_page(page)
        self._banner_row = lay_out(QVBoxLayout(), self.notices.rollback, self.notices.away, self.banner)
        column = lay_out(QVBoxLayout(), self._banner_row, (self._pages, 1), self.filling.strip, self.bar, spacing=0)
        lay_out(QHBoxLayout(self), self.rail, (column, 1), margins=0, spacing=0)

    def _add_page(self, page: QWidget) -> None:
        self._pages.addWidget(scrolled(page, is_upright=False))

    def _connect(self) -> None:
        page = self.page
        self.patients.chosen.connect(self._show)
        self.patients.refused.connect(self.banner.show_message)
        page.session_opened.connect(self.session_opened)
        page.new_session_requested.connect(self._begin_session)
        page.empty.new_patient.clicked.connect(self._on_new_patient)
        page.demonstration_requested.connect(self.demonstration_requested)
        page.empty.importing.clicked.connect(self.importing.begin)
        page.panel.course.computing_requested.connect(self._on_computing_requested)
        page.panel.analyse_again.triggered.connect(self._begin_again)
        page.panel.goals.clicked.connect(self._begin_goals)
        page.panel.next_requested.connect(self._take_next)
        page.patient_deleted.connect(self.deleting.patient)
        page.session_deleted.connect(self.deleting.session)
        page.video_withdrawn.connect(self.withdrawing.ask)
        self.withdrawing.done.connect(self.patients.read)
        self.withdrawing.refused.connect(self.banner.show_message)
        self.rail.step_pressed.connect(self._on_rail_pressed)
        self.rail.below_pressed.connect(self._on_below_pressed)
        self.bar.pressed.connect(self._on_bar_pressed)
        self.bar.back_pressed.connect(self._on_back)
        self.importing.page.code.edited.connect(self._show)
        self.importing.page.changed.connect(self._show)
        self._follow(self.importing)
        self.importing.asked.connect(self._on_import_asked)
        self.importing.left.connect(self._on_import_left)
        self.importing.imported.connect(self.patients.read)
        self.importing.reported.connect(self.banner.show_message)
        self.working.stop.clicked.connect(self._on_stop)
        self.recovering.recovered.connect(self.patients.read)
        self.notices.away.acted.connect(self.own_library_requested)
        self.notices.refused.connect(self.banner.show_message)
        self._follow(self.computing)
        self.computing.left.connect(self._on_computing_left)
        self.computing.reported.connect(self.banner.show_message)
        self.filling.changed.connect(self.patients.read)
        self.filling.reported.connect(self.banner.show_message)
        self.toast.undone.connect(self.deleting.undo)
        self.deleting.done.connect(self._on_deleted)
        self.deleting.undone.connect(self.patients.read)
        self.deleting.refused.connect(self.banner.show_message)
        here, in_sight = Qt.ShortcutContext.WidgetWithChildrenShortcut, Qt.ShortcutContext.WindowShortcut
        for keys, slot, context in (
            ("Ctrl+F", self._on_find, here),
            ("Ctrl+N", self._on_new_patient, here),
            ("Ctrl+S", self._on_save, here),
            ("W", self._on_next, here),
            ("Alt+W", self._on_next, here),  # out of the search, which takes letters
            ("Ctrl+Z", self.toast.undo, in_sight),  # wherever the focus went from what is gone now
            ("F1", self._on_help, here),
        ):
            shortcut = QShortcut(QKeySequence(keys), self)
            shortcut.setContext(context)
            shortcut.activated.connect(slot)

    def _go_to(self, page: QWidget) -> None:
        number = next(k for k in range(self._pages.count()) if self._widget(k) is page)
        self._pages.setCurrentIndex(number)
        self._show()
        self._fit()
        self.focus()

    @property
    def current(self) -> QWidget:
        """The page in sight."""
        return self._widget(self._pages.currentIndex())

    def _widget(self, number: int) -> QWidget:
        scroll = self._pages.widget(number)
        assert isinstance(scroll, QScrollArea)
        page = scroll.widget()
        assert page is not None
        return page

    def _fit(self) -> None:
        scale = current_theme().scale
        width, height = self.width() / scale, self.height() / scale
        is_compact = width < COMPACT_BELOW[0] or height < COMPACT_BELOW[1]
        form = RailForm.COMPACT if is_compact else RailForm.WIDE if width >= WIDE_FROM else RailForm.USUAL
        self.rail.set_form(form)
        self.page.set_room(width - form.value, is_compact=is_compact)
        self.importing.page.set_room(width - form.value)
        if self._questions is not None:
            self._questions.page.set_room(width - form.value)
        if self._goals is not None:
            self._goals.page.set_room(width - form.value)
        self.bar.show_state(self._bar())
        self.toast.move(px(form.value + 24), self.height() - self.bar.height() - self.toast.height() - px(16))

    def _show(self) -> None:
        """Show what can be done from the page in sight."""
        current = self.current
        is_demonstration = self.state is not None and self.state.is_demonstration
        states = [current is self.page or self._has_goals, False, current is self.importing.page, self._is_asking]
        icons = (Icon.HOME, Icon.BACK if is_demonstration else Icon.PLAY, Icon.IMPORT, Icon.GROUPS)
        names = (
            tr("Patients"),
            tr("Leave the demonstration") if is_demonstration else tr("Open demonstration"),
            tr("Import recordings"),
            tr("Cohort"),
        )
        rows = (
            RailRow(name, state=StepState.CURRENT if is_current else StepState.TODO, icon=icon)
            for name, is_current, icon in zip(names, states, icons, strict=True)
        )
        self.rail.show_rows(tuple(rows))
        is_shared = self.state is not None and self.state.library.shared is not None
        note = tr("Everything stays on this computer, encrypted.")
        if is_shared:
            note = tr("The clinic's library, shared by its workstations.")
        elif is_demonstration:
            note = tr("Simulated, not encrypted, deleted on closing.")
        self.rail.show_below(home_below(can_lock=not is_demonstration), note)
        self.bar.show_state(self._bar())
        self.bar.setVisible(current is not self.working)

    def _bar(self) -> BarState:
        if self.current is self.importing.page:
            return self.importing.bar
        if self._is_asking:
            return self.questions.bar
        if self._again is not None and self.current is self._again.page:
            return self.again.bar
        if self._has_goals:
            return self.goals.bar
        if self._has_repeatability:
            return self.repeatability.bar
        if self.current is not self.page:
            return BarState()
        new = BarAction(tr("New patient"), self._on_new_patient, tr("Ctrl N"), Icon.ADD)
        patient = self.patients.patient
        if self.page.is_empty:
            return BarState(note=tr("No session is running."), has_back=False)
        if patient is None:
            return BarState(quiet=(new,), has_back=False)
        words = tr("New session for {code}").format(code=patient.details.code)
        begin = BarAction(words, self._begin_session, tr("Enter"), Icon.PLAY)
        return BarState(begin, quiet=(new,), has_back=False)

    @property
    def _has_goals(self) -> bool:
        return self._goals is not None and self.current is self._goals.page

    @property
    def _has_repeatability(self) -> bool:
        return self._repeatability is not None and self.current is self._repeatability.page

    @property
    def _is_asking(self) -> bool:
        return self._questions is not None and self.current is self._questions.page

    def _on_computing_requested(self) -> None:
        self.computing.begin([visit.id for visit in self.patients.visits if visit.course is None])

    def _on_computing_left(self) -> None:
        self._go_to(self.page)
        self.patients.read()

    def _on_new_patient(self) -> None:
        if self.current is self.page:
            self.session_requested.emit(None)

    def _on_bar_pressed(self, action: BarAction) -> None:
        action.run()

    def _begin_session(self) -> None:
        if self.current is self.page and self.patients.patient is not None:
            self.session_requested.emit(self.patients.patient)

    def _on_next(self) -> None:
        if self.current is self.page:
            self.page.panel.take_next()

    def _take_next(self, step: NextStep) -> None:
        match step.kind:
            case NextKind.REVIEW:
                self.session_opened.emit(step.session_id)
            case NextKind.REPORT:
                self.report_requested.emit(step.session_id)
            case NextKind.GOALS:
                self._begin_goals()
            case NextKind.SESSION:
                self._begin_session()

    def _begin_again(self) -> None:
        """Show which sessions can be analysed again: those of the patient, where home shows one."""
        self.again.begin(self.page.patient_id if self.current is self.page else None)
        self._go_to(self.again.page)
        self.bar.back.setFocus()  # until the sessions are read

    def _begin_repeatability(self) -> None:
        self.repeatability.begin(is_demonstration=self.state is not None and self.state.is_demonstration)
        self._show_repeatability()

    def _show_repeatability(self) -> None:
        self._go_to(self.repeatability.page)

    def _begin_goals(self) -> None:
        """Show what was agreed with the patient who is chosen."""
        if self.patients.patient is not None:
            self.goals.begin(self.patients.patient)
            self._go_to(self.goals.page)

    def _on_table_requested(self) -> None:
        self.again.make_table()

    def _on_analysed_again(self, what: str, then: str) -> None:
        self._go_to(self.questions.page if self.again.is_of_library else self.again.page)
        self.banner.show_message(what, then)

    def _on_table_made(self, path: Path) -> None:
        self.questions.open(path)
        self._go_to(self.questions.page)

    def _on_back(self) -> None:
        self.importing.forget()
        was_settings = isinstance(self.current, SettingsPage)
        self._go_to(self.page)
        if was_settings:
            self.settings_left.emit()

    def _on_find(self) -> None:
        if self.current is self.page:
            self.page.focus()
            self.page.search.selectAll()

    def _on_save(self) -> None:
        if self._is_asking:
            self.questions.save()

    def _on_help(self) -> None:
        topics = (
            ("questions", self._is_asking),
            ("goals", self._has_goals),
            ("repeatability", self._has_repeatability),
        )
        self.help_requested.emit(next((topic for topic, is_in_sight in topics if is_in_sight), "home"))

    def _on_rail_pressed(self, number: int) -> None:
        if self.current is self.working:
            return
        if number == PATIENTS:
            self._on_back()
        elif number == IMPORT:
            self.importing.begin()
        elif number == QUESTIONS:
            self._go_to(self.questions.page)
            self.questions.begin()
        elif self.state is not None and self.state.is_demonstration:
            self.own_library_requested.emit()
        else:
            self.demonstration_requested.emit()

    def _on_below_pressed(self, name: str) -> None:
        if name == "look":
            self._settings.scheme = Scheme.LIGHT if current_theme().is_dark else Scheme.DARK
        elif name == "lock":
            self.lock_requested.emit()
        elif name == "settings" and self.current is not self.working:
            self.show_settings()
        elif name == "help":
            self._on_help()

    # what is deleted can be had back

    def _on_deleted(self, words: str) -> None:
        self.toast.offer(words)
        self._fit()
        self.patients.read(is_deleted_here=True)

    # what comes in

    def _on_import_asked(self) -> None:
        self._go_to(self.importing.page)
        scroll = self._pages.currentWidget()
        assert isinstance(scroll, QScrollArea)
        scroll.verticalScrollBar().setValue(0)  # what is shown next is read from its beginning

    def _on_import_left(self) -> None:
        self._go_to(self.page)

    def _follow(self, work: LongWork) -> None:
        work.working.connect(self._work)
        work.progressed.connect(self._on_progressed)

    def _work(self, title: str) -> None:
        self.banner.hide()
        self.working.begin(title)
        self._go_to(self.working)
        self.working.stop.setFocus()

    def _on_progressed(self, share: float, what: str) -> None:
        words = place(what)
        self.working.show_progress(share, words[:1].upper() + words[1:])

    def _on_stop(self) -> None:
        works = (self.computing, self._again, self._repeatability)
        next((work for work in works if work is not None and work.is_working), self.importing).stop()
