"""The frame of the wizard: its forms at every size, regions, folding, banner and toast, and room for every word."""

from collections.abc import Iterator

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAccessible
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QComboBox, QPushButton, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.theme.current import px, set_scale
from app.theme.icons import Icon
from app.widgets.action_bar import BarState, RecordingNote
from app.widgets.rail_row import RailForm, RailRow, StepState
from app.widgets.sensor_strip import SensorStrip
from app.widgets.sensor_tile import SensorTile
from app.widgets.sentence_page import SentencePage
from app.widgets.step_rail import wizard_below
from app.wizard import shell as shell_module
from app.wizard.free_motion.page import FreeMotionPage
from app.wizard.shell import StripMode, WizardShell
from app.wizard.step import StepId
from app.wording.translation import tr, use_language
from core.body import LEG_SITES, Site
from tests.app.idle_action import idle
from tests.app.room import settle, words_cut
from tests.app.wizard.present import present

RECORDING = ("Recording Alignment C", "Saved as it comes in. The space bar stops the walk, with a sound.")


class Page(QWidget):
    def __init__(self) -> None:
        super().__init__()
        self.first, self.second = QPushButton("one"), QPushButton("two")
        column = QVBoxLayout(self)
        column.addWidget(self.second)
        column.addWidget(self.first)
        self.tab_order = [self.first, self.second]

    def focus(self) -> None:
        self.first.setFocus()


def tile(site: Site, silent_s: float = 0.0, battery: float = 0.84, lost_share: float = 0.0) -> SensorTile:
    return SensorTile(site, "0A22", battery, 100.0, lost_share, silent_s, is_moving=True, is_worn=True)


def fine() -> dict[Site, SensorTile]:
    return {site: tile(site) for site in LEG_SITES}


def stop_early() -> BarState:
    note = "If you stop now, angles are unreliable for the left knee."
    stop = idle(tr("Stop early"), tr("Space"), Icon.STOP, is_requested=False)
    return BarState(stop, quiet=(idle(tr("Repeat one leg"), icon=Icon.REPEAT),), note=note)


def recording() -> BarState:
    title, note = (tr(words) for words in RECORDING)
    return BarState(
        idle(tr("Stop walk"), tr("Space"), Icon.STOP), recording=RecordingNote(title, note, 17.0, has_sound=True)
    )


def reconnect() -> BarState:
    requested = idle(tr("Reconnect R foot"), tr("Enter"), Icon.REPEAT)
    return BarState(requested, others=(idle(tr("Go on without right ankle")),))


def filled() -> WizardShell:
    shell = WizardShell()
    rows = [
        ("Patient", "Left prosthetic", StepState.DONE),
        ("Sensors", "6 of 6 assigned", StepState.DONE),
        ("Stand still", "skipped, reported", StepState.SKIPPED),
        (
            "Free motion",
            "enough movement for 1 of 2 knees, 2 of 2 ankle centres; left knee: not a hinge",
            StepState.ATTENTION,
        ),
        ("Walking", "3 walks, L 52, R 49", StepState.CURRENT),
        ("Results", "", StepState.TODO),
        ("Report", "", StepState.TODO),
    ]
    shell.rail.show_rows(tuple(RailRow(tr(title), tr(note), state) for title, note, state in rows))
    shell.rail.show_below(wizard_below())
    shell.header.show_session("P-0147", tr("1968, male · left prosthetic"), is_simulated=True)
    shell.header.show_elapsed(301.0)
    shell.strip.show_tiles(fine())
    shell.bar.show_state(stop_early())
    return shell


@pytest.fixture(autouse=True)
def _english_again() -> Iterator[None]:
    yield
    use_language("en")


@pytest.fixture
def shell(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> WizardShell:
    monkeypatch.setattr(shell_module, "duration_ms", lambda _usual_ms, _theme: 0)
    shell = filled()
    qtbot.addWidget(shell)
    shell.resize(1280, 800)
    shell.show()
    shell.show_page(StepId.PATIENT, Page())
    settle()
    return shell


@pytest.mark.parametrize(
    ("size", "scale", "is_compact", "form"),
    [
        ((1280, 800), 1.0, False, RailForm.USUAL),
        ((1179, 800), 1.0, True, RailForm.COMPACT),
        ((1280, 719), 1.0, True, RailForm.COMPACT),
        ((1920, 1200), 2.0, True, RailForm.COMPACT),
        ((960, 600), 0.8, False, RailForm.USUAL),
        ((1920, 1080), 1.0, False, RailForm.WIDE),
    ],
)
def test_the_frame_takes_the_form_that_the_window_has_room_for(
    shell: WizardShell, size: tuple[int, int], scale: float, is_compact: bool, form: RailForm
) -> None:
    set_scale(scale)
    shell.resize(*size)
    settle()
    assert (shell.is_compact, shell.rail.form) == (is_compact, form)
    assert shell.rail.width() == px(form.value)


def test_the_content_is_no_wider_than_can_be_read_and_in_the_middle(shell: WizardShell) -> None:
    shell.resize(2400, 1080)
    settle()
    page = present(shell.page)
    left = page.mapTo(shell, page.rect().topLeft()).x() - shell.rail.width()
    assert page.width() == 1600
    assert left == (2400 - shell.rail.width() - 1600) // 2


def test_a_page_is_reported_its_room_in_px_of_the_design(shell: WizardShell) -> None:
    reported: list[tuple[bool, float, float]] = []
    shell.room_changed.connect(lambda *room: reported.append(room))
    set_scale(2.0)
    shell.resize(1920, 1200)
    settle()
    page = present(shell.page)
    assert reported[-1] == (True, page.width() / 2, page.height() / 2)
    reported.clear()
    shell.show_page(StepId.SENSORS, Page())
    assert reported


def test_a_question_above_the_gauges_pushes_none_out_of_sight(shell: WizardShell) -> None:
    page = FreeMotionPage()
    shell.show_page(StepId.PATIENT, page)
    page.question.ask("Both legs moved at once. Which leg has 0A31 on the shank?", "", ("Left", "Right"))
    settle()
    assert page.question.isVisible()
    assert page.height() <= shell._scroll.viewport().height()
    assert all(page.rect().contains(gauge.geometry()) for gauge in page.gauges.values())


def test_a_page_with_nothing_to_press_leaves_the_focus_to_the_bar(shell: WizardShell) -> None:
    page = SentencePage()
    page.show_sentence("The results are saved.")
    shell.show_page(StepId.PATIENT, page)
    assert shell.focusWidget() is shell.bar.primary
    page.show_sentence("No walk is included yet.", button="Go to Walking")
    shell.show_page(StepId.PATIENT, page)
    assert shell.focusWidget() is page.button


def test_a_page_comes_into_sight_with_the_focus_where_reading_starts(shell: WizardShell) -> None:
    page = Page()
    shell.show_page(StepId.FREE_MOTION, page)
    assert shell.page is page
    assert shell.focusWidget() is page.first


def test_the_page_that_was_there_fades_and_leaves_nothing(qtbot: QtBot) -> None:
    shell = filled()
    qtbot.addWidget(shell)
    shell.resize(900, 600)
    shell.show()
    shell.show_page(StepId.PATIENT, Page())
    shell.show_page(StepId.SENSORS, Page())
    qtbot.waitUntil(lambda: not shell._fade.isVisible())


def test_tab_goes_through_the_page_in_its_own_order_and_then_to_the_bar(shell: WizardShell) -> None:
    page = shell.page
    assert isinstance(page, Page)
    page.focus()
    seen = []
    for _ in range(4):
        QTest.keyClick(shell.focusWidget() or shell, Qt.Key.Key_Tab)
        seen.append(shell.focusWidget())
    assert seen == [page.second, shell.bar.back, shell.bar.quiet[0], shell.bar.primary]


def test_the_regions_are_gone_round_forwards_and_back(shell: WizardShell) -> None:
    shell.set_strip_mode(StripMode.SHOWN)
    page = shell.page
    assert isinstance(page, Page)
    page.focus()
    seen = []
    for _ in range(4):
        shell.focus_next_region(1)
        seen.append(shell.focusWidget())
    first_tile = shell.strip.widgets[Site.RIGHT_THIGH]
    assert seen == [shell.bar.primary, shell.rail.rows[4], first_tile, page.first]
    shell.focus_next_region(-1)
    assert shell.focusWidget() is first_tile


def test_the_folded_strip_is_a_region_of_its_own_and_a_hidden_one_is_none(shell: WizardShell) -> None:
    shell.set_strip_mode(StripMode.FOLDED)
    shell.rail.focus()
    shell.focus_next_region(1)
    assert shell.focusWidget() is shell.header.fold
    shell.set_strip_mode(StripMode.HIDDEN)
    shell.rail.focus()
    shell.focus_next_region(1)
    assert isinstance(shell.page, Page)
    assert shell.focusWidget() is shell.page.first


def test_the_folded_strip_opens_at_a_press(shell: WizardShell) -> None:
    shell.set_strip_mode(StripMode.FOLDED)
    assert not shell.strip.isVisible()
    assert shell.header.fold.text() == "6 sensors, all connected"
    reported = QAccessible.queryAccessibleInterface(shell.header.fold)
    assert (reported.role(), bool(reported.state().checked)) == (QAccessible.Role.CheckBox, False)
    QTest.mouseClick(shell.header.fold, Qt.MouseButton.LeftButton)
    assert shell.strip.isVisible()
    assert reported.state().checked
    QTest.mouseClick(shell.header.fold, Qt.MouseButton.LeftButton)
    assert not shell.strip.isVisible()
    assert not reported.state().checked


def test_an_opened_strip_is_folded_again_with_the_next_session(shell: WizardShell) -> None:
    shell.set_strip_mode(StripMode.FOLDED)
    shell.header.fold.setChecked(True)
    assert shell.strip.isVisible()
    shell.clear_pages()
    shell.set_strip_mode(StripMode.FOLDED)
    assert not shell.strip.isVisible()


def test_the_folded_strip_opens_by_itself_when_a_sensor_turns_bad_and_only_then(
    shell: WizardShell, qtbot: QtBot
) -> None:
    shell.set_strip_mode(StripMode.FOLDED)
    shell.strip.show_tiles(fine() | {Site.RIGHT_FOOT: tile(Site.RIGHT_FOOT, silent_s=3.4)})
    qtbot.waitUntil(shell.strip.isVisible)
    assert shell.header.fold.text() == "R foot: no signal 3 s"
    shell.header.fold.setChecked(False)
    shell.strip.show_tiles(fine() | {Site.RIGHT_FOOT: tile(Site.RIGHT_FOOT, silent_s=4.4)})
    qtbot.waitUntil(lambda: shell.header.fold.text() == "R foot: no signal 4 s")
    assert not shell.strip.isVisible()


def test_a_low_window_has_no_room_for_tiles_and_states_it_in_the_header(shell: WizardShell) -> None:
    shell.set_strip_mode(StripMode.SHOWN)
    shell.resize(1280, 470)
    settle()
    assert not shell.strip.isVisible()
    assert shell.header.fold.isVisible()
    shell.resize(1280, 800)
    settle()
    assert shell.strip.isVisible()
    assert not shell.header.fold.isVisible()


def test_a_banner_that_comes_while_recording_pushes_nothing(shell: WizardShell) -> None:
    page = present(shell.page)
    shell.bar.show_state(recording())
    settle()
    before = page.mapTo(shell, page.rect().topLeft())
    shell.banner.show_message("R foot: no signal for 2 s", "Recording continues.")
    settle()
    assert page.mapTo(shell, page.rect().topLeft()) == before
    shell.banner.hide()
    shell.bar.show_state(stop_early())
    settle()
    assert page.mapTo(shell, page.rect().topLeft()).y() < before.y()


def test_the_toast_is_above_the_bar_at_its_left(shell: WizardShell) -> None:
    shell.toast.offer("Walk 2 excluded.")
    settle()
    assert shell.toast.geometry().bottom() < shell.bar.mapTo(shell, QPoint(0, 0)).y()
    assert shell.toast.x() == shell.rail.width() + 24
    shell.resize(900, 600)
    settle()
    assert shell.toast.geometry().bottom() < shell.bar.mapTo(shell, QPoint(0, 0)).y()


def test_a_window_too_low_for_all_scrolls_and_shows_the_bar_of_a_recording(shell: WizardShell) -> None:
    set_scale(2.0)
    shell.resize(800, 560)
    settle()
    shell.bar.show_state(recording())
    settle()
    assert shell.size().toTuple() == (800, 560)
    stop = shell.bar.primary
    assert shell.rect().contains(stop.mapTo(shell, stop.rect().bottomRight()))


def test_pages_that_are_given_up_are_gone(shell: WizardShell) -> None:
    shell.clear_pages()
    settle()
    assert shell.page is None
    assert [page for page in shell.findChildren(Page) if page.isVisible()] == []


SIZES = [
    ((800, 560), 0.8),
    ((800, 560), 1.0),
    ((800, 560), 2.0),
    ((1280, 800), 1.0),
    ((1280, 800), 2.0),
    ((1920, 1080), 1.0),
]


@pytest.mark.endurance
@pytest.mark.parametrize("language", ["en", "pseudo"])
@pytest.mark.parametrize(("size", "scale"), SIZES)
@pytest.mark.parametrize("mode", [StripMode.SHOWN, StripMode.FOLDED])
def test_no_word_of_the_frame_is_cut(
    qtbot: QtBot, size: tuple[int, int], scale: float, mode: StripMode, language: str
) -> None:
    use_language(language)
    set_scale(scale)
    shell = filled()
    qtbot.addWidget(shell)
    shell.set_strip_mode(mode)
    shell.resize(*size)
    shell.show()
    bad = fine() | {
        Site.RIGHT_FOOT: tile(Site.RIGHT_FOOT, silent_s=12.0),
        Site.LEFT_FOOT: tile(Site.LEFT_FOOT, battery=0.11),
        Site.LEFT_SHANK: tile(Site.LEFT_SHANK, lost_share=0.124),
        Site.RIGHT_THIGH: SensorTile(Site.RIGHT_THIGH, "", None, 0.0, 0.0, 0.0, is_moving=False, is_worn=False),
    }
    assert isinstance(shell.strip, SensorStrip)
    shell.strip.show_at_once(bad)
    for state in (stop_early(), recording(), reconnect()):
        shell.bar.show_state(state)
        shell.toast.offer(tr("Walk 2 excluded."))
        assert words_cut(shell) == []
        assert shell.size().toTuple() == size


def test_tab_goes_past_a_list_that_folds_out(shell: WizardShell) -> None:
    page = QWidget()
    column = QVBoxLayout(page)
    choice, button = QComboBox(), QPushButton("one")
    choice.addItems(["a", "b"])
    choice.view()  # Qt makes its window when it is first asked for
    for widget in (choice, button):
        column.addWidget(widget)
    shell.show_page(StepId.SENSORS, page)  # Qt's warnings fail a test
    choice.setFocus()
    QTest.keyClick(choice, Qt.Key.Key_Tab)
    assert button.hasFocus()
