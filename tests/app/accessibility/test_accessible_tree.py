"""Tests that the walk over a page complains where it must, and nowhere else."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QApplication, QComboBox, QLineEdit, QPlainTextEdit, QPushButton, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.theme.icons import Icon
from app.widgets.button import Button
from app.widgets.choice import Choice
from app.widgets.segmented import Segmented
from app.widgets.toggle import Toggle
from tests.app.accessibility.accessible_tree import complaints, elements, tab_stops, wrong_order
from tests.app.room import settle

Role = QAccessible.Role


class Drawn(QWidget):
    """A chart that nobody informed of."""

    accessible_role = QAccessible.Role.Chart


@pytest.fixture
def page(qtbot: QtBot) -> QWidget:
    page = QWidget()
    QVBoxLayout(page)
    qtbot.addWidget(page)
    return page


def shown(qtbot: QtBot, page: QWidget, *parts: QWidget) -> QWidget:
    layout = page.layout()
    assert layout is not None
    for part in parts:
        layout.addWidget(part)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    settle()
    parts[0].setFocus()
    return page


def named(widget: QWidget, name: str, description: str = "") -> QWidget:
    widget.setAccessibleName(name)
    widget.setAccessibleDescription(description)
    return widget


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("", "has no name"),
        ("+", "has a name without a word"),
        ("back_button", "has a name for programmers"),
        ("QPushButton", "has a name for programmers"),
        ("Back", ""),
        ("Zurück", ""),
    ],
)
def test_a_button_without_a_word_for_people_is_complained_of(
    qtbot: QtBot, page: QWidget, name: str, wrong: str
) -> None:
    stated = complaints(shown(qtbot, page, named(QPushButton(), name)))
    assert stated == ([f"QPushButton (Button) “{name}” {wrong}"] if wrong else [])


def test_a_button_of_the_house_without_words_is_complained_of(qtbot: QtBot, page: QWidget) -> None:
    bare, reported = Button("", icon=Icon.PLAY), Button("Play", icon=Icon.PLAY)
    assert complaints(shown(qtbot, page, bare, reported)) == ["Button (Button) “” has no name"]


def test_what_takes_the_focus_needs_a_role_and_a_chart_a_description(qtbot: QtBot, page: QWidget) -> None:
    plain = named(QWidget(), "Legs")
    plain.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    charts = [named(Drawn(), "Knee"), named(Drawn(), "Ankle", "Left ankle from −16° to 10°.")]
    assert complaints(shown(qtbot, page, plain, *charts)) == [
        "QWidget (Client) “Legs” takes the focus and has no role",
        "Drawn (Chart) “Knee” is not described",
    ]


def test_a_choice_states_what_is_chosen(qtbot: QtBot, page: QWidget) -> None:
    bare, reported = QComboBox(), Choice("Display size")
    for box in (bare, reported):
        box.addItems(["80 %", "100 %"])
    assert [one.partition(" ")[0] for one in complaints(shown(qtbot, page, bare, reported))] == ["QComboBox"]
    (received,) = (one for one in elements(page) if one.kind == "Choice")
    assert "Display size" in (received.name, received.description)


def test_what_changes_on_the_screen_changes_in_the_tree(qtbot: QtBot, page: QWidget) -> None:
    toggle, button = Toggle("Legs", "G", is_on=False), Button("Go")
    ways = Segmented("Motion", [("system", "System setting", ""), ("less", "Reduced", "")])
    shown(qtbot, page, toggle, button, ways)

    def reported() -> list[tuple[QAccessible.Role, bool, bool]]:
        return [(one.role, one.is_checked, one.is_enabled) for one in elements(page) if one.is_focusable]

    before = reported()
    toggle.click()
    button.setEnabled(False)
    ways.choose("less")
    assert before == [
        (Role.CheckBox, False, True),
        (Role.Button, False, True),
        (Role.RadioButton, True, True),
        (Role.RadioButton, False, True),
    ]
    assert reported()[0] == (Role.CheckBox, True, True)
    assert [one[1] for one in reported() if one[0] is Role.RadioButton] == [False, True]
    assert not any(enabled for role, _, enabled in reported() if role is Role.Button)


def test_a_button_is_pressed_through_the_tree(qtbot: QtBot, page: QWidget) -> None:
    button, clicks = Button("Go"), []
    button.clicked.connect(lambda: clicks.append("go"))
    shown(qtbot, page, button)
    action = QAccessible.queryAccessibleInterface(button).actionInterface()
    action.doAction("Press")
    qtbot.waitUntil(lambda: clicks == ["go"])  # Qt shows the press for a moment


def test_tab_goes_round_once_and_a_field_that_keeps_it_is_named(qtbot: QtBot, page: QWidget) -> None:
    first, second = named(QLineEdit(), "Code"), named(QPushButton("Go"), "Go")
    shown(qtbot, page, first, second)
    assert tab_stops(page) == [first, second]
    trap = named(QPlainTextEdit(), "Comment")  # takes Tab as a letter
    shown(qtbot, page, trap)
    first.setFocus()
    with pytest.raises(AssertionError, match="Tab is kept by QPlainTextEdit “Comment”"):
        tab_stops(page)


def test_what_tab_leaves_out_or_takes_against_the_order_of_reading_is_named(qtbot: QtBot, page: QWidget) -> None:
    fields = [named(QLineEdit(), name) for name in ("Code", "Name", "Role")]
    shown(qtbot, page, *fields)
    assert wrong_order(page) == []
    for before, after in ((0, 2), (2, 1)):
        QWidget.setTabOrder(fields[before], fields[after])
    fields[0].setFocus()
    assert wrong_order(page) == ["QLineEdit “Name” comes after QLineEdit “Role” and stands before it"]
    fields[2].setFocusProxy(fields[0])
    fields[1].setFocusPolicy(Qt.FocusPolicy.ClickFocus)
    assert QApplication.focusWidget() is not None
    assert wrong_order(page) == []
