"""The window: who logs in, home, a session with a patient, or a folder's; and the cover when nobody is there."""

import signal
import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

import platformdirs
from PySide6.QtCore import QEvent, QObject, QSettings, QSize, Qt, QTimer
from PySide6.QtGui import (
    QCloseEvent,
    QDragEnterEvent,
    QDragLeaveEvent,
    QDropEvent,
    QGuiApplication,
    QKeySequence,
    QResizeEvent,
    QShortcut,
    QWindow,
)
from PySide6.QtWidgets import QApplication, QStackedWidget, QVBoxLayout, QWidget

from app.help.help_topics import Topic
from app.home.login.controller import Entry
from app.home.session_screen import SessionScreen
from app.live_output.output import live_output
from app.live_output.status import OutputSettings
from app.storage.idle_lock import IdleLock
from app.storage.layout import default_folder
from app.system.qt_messages import log_qt_messages
from app.system.settings import Scheme, Settings
from app.theme.colours import DARK, LIGHT
from app.theme.current import current_theme, grow, load_fonts, on_theme, set_theme
from app.theme.ground import Ground, set_ground
from app.theme.theme import Theme
from app.widgets.accessible_role import show_roles
from app.widgets.focus_ring import FocusRing
from app.widgets.folder_dialog import keep_no_visited_folders
from app.widgets.grid import COMPACT_BELOW
from app.wording.qt import qt_speaks
from app.wording.translation import PURPOSE, tr, use_language
from app.workers.background import Background
from app.workers.garbage import GarbageCollector
from app.workers.library_controller import LibraryController
from app.workers.library_state import KeptLogIn, OpenedState
from app.workers.preload import preload

if TYPE_CHECKING:  # needed when a library is open; the window must not wait for them
    from app.help.help_page import HelpPage
    from app.home.home import Home
    from app.storage.stored import StoredPatient
    from app.wizard.wizard import Wizard

FIRST_SIZE = (1280, 800)
FRAME = (8, 40)  # what the desktop may put round a window
SMALLEST_SIZE = (640, 480)
DROP_EDGE = 2.5
POLL_MS = 1000
SWITCH_S = 0.001  # a frame needs Python several times, and waits so long each time while an analysis runs beside it
IN_ANOTHER_LANGUAGE = 90  # what the event loop ends with where the window is to be opened again
PREPARE_AFTER_MS = 200  # the first frame goes before
MAKE_EVERY_MS = 300  # of what is made before it is needed; what the user does comes between
ACTIVITY = frozenset(
    (
        QEvent.Type.KeyPress,
        QEvent.Type.MouseMove,
        QEvent.Type.MouseButtonPress,
        QEvent.Type.Wheel,
        QEvent.Type.TouchUpdate,
        QEvent.Type.TabletMove,
    )
)


class MainWindow(QWidget):
    """`library` is the folder of the user's own library, be it still to be made. None: sessions of folders only.

    `seen` is where this computer remembers how far a library had come.
    """

    def __init__(self, settings: Settings, library: Path | None = None, seen: Path | None = None) -> None:
        super().__init__()
        self._settings = settings
        self.controller = LibraryController(self, seen)
        self._home: Home | None = None
        self._wizard: Wizard | None = None
        self.preparing = Background(self)
        self._help: HelpPage | None = None
        self._before_help: QWidget | None = None
        self._covered: QWidget | None = None
        self._was_in_settings = False  # when the window before this one was closed for another language
        self._has_come_back = False  # the library, and nobody has read what was recorded meanwhile
        self._must_refresh = False  # another station did something under the cover
        self._is_dark: bool | None = None  # not yet known
        self._apply_settings()  # before there is anything to be styled again
        on_theme(self._on_theme_changed)
        self.setWindowTitle(" – ".join(("Gaitwright", tr(PURPOSE))))
        self.setAcceptDrops(True)
        self.setMinimumSize(*SMALLEST_SIZE)
        self.resize(QSize(*FIRST_SIZE).boundedTo(self.screen().availableSize() - QSize(*FRAME)))
        self.session = SessionScreen()
        self.entry = Entry(self.controller, settings, library, self) if library is not None else None
        self.screens = QStackedWidget()
        self.idle = IdleLock(time.time, self.lock)
        self._poll = QTimer(self)
        self._poll.setInterval(POLL_MS)
        self._build()
        self._connect()
        self._begin()

    @property
    def wizard(self) -> "Wizard | None":
        """Made when a visit begins, or ahead of it; none before."""
        return self._wizard

    @property
    def home(self) -> "Home | None":
        """Home; None before it is made: a library need not be open."""
        return self._home

    @property
    def is_covered(self) -> bool:
        return self._covered is not None

    def prepare(self) -> None:
        """Import beside the screen what it would wait for later."""
        self.preparing.start(preload)

    def open_folder(self, folder: Path) -> None:
        """Read and analyse a session folder in the background, and show what comes of it."""
        self._show(self.session)
        self.session.open_folder(folder)

    def open_demonstration(self) -> None:
        """Open the demonstration's library; where there is none of one's own, let the simulated patient walk."""
        if self.entry is None:
            self._show(self.session)
            self.session.open_demonstration()
        else:
            self.entry.open_demonstration()

    def go_on(self, kept: KeptLogIn) -> None:
        """Go on where the window before this one was closed for another language: in the settings."""
        if self.entry is not None:
            self._was_in_settings = True
            self.entry.go_on(kept)

    def closeEvent(self, event: QCloseEvent) -> None:
        if self._wizard is not None:
            self._wizard.close_visit()
        live_output.stop()
        self._poll.stop()
        self.session.stop()
        event.accept()

    def finish(self, *, must_keep: bool = False) -> KeptLogIn | None:
        """Wait for the threads of what was running when the window was closed; `must_keep`: see the controller's."""
        self.preparing.finish()
        self.session.finish()
        if self._home is not None:
            self._home.finish()
        kept = self.controller.finish(must_keep=must_keep)
        if self._wizard is not None:
            self._wizard.finish()
        return kept

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if event.mimeData().hasUrls() and self._takes_folders:
            event.acceptProposedAction()
            self._drop_frame.cover()

    def dragLeaveEvent(self, _event: QDragLeaveEvent) -> None:
        self._drop_frame.hide()

    def dropEvent(self, event: QDropEvent) -> None:
        self._drop_frame.hide()
        if self._takes_folders:
            event.acceptProposedAction()
            self._show(self.session)
            self.session.open_dropped(event.mimeData().urls())

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Note what the user does, by the desktop window's events: the application has a hundred times as many."""
        if event.type() in ACTIVITY:
            self.idle.note_activity()
        return False

    def _build(self) -> None:
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.screens)
        self.screens.addWidget(self.session)
        if self.entry is not None:
            for page in self.entry.pages:
                self.screens.addWidget(page)
        FocusRing(self)
        self._drop_frame = _DropFrame(self)

    def _connect(self) -> None:
        self.session.left.connect(self._on_session_left)
        self.preparing.done.connect(self._on_prepared)
        self._settings.changed.connect(self._apply_settings)
        QGuiApplication.styleHints().colorSchemeChanged.connect(self._apply_settings)
        self.session.demonstration_requested.connect(self.open_demonstration)
        for keys, slot in (
            (QKeySequence.StandardKey.Open, self._on_open),
            ("Ctrl+D", self._on_demonstration),
            (Qt.Key.Key_Escape, self._on_escape),
            ("Ctrl++", self._on_larger),
            ("Ctrl+=", self._on_larger),
            ("Ctrl+-", self._on_smaller),
            ("Ctrl+0", self._on_usual_size),
        ):
            QShortcut(QKeySequence(keys), self).activated.connect(slot)
        if self.entry is None:
            return
        self.entry.shown.connect(self._show)
        self.entry.entered.connect(self._on_entered)
        self.entry.uncovered.connect(self._on_uncovered)
        self.entry.left.connect(self._log_out)
        self.entry.first_start.demonstration_requested.connect(self.open_demonstration)
        self.entry.log_in.demonstration_requested.connect(self.open_demonstration)
        self.entry.join.demonstration_requested.connect(self.open_demonstration)
        self.controller.refused.connect(self._on_reported)
        self.controller.gone.connect(self._on_library_gone)
        self.controller.back.connect(self._on_library_back)
        self.controller.changed_elsewhere.connect(self._on_changed_elsewhere)
        self._poll.timeout.connect(self._on_poll)
        app = QApplication.instance()
        if isinstance(app, QApplication):
            app.focusWindowChanged.connect(self._on_focus_window_changed)
        self._poll.start()

    def _begin(self) -> None:
        if self.entry is not None:
            self.session.set_way_back(True)
            self.entry.begin()

    def _show(self, screen: QWidget) -> None:
        self.screens.setCurrentWidget(screen)
        if self.entry is not None and screen in self.entry.pages:
            self.entry.focus(screen)
        elif screen is self._home and self._home is not None:
            self._home.focus()
        elif screen is self._help and self._help is not None:
            self._help.text.setFocus()

    @property
    def _takes_folders(self) -> bool:
        """Whether a folder may take the place of what is in sight: not of a visit, nor of the cover or a question."""
        if self.entry is not None and self.entry.is_settling:
            return False
        return not self.is_covered and (self._wizard is None or self._wizard.visit is None)

    @property
    def _is_recording(self) -> bool:
        return self._wizard is not None and self._wizard.is_recording

    def _show_help(self, topic: str) -> None:
        """Open the manual at a topic; Back leads to where it was opened, and what is recorded there goes on."""
        from app.help.help_page import HelpPage  # most never open it

        if self._help is None:
            self._help = HelpPage()
            self.screens.addWidget(self._help)
            self._help.closed.connect(self._on_help_closed)
            self._fit()
        if self.screens.currentWidget() is not self._help:
            self._before_help = self.screens.currentWidget()
        self._help.show_topic(Topic(topic) if topic in set(Topic) else Topic.HOME)
        self._show(self._help)

    def _on_help_closed(self) -> None:
        before, self._before_help = self._before_help, None
        if before is not None:
            self._show(before)

    # a library is open

    def _on_prepared(self) -> None:
        """Make what was imported before somebody waits for it, one thing at a time."""
        if self.entry is None or (self._home is not None and self._wizard is not None):
            return
        if self._home is None:
            self._made_home()
        elif not self._home.prepare():
            self._made_wizard()
        QTimer.singleShot(MAKE_EVERY_MS, self, self._on_prepared)

    def _made_home(self) -> "Home":
        if self._home is None:
            from app.home.home import Home  # numpy, SciPy, SQLAlchemy

            self._home = Home(self.controller, self._settings)
            self.screens.addWidget(self._home)
            self._home.session_requested.connect(self._on_session_requested)
            self._home.session_opened.connect(self._on_session_opened)
            self._home.report_requested.connect(self._on_report_requested)
            self._home.demonstration_requested.connect(self.open_demonstration)
            self._home.own_library_requested.connect(self._on_own_library_requested)
            self._home.help_requested.connect(self._show_help)
            self._home.lock_requested.connect(self.idle.lock_now)
            self._home.settings_left.connect(self._on_settings_left)
        return self._home

    def _on_entered(self, state: OpenedState) -> None:
        home = self._made_home()
        self.idle.unlock()
        home.show_library(state)
        if self._was_in_settings:
            home.show_settings()
        self._was_in_settings = False
        self._show(home)
        if self._wizard is None:
            self.prepare()

    def _on_session_requested(self, patient: "StoredPatient | None") -> None:
        self._entered_wizard().begin(patient)

    def _on_session_opened(self, session_id: UUID) -> None:
        self._entered_wizard().show_session(session_id)

    def _on_report_requested(self, session_id: UUID) -> None:
        self._entered_wizard().show_session(session_id, is_for_report=True)

    def _entered_wizard(self) -> "Wizard":
        """The wizard, in sight: the one place where a session with a patient is entered."""
        wizard = self._made_wizard()
        self._show(wizard)
        return wizard

    def _made_wizard(self) -> "Wizard":
        if self._wizard is None:
            from app.wizard.wizard import Wizard  # pyqtgraph, and all steps

            self._wizard = Wizard(self.controller, self._settings)
            self.screens.addWidget(self._wizard)
            self._wizard.left.connect(self._on_wizard_left)
            self._wizard.settings_required.connect(self._on_settings_required)
            self._wizard.help_required.connect(self._show_help)
        return self._wizard

    def _on_wizard_left(self) -> None:
        if self._home is not None:
            self._home.patients.read()
            self._show(self._home)

    def _on_settings_required(self) -> None:
        """Show the settings; Back leads to the visit again."""
        if self._home is not None:
            self._home.show_settings()
            self._show(self._home)

    def _on_settings_left(self) -> None:
        if self._wizard is not None and self._wizard.visit is not None:
            self._show(self._wizard)

    def _on_own_library_requested(self) -> None:
        """From the demonstration, back into the library of whoever is still logged in."""
        if self.entry is None or self.controller.kept is None:
            self._log_out()
            return
        self._clear()
        self.entry.go_on()

    def _clear(self) -> None:
        self._covered = self._before_help = None
        if self._wizard is not None:
            self._wizard.close_visit()
            self._wizard.asked.forget()
        if self._home is not None:
            self._home.clear()

    def _log_out(self) -> None:
        self._clear()
        self.controller.close()
        if self.entry is not None:
            self.entry.begin()

    def _on_session_left(self) -> None:
        if self._home is not None and self.controller.state is not None:
            self._show(self._home)
        elif self.entry is not None:
            self.entry.begin()

    def _on_reported(self, what: str, remedy: str) -> None:
        if self._home is not None and self.controller.state is not None:
            self._home.banner.show_message(what, remedy)
        elif self.entry is not None:
            self.entry.show_message(what, remedy)

    def _on_library_gone(self, what: str, then: str) -> None:
        """Show it at home and on the cover; a visit shows it itself."""
        if self._home is not None:
            self._home.banner.show_message(what, then)
        if self.entry is not None and self.is_covered:
            self.entry.show_message(what, then)

    def _on_library_back(self, what: str, then: str) -> None:
        self._on_library_gone(what, then)
        self._has_come_back = True
        self._on_changed_elsewhere()  # what others did meanwhile was not received
        if not self.is_covered:
            self._recover_what_came_home()

    def _on_changed_elsewhere(self) -> None:
        """Another station of the clinic did something: what is on the screen of it is read again."""
        self._must_refresh = self.is_covered  # under the cover it waits for the passphrase
        if self._home is None or self.is_covered:
            return
        self._home.patients.read()
        if self._wizard is not None:
            self._wizard.look_for_changes()

    def _recover_what_came_home(self) -> None:
        """Read it, which needs the key: under the cover it waits for the passphrase."""
        is_due, self._has_come_back = self._has_come_back, False
        if is_due and self._home is not None and (self._wizard is None or self._wizard.visit is None):
            self._home.recovering.look_again()  # else the visit reads its own recordings back

    # nobody is there

    def _on_focus_window_changed(self, window: QWindow | None) -> None:
        """Listen in whichever window the user works in, be it a dialog's."""
        if window is not None:
            window.installEventFilter(self)
            self.idle.note_activity()

    def _on_poll(self) -> None:
        self.idle.poll()
        if self.entry is not None:
            if self.is_covered:
                self.entry.show_recording(self._is_recording)
            self.entry.look_again()

    def lock(self) -> None:
        """Cover what the library shows; a recording goes on under it."""
        state = self.controller.state
        if self.entry is None or state is None or state.is_demonstration:
            if state is not None:
                # the demonstration goes on; the library behind it asks for its passphrase
                self.controller.call(lambda holder: holder.forget(), None, None, self)
            self.idle.unlock()
            return
        self._covered = self.screens.currentWidget()
        if self._home is not None:
            self._home.deleting.close_dialog()
        if self._wizard is not None:
            self._wizard.asked.cover(is_covered=True)
        self.entry.cover(state.operator.code, self._is_recording, is_asked_for=self.idle.is_asked_for)
        if self.controller.gone_words is not None:
            self.entry.show_message(*self.controller.gone_words)
        self.controller.lock()

    def _on_uncovered(self) -> None:
        covered, self._covered = self._covered, None
        self.idle.unlock()
        if covered is not None:
            self._show(covered)
        if self._wizard is not None:
            self._wizard.asked.cover(is_covered=False)
        if self._must_refresh:
            self._on_changed_elsewhere()
        self._recover_what_came_home()

    # how it looks

    def _apply_settings(self) -> None:
        scheme, system = self._settings.scheme, QGuiApplication.styleHints().colorScheme()
        is_dark = scheme is Scheme.DARK or (scheme is Scheme.SYSTEM and system is Qt.ColorScheme.Dark)
        theme = replace(current_theme(), scale=self._settings.scale, has_less_motion=self._settings.has_less_motion)
        if is_dark is not self._is_dark:  # else the scheme that was chosen otherwise stays
            self._is_dark = is_dark
            theme = replace(theme, colours=DARK if is_dark else LIGHT)
        if theme != current_theme():  # in one step, since each change is written to the settings
            set_theme(theme)
        kept = self._settings
        live_output.set_up(OutputSettings(kept.has_live_lsl, kept.has_live_websocket, kept.live_port))

    def _on_theme_changed(self) -> None:
        self._settings.scale = current_theme().scale  # also when the keys changed it
        self._fit()

    def _fit(self) -> None:
        if self._help is not None:
            scale = current_theme().scale
            width, height = self.width() / scale, self.height() / scale
            self._help.set_compact(is_compact=width < COMPACT_BELOW[0] or height < COMPACT_BELOW[1])

    def _on_larger(self) -> None:
        grow(1)

    def _on_smaller(self) -> None:
        grow(-1)

    def _on_usual_size(self) -> None:
        grow(0)

    def _on_open(self) -> None:
        if self._takes_folders:
            self._show(self.session)
            self.session.choose_folder()

    def _on_demonstration(self) -> None:
        if self._takes_folders:
            self.open_demonstration()

    def _on_escape(self) -> None:
        if self._help is not None and self.screens.currentWidget() is self._help:
            self._on_help_closed()
            return
        current = self.screens.currentWidget()
        if current is self._home and self._home is not None:
            self._home.escape()
        elif current is self.session and self.session.is_working:
            self.session.stop()
        elif current is self.session:
            self.session.leave()
        elif self._wizard is not None and current is self._wizard:
            self._wizard.escape()


class _DropFrame(QWidget):
    """The edge round the window while a folder is held over it."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window = window
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        set_ground(self, Ground(line="ink", width=DROP_EDGE, radius=0, inset=2))
        self.hide()

    def cover(self) -> None:
        self.setGeometry(self._window.rect())
        self.raise_()
        self.show()


def open_window(argv: list[str], language: str = "") -> int:
    """Open the application until closed, again after a change of language; `language` empty: chosen last."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C in the terminal ends it; Python would wait for the event loop
    sys.setswitchinterval(SWITCH_S)
    QGuiApplication.setHighDpiScaleFactorRoundingPolicy(Qt.HighDpiScaleFactorRoundingPolicy.PassThrough)
    log_qt_messages()
    app = QApplication([sys.argv[0], *argv])
    app.setApplicationName("Gaitwright")
    keep_no_visited_folders()
    app.setStyle("Fusion")
    load_fonts()
    show_roles()
    settings, folders = Settings(own_settings()), [word for word in app.arguments()[1:] if not word.startswith("-")]
    settings.language = language or settings.language
    settings.language_changed.connect(partial(app.exit, IN_ANOTHER_LANGUAGE))
    code, kept = show_window(app, settings, folders, None)
    while code == IN_ANOTHER_LANGUAGE:
        code, kept = show_window(app, settings, [], kept)
    keep_no_visited_folders()
    return code


def show_window(
    app: QApplication, settings: Settings, folders: list[str], kept: KeptLogIn | None
) -> tuple[int, KeptLogIn | None]:
    """Give what the event loop ended with, and who is logged in where another window follows."""
    use_language(settings.language)
    library = default_folder()
    set_theme(Theme())
    window = MainWindow(settings, library, library.with_name("seen"))
    if kept is not None:
        window.go_on(kept)
    window.show()
    garbage = GarbageCollector(window, lambda: window.preparing.is_busy)
    window.preparing.done.connect(garbage.pass_over_imported)
    QTimer.singleShot(PREPARE_AFTER_MS, window.prepare)
    if folders:
        window.open_folder(Path(folders[0]))
    with qt_speaks(settings.language):
        code = app.exec()
    window.close()
    kept = window.finish(must_keep=code == IN_ANOTHER_LANGUAGE)
    window.deleteLater()
    return code, kept


def own_settings() -> QSettings:
    """What this user of the computer has set, beside the library."""
    folder = platformdirs.user_config_path("gaitwright", appauthor=False)
    return QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)
