"""The forms of sensors with Bluetooth LE: what their lines say, what each choice costs, whether all has its room."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.widgets.sensors_progress import LineState, ProgressShown, SensorLine, SensorsProgress
from app.wizard.sensors.dot_form import DotChoice, DotForm, DotLine
from app.wizard.sensors.memories_form import HeldLine, MemoriesForm
from tests.app.room import settle, words_cut
from tests.app.wizard.emulated_dots import rows_of

LINES = [
    DotLine("DOT 0A22", True, -50, 0.85, "2.4.0"),
    DotLine("DOT 0A23", True, -70, 0.14, "2.4.0"),
    DotLine("DOT 0A24", False, -80, None, "", "does not respond: press its button"),
    DotLine("DOT 0A25", False, None, 0.5, "1.8.0", "firmware too old to synchronise"),
]
SIZES = [(1016, 540), (744, 420)]
HELD = [
    HeldLine("today 10:32", 6, "Saved: A Shoes.", is_kept=True),
    HeldLine("today 10:40", 5, "Not fetched: A2 Shoes.", is_kept=False, can_fetch=True),
]
SYNCHRONISING = ProgressShown(
    "The sensors are being synchronised",
    "The sensors are comparing their clocks. Leave them where they are. About 20 s left.",
    0.4,
    tuple(SensorLine(f"DOT 0A2{number}", LineState.NOW, "comparing clocks") for number in range(7)),
    stop="Cancel",
)


@pytest.fixture
def form(qtbot: QtBot) -> DotForm:
    form = DotForm()
    qtbot.addWidget(form)
    form.resize(1016, 540)
    form.show_dots(LINES)
    form.show()
    return form


def test_a_line_shows_signal_battery_firmware_and_what_is_the_matter(
    form: DotForm, snapshot: SnapshotAssertion
) -> None:
    assert [" | ".join(cell.words for cell in row.cells) for row in rows_of(form.list)] == snapshot
    ticks = [row.cells[0].is_checked for row in rows_of(form.list)]
    assert ticks == [True, True, False, False]


def test_space_turns_a_tick_and_enter_goes_on(form: DotForm, qtbot: QtBot) -> None:
    turned: list[int] = []
    form.turned.connect(turned.append)
    form.focus()
    QTest.keyClick(form.list, Qt.Key.Key_Down)
    QTest.keyClick(form.list, Qt.Key.Key_Space)
    QTest.keyClick(form.list, Qt.Key.Key_Return)
    assert turned == [1]
    with qtbot.waitSignal(form.identify_pressed) as pressed:
        form.identify.click()
    assert pressed.args == [1]


def test_each_way_to_record_walks_states_its_price(form: DotForm, snapshot: SnapshotAssertion) -> None:
    stated = {}
    for case, record_hz in {"faster than live": 120, "in the memory": 60, "live": 0}.items():
        form.show_choice(DotChoice(30, record_hz, 1))
        assert form.choice == DotChoice(30, record_hz, 1)
        stated[case] = form.consequence
    assert stated == snapshot


@pytest.mark.parametrize("size", SIZES)
def test_everything_on_the_list_of_sensors_has_its_room(form: DotForm, size: tuple[int, int]) -> None:
    form.set_room(size[0], is_narrow=size[0] < 1000)
    form.resize(*size)
    form.show_message(
        "Not synchronised: DOT 0A22 (heard too little of the others).", "Lay all sensors side by side, try again."
    )
    assert [cut for cut in words_cut(form) if "DOT 0A2" not in cut] == []


def test_choices_stand_below_the_list_where_the_words_of_a_language_are_too_long(form: DotForm) -> None:
    form.set_room(1016, is_narrow=False)
    assert form.walks.y() < form.list.geometry().bottom(), "beside it in English"
    longer = tuple(replace(line, note=2 * line.note) for line in LINES)
    form.show_dots(longer)
    settle()
    assert form.walks.mapTo(form, QPoint(0, 0)).y() > form.list.mapTo(form, QPoint(0, 0)).y() + form.list.height()
    form.show_dots(LINES)
    assert form.minimumSizeHint().width() <= 1016


@pytest.mark.parametrize("size", SIZES)
def test_everything_of_the_memories_has_its_room(qtbot: QtBot, size: tuple[int, int]) -> None:
    form = MemoriesForm()
    qtbot.addWidget(form)
    form.resize(*size)
    form.show_lines(HELD)
    form.show_message("1 recording is not saved in this library and would be lost.", "This cannot be undone")
    form.show()
    assert words_cut(form) == []
    assert form.title == "2 recordings in the sensor memory"
    assert form.chosen_number == 1, "the first that can be fetched"


@pytest.mark.parametrize("size", SIZES)
def test_everything_of_the_progress_has_its_room(qtbot: QtBot, size: tuple[int, int]) -> None:
    progress = SensorsProgress()
    qtbot.addWidget(progress)
    progress.resize(*size)
    progress.show_state(SYNCHRONISING)
    progress.show()
    assert words_cut(progress) == []
    assert progress.stop.isVisible()
    progress.show_state(ProgressShown("The sensors are not ready", what="So.", then="Do so.", is_running=False))
    assert words_cut(progress) == []
    assert progress.stop.isHidden()
    assert progress.notice.isVisible()
