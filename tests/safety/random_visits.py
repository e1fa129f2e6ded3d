"""What leads a session on, from the first start to a saved report, page by page."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QAbstractItemView, QLineEdit

from tests.safety.random_hands import ALT, CTRL, LEFT, NO_MODIFIER, Hands, Key

if TYPE_CHECKING:
    from app.wizard.wizard import Wizard

OPERATOR, PASSPHRASE = "rk", "seven quiet herons cross"
WALK_STEPS = (10, 40)  # of the user's, while a walk is recorded
COMMENTS = ("Walks further than in spring.", "The left foot drags.", "New socket since Monday.")


class SensibleUser(Hands):
    """Does what a page asks for, with some choice where there is one."""

    def lead_on(self) -> str:
        screen: Any = self._window.screens.currentWidget()
        name = type(screen).__name__
        deed = {
            "FirstStartPage": self._on_first_start,
            "LogInPage": self._on_log_in,
            "Home": self._on_home,
            "Wizard": self._on_wizard,
            "HelpPage": self._on_help,
            "SessionScreen": self._on_session_screen,
        }.get(name)
        stated = deed(screen) if deed is not None else "waits"
        return f"{name}: {stated}"

    def _on_first_start(self, page: Any) -> str:
        if page.typed.isVisible():
            self.recovery_key = "-".join(page._key_words.text.split())
            self.type_into(page.typed.line_edit, "-".join(self.recovery_key.split("-")[-2:]))
            self.press(Key.Key_Return)
            return "types the end of the key"
        if not page.make.isEnabled():
            return "waits"
        texts = (OPERATOR, "R. Keys", PASSPHRASE, PASSPHRASE)
        for field, text in zip((page.code, page.name, page.passphrase, page.again), texts, strict=True):
            self.type_into(field.line_edit, text)
        self.click(page.make)
        return "makes the library"

    def _on_log_in(self, page: Any) -> str:
        if not page.go.isEnabled():
            return "waits"
        if page.recovery_key.isVisible():
            self.click(page.use_recovery)
            return "goes back to the passphrase"
        if page.operator.isVisible() and page.operator.isEnabled() and page.code != OPERATOR:
            page.operator.setCurrentIndex(max(page.operator.findData(OPERATOR), 0))
        self.type_into(page.passphrase.line_edit, PASSPHRASE)
        self.press(Key.Key_Return)
        return "logs in"

    def _on_home(self, home: Any) -> str:
        from app.home.importing.import_page import ImportPage
        from app.home.patients.home_page import HomePage

        page = home.current
        if isinstance(page, ImportPage):
            if not page.code.text.strip() or self._chance.random() < 0.3:
                self.type_into(page.code.line_edit, self._code())
            self.click(home.bar.primary)
            return "imports"
        if not isinstance(page, HomePage):
            if page is home.working:
                return "waits"
            return self._in_settings(home)
        state = self._window.controller.state
        if state is not None and state.is_demonstration and self._chance.random() < 0.1:
            self.press_named("Leave the demonstration")
            return "leaves the demonstration"
        deed = self._chance.choices(
            ("old", "new", "open", "settings", "help", "demonstration", "import", "search", "delete", "undo", "theme"),
            (40, 25, 25, 3, 2, 1, 3, 3, 2, 2, 1),
        )[0]
        if deed == "old" and home.patients.patient is not None:
            for _ in range(self._chance.randrange(4)):
                page.patients.step(self._chance.choice((-1, 1)))
            self.click(home.bar.primary)
            self.did("session begun")
        elif deed == "new" or deed == "old":
            self.press(Key.Key_N, CTRL)
            self.did("session begun")
        elif deed == "open":
            self._click_row(page.sessions)
        elif deed == "settings":
            self.press_named("Settings")
        elif deed == "help":
            self.press(Key.Key_F1)
        elif deed == "demonstration":
            self.press_named("Open demonstration")
        elif deed == "import":
            self.press_named("Import recordings")
        elif deed == "search":
            self.type_into(page.search, self._chance.choice(("demo", "1", "", "", "knee")))
        elif deed == "delete":
            self.press_named("Delete")
        elif deed == "undo":
            self.press(Key.Key_Z, CTRL)
        elif deed == "theme":
            self.press_named("Appearance")
        return deed

    def _in_settings(self, home: Any) -> str:
        if self._chance.random() < 0.4:
            self.press(Key.Key_Escape)
            return "leaves the settings"
        controls = self.controls(home.current)
        one = self._chance.choice(controls) if controls else None
        if one is None:
            return "waits"
        words = one.text() if isinstance(one, QAbstractButton) else one.accessibleName()
        if isinstance(one, QLineEdit):
            self.type_into(one, self._chance.choice(("M. Muster", "mm", "quiet brown geese fly")))
        else:
            self.click(one)
        return f"sets {words!r}"

    def _on_wizard(self, wizard: "Wizard") -> str:
        visit = wizard.visit
        if visit is None or wizard.current is None:
            return "waits"
        if wizard.shell.banner.isVisible() and self._chance.random() < 0.3:
            self.press_named("Dismiss", wizard)
            return "dismisses the banner"
        if self._chance.random() < 0.004:
            self.press_named("All patients", wizard)
            return "goes to all patients"
        step = type(wizard.current).__name__
        deeds: dict[str, Callable[[Wizard], str]] = {
            "PatientStep": self._on_patient,
            "SensorsStep": self._on_sensors,
            "StandStillStep": self._on_stand_still,
            "FreeMotionStep": self._on_free_motion,
            "WalkingStep": self._on_walking,
            "ResultsStep": self._on_results,
            "ReportStep": self._on_report,
        }
        return f"{step} {deeds[step](wizard)}"

    def _on_patient(self, wizard: "Wizard") -> str:
        page: Any = wizard.current.page if wizard.current is not None else None
        if page._taken.isVisible():
            if self._chance.random() < 0.5:
                self.click(page._taken.open)
                return "opens the one that is there"
            self.type_into(page.code.line_edit, self._code())
            return "types another code"
        if not page.code.text.strip():
            self.type_into(page.code.line_edit, self._code())
            return "types a code"
        if self._chance.random() < 0.6:
            return self._show_of_patient(page)
        self._primary(wizard)
        return "goes on"

    def _show_of_patient(self, page: Any) -> str:
        field, text = self._chance.choice(
            (
                (page.birth_year, str(self._chance.randrange(1925, 2015))),
                (page.height_cm, f"{self._chance.uniform(120, 205):.1f}"),
                (page.mass_kg, f"{self._chance.uniform(30, 130):.1f}"),
                (page.device, self._chance.choice(("knee K2", "foot, carbon", ""))),
            )
        )
        if self._chance.random() < 0.5:
            buttons = [*page.sex.segments, *page.side.segments, *page.limb.segments, *page.aids.buttons]
            self.click(self._chance.choice([one for one in buttons if one.isVisible() and one.isEnabled()]))
            return "ticks"
        self.type_into(field.line_edit, text)
        return f"types {text!r}"

    def _on_sensors(self, wizard: "Wizard") -> str:
        visit = wizard.visit
        page: Any = wizard.current.page if wizard.current is not None else None
        assert visit is not None
        sensors = visit.sensors
        if sensors.is_searching:
            return "waits"
        if sensors.acquisition is None:
            if not visit.choices or self._chance.random() < 0.05:
                self.press(Key.Key_Left, ALT)  # nothing simulated for a real patient: another code, or away
                if self._chance.random() < 0.5:
                    self.press_named("All patients", wizard)
                return "goes away"
            self.press_named(visit.choices[0].name, page)
            return "chooses the sensors"
        if (not sensors.site_of and not sensors.is_left_to_motion) or self._chance.random() < 0.1:
            if self._chance.random() < 0.4:
                self.press_named("Detect from movement", page)
                return "leaves it to the movement"
            self._place_by_digits(page)
            return "places the sensors"
        self._primary(wizard)
        return "goes on"

    def _place_by_digits(self, page: Any) -> None:
        """Each sensor's place by its figure; once in a while a wrong one, or one less."""
        from core.body import LEG_SITES

        places = {str(site): number for number, site in enumerate(LEG_SITES, 1)}
        for name, row in tuple(page.list.rows.items()):
            right = next((number for site, number in places.items() if site in name), 1)
            number = right if self._chance.random() < 0.97 else self._chance.randrange(1, 7)
            self.click(row)
            self.press(Qt.Key(Key.Key_0 + number))

    def _on_stand_still(self, wizard: "Wizard") -> str:
        if self._waits > 0:
            self._waits -= 1
            return "waits"
        chance = self._chance.random()
        page: Any = wizard.current.page if wizard.current is not None else None
        if chance < 0.05:
            self.press_named("Cannot stand", page) or self.press_named("The patient can", page)
            return "says who can stand"
        if chance < 0.15:
            fields = [one for one in self.controls(page) if isinstance(one, QLineEdit)]
            if fields:
                self.type_into(self._chance.choice(fields), self._chance.choice(("5", "-10", "", "0")))
                return "types a zero"
        self.press(Key.Key_Space)
        self._waits = 10
        return "starts the count"

    def _on_free_motion(self, wizard: "Wizard") -> str:
        if self._waits > 0:
            self._waits -= 1
            return "waits"
        self._waits = 12
        page: Any = wizard.current.page if wizard.current is not None else None
        if self._chance.random() < 0.3:
            buttons = [one for one in self.controls(page) if isinstance(one, QAbstractButton)]
            if buttons:
                self.click(self._chance.choice(buttons))
                return "answers what is asked"
        self._primary(wizard)
        return "goes on"

    def _on_walking(self, wizard: "Wizard") -> str:
        visit = wizard.visit
        assert visit is not None
        recordings = visit.recordings
        if recordings.is_stopping:
            return "waits"
        if recordings.is_recording:
            if self._waits > 0:
                self._waits -= 1
                return "lets walk"
            self.press(Key.Key_Space)
            self.did("walk recorded")
            return "stops the walk"
        step: Any = wizard.current
        if step._asked is not None:
            key = self._chance.choices((Key.Key_K, Key.Key_D, Key.Key_Space), (6, 2, 2))[0]
            self.press(key)
            return "answers whether it is kept"
        kept = sum(recording.details.is_kept for recording in recordings.walks)
        if kept and self._chance.random() < 0.3 + 0.1 * kept:
            self._primary(wizard)
            return "goes to the results"
        if self._chance.random() < 0.3:
            self.press(Qt.Key(Key.Key_1 + self._chance.randrange(5)))
            return "chooses a label"
        if self._chance.random() < 0.02:
            page: Any = step.page
            self.click(page.walks.restrapped)
            return "straps anew"
        self.press(Key.Key_Space)
        self._waits = self._chance.randrange(*WALK_STEPS)
        return "starts a walk"

    def _on_results(self, wizard: "Wizard") -> str:
        page: Any = wizard.current.page if wizard.current is not None else None
        front = page.currentWidget()
        if type(front).__name__ == "WorkingPage":
            return "waits"
        chance = self._chance.random()
        if chance < 0.15:
            self._primary(wizard)
            self.did("results seen")
            return "goes to the report"
        if chance < 0.2:
            self.press_named("Correct", wizard)
            return "corrects"
        if chance < 0.25:
            self.press(Key.Key_Z, CTRL)
            return "takes back"
        controls = self.controls(front)
        if not controls:
            self._primary(wizard)
            return "goes on"
        one = self._chance.choice(controls)
        if isinstance(one, QLineEdit):
            self.type_into(one, self._chance.choice(("alignment B", "barefoot", "slow, with stick")))
            self.press(Key.Key_Return)
            return "types a condition"
        self.click(one)
        return f"presses {one.accessibleName() or type(one).__name__!r}"

    def _on_report(self, wizard: "Wizard") -> str:
        step: Any = wizard.current
        if step.is_saving:
            return "waits"
        if step.saved not in (None, self._last_saved):
            self._last_saved = step.saved
            self.did("report saved")
        chance = self._chance.random()
        report = step.page.report
        if chance < 0.3 and report.isVisible():
            report.comment.setFocus()
            QTest.keyClicks(report.comment, self._chance.choice(COMMENTS))
            return "comments"
        if chance < 0.55:
            self.press(Key.Key_S, CTRL)
            return "saves"
        if chance < 0.7 and report.isVisible():
            buttons = [one for one in self.controls(report) if isinstance(one, QAbstractButton)]
            if buttons:
                self.click(self._chance.choice(buttons))
            return "chooses what is written"
        if chance < 0.85:
            self.press_named("All patients", wizard)
            return "goes to all patients"
        self.press(Qt.Key(Key.Key_1 + self._chance.randrange(6)), CTRL)
        return "goes to another step"

    def _on_help(self, page: Any) -> str:
        if self._chance.random() < 0.6:
            self.press(Key.Key_Escape)
            return "goes back"
        controls = self.controls(page)
        if controls:
            self.click(self._chance.choice(controls))
        return "reads"

    def _on_session_screen(self, page: Any) -> str:
        if page.is_working and self._chance.random() < 0.9:
            return "waits"
        if self._chance.random() < 0.3:
            self.press(Key.Key_Escape)
            return "leaves"
        controls = self.controls(page)
        if controls:
            self.click(self._chance.choice(controls))
        return "looks round"

    def _primary(self, wizard: "Wizard") -> None:
        if self._chance.random() < 0.5 and wizard.shell.bar.primary.isVisible():
            self.click(wizard.shell.bar.primary)
        else:
            self.press(Key.Key_Return)

    def _code(self) -> str:
        return f"{self._chance.choices(('DEMO-', 'P-'), (9, 1))[0]}{self._chance.randrange(1, 7)}"

    def _click_row(self, view: QAbstractItemView) -> None:
        model = view.model()
        if view.isVisible() and model.rowCount():
            index = model.index(self._chance.randrange(model.rowCount()), 0)
            view.scrollTo(index)
            QTest.mouseClick(view.viewport(), LEFT, NO_MODIFIER, view.visualRect(index).center())
            self.did("session opened")
