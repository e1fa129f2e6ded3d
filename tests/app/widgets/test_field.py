"""What is typed into a field: kept as it was, judged when it is left, and asked to who cannot see it."""

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.widgets.field import Field, NumberField
from app.widgets.focus_ring import FocusRing
from core.body import Side


@pytest.fixture
def window(qtbot: QtBot) -> QWidget:
    window = QWidget()
    QVBoxLayout(window)
    qtbot.addWidget(window)
    return window


def shown(qtbot: QtBot, window: QWidget, *fields: Field) -> None:
    for field in fields:
        layout = window.layout()
        assert layout is not None
        layout.addWidget(field)
    with qtbot.waitActive(window):
        window.show()
        window.activateWindow()


def knee() -> NumberField:
    return NumberField("Knee flexion", low=-60, high=150, decimals=1, unit="°", side=Side.LEFT)


def test_a_field_shows_side_label_unit_and_state_to_readers_of_screens(qtbot: QtBot, window: QWidget) -> None:
    mass = Field("Mass", unit="kg", is_optional=True)
    flexion = knee()
    shown(qtbot, window, mass, flexion)
    assert mass.line_edit.accessibleName() == "Mass, kg, optional"
    assert flexion.line_edit.accessibleName() == "Left knee flexion, °"
    flexion.set_wrong("This is no angle. Type degrees.")
    assert flexion.line_edit.accessibleName() == "Left knee flexion, °, This is no angle. Type degrees."


def test_what_the_program_writes_is_no_edit(qtbot: QtBot, window: QWidget) -> None:
    field = Field("Code", is_code=True)
    shown(qtbot, window, field)
    with qtbot.assertNotEmitted(field.edited), qtbot.assertNotEmitted(field.committed):
        field.set_text("P-0147")
    with qtbot.waitSignal(field.edited) as edited:
        QTest.keyClicks(field.line_edit, "8")
    assert edited.args == ["P-01478"]


@pytest.mark.parametrize(
    ("pasted", "taken"),
    [
        ("P-0147\nMiller", "P-0147 Miller"),
        ("P\u202e-7\u200b\u2028b", "P-7 b"),
        ("P\x00-7\t", "P -7 "),
        ("Ä 日本", "Ä 日本"),
    ],
)
def test_what_is_pasted_is_one_line_that_can_be_seen(qtbot: QtBot, window: QWidget, pasted: str, taken: str) -> None:
    field = Field("Code", is_code=True)
    shown(qtbot, window, field)
    field.set_text("A")
    with qtbot.waitSignal(field.edited) as edited:
        field.line_edit.insert(pasted)
        field.line_edit.textEdited.emit(field.line_edit.text())  # as a paste reports it
    assert edited.args == [f"A{taken}"]
    assert field.text == f"A{taken}"
    assert field.line_edit.cursorPosition() == len(field.line_edit.text())


def test_a_secret_is_taken_as_it_is(qtbot: QtBot, window: QWidget) -> None:
    field = Field("Passphrase", is_secret=True)
    shown(qtbot, window, field)
    field.line_edit.setText("a\tb")
    field.line_edit.textEdited.emit(field.line_edit.text())
    assert field.text == "a\tb"


def test_what_has_no_room_is_reported_and_what_was_written_elsewhere_is_kept_whole(
    qtbot: QtBot, window: QWidget
) -> None:
    field = Field("Code", most=5)
    shown(qtbot, window, field)
    QTest.keyClicks(field.line_edit, "P-01478")
    assert field.text == "P-014"
    assert field.line_edit.accessibleName() == "Code, At most 5 characters."
    QTest.keyClick(field.line_edit, Qt.Key.Key_Backspace)
    assert not field.is_wrong
    field.set_text("P-0147 of another clinic")
    assert field.text == "P-0147 of another clinic"


def test_a_change_is_committed_by_leaving_or_by_enter(qtbot: QtBot, window: QWidget) -> None:
    one, other = Field("Device"), Field("Clinic number")
    shown(qtbot, window, one, other)
    one.setFocus()
    with qtbot.assertNotEmitted(one.committed):
        other.setFocus()
        one.setFocus()
    QTest.keyClicks(one.line_edit, "carbon foot")
    with qtbot.waitSignal(one.committed):
        other.setFocus()
    with qtbot.waitSignal(other.committed):
        QTest.keyClick(other.line_edit, Qt.Key.Key_Return)


@pytest.mark.parametrize(
    ("typed", "value"),
    [("15", 15.0), ("7,5", 7.5), ("7.25", 7.2), ("-5", -5.0), ("\N{MINUS SIGN}5", -5.0), ("", None), ("x", None)],
)
def test_a_number_takes_comma_point_and_either_minus(qtbot: QtBot, typed: str, value: float | None) -> None:
    field = knee()
    qtbot.addWidget(field)
    field.set_text(typed)
    assert field.value == value


@pytest.mark.parametrize("typed", ["151", "-61", "inf", "nan", "15°"])
def test_a_number_that_does_not_fit_stays_and_states_what_fits(qtbot: QtBot, window: QWidget, typed: str) -> None:
    field = knee()
    shown(qtbot, window, field)
    field.setFocus()
    QTest.keyClicks(field.line_edit, typed)
    assert not field.is_wrong  # it may not be at its end yet
    QTest.keyClick(field.line_edit, Qt.Key.Key_Return)
    assert field.text == typed
    assert field.value is None
    assert "Enter a number from −60 to 150°." in field.line_edit.accessibleName()
    field.line_edit.selectAll()
    QTest.keyClicks(field.line_edit, "15")
    assert not field.is_wrong  # as soon as it is right


def test_a_year_has_no_decimals(qtbot: QtBot) -> None:
    year = NumberField("Birth year", low=1900, high=2026)
    qtbot.addWidget(year)
    year.set_text("1968.5")
    assert year.value is None
    year.set_value(1968)
    assert year.text == "1968"


def test_the_value_of_a_number_is_written_without_noughts(qtbot: QtBot) -> None:
    mass = NumberField("Mass", low=1, high=400, decimals=1, unit="kg")
    qtbot.addWidget(mass)
    for value, written in ((82.0, "82"), (82.5, "82.5"), (100.0, "100"), (None, "")):
        mass.set_value(value)
        assert mass.text == written
        assert mass.value == value


def test_the_wheel_changes_no_number(qtbot: QtBot, window: QWidget) -> None:
    field = knee()
    field.set_value(15)
    shown(qtbot, window, field)
    field.setFocus()
    nothing, flags = QPoint(), Qt.ScrollPhase.NoScrollPhase
    turn = QWheelEvent(
        QPointF(),
        QPointF(),
        nothing,
        QPoint(0, 120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        flags,
        False,
    )
    QApplication.sendEvent(field.line_edit, turn)
    assert field.value == 15
    assert not turn.isAccepted()  # what lies around it scrolls


def test_the_ring_of_the_focus_goes_round_the_frame(qtbot: QtBot, window: QWidget) -> None:
    field = knee()
    ring = FocusRing(window)
    shown(qtbot, window, field)
    field.setFocus()
    frame = field.line_edit
    corner = frame.mapTo(window, QPoint())
    assert frame.height() == 48
    assert ring.geometry() == frame.rect().translated(corner).adjusted(-5, -5, 5, 5)
