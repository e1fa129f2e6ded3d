"""The lists of patients and sessions: quick with thousands, found as typed, no word cut."""

from dataclasses import replace
from itertools import pairwise
from time import process_time
from uuid import UUID, uuid4

import pytest
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.home.patients.home_page import HomePage
from app.summary.progress_words import Arrow
from app.theme.current import current_theme, px, set_scale
from app.widgets.line_list import TEXT_ROW, LineCell, PatientLine, SessionLine, VisitCell, VisitColumns, VisitHead

MANY = 5000
MOST_S = 0.1  # what the screen's thread may take for anything


@pytest.fixture
def page(qtbot: QtBot) -> HomePage:
    page = HomePage()
    page.set_room(1064)
    page.resize(1064, 728)
    qtbot.addWidget(page)
    with qtbot.waitExposed(page):
        page.show()
    return page


def patient(number: int, person: str = "1968, male · left prosthetic") -> PatientLine:
    code = f"P-{number:04d}"
    return PatientLine(UUID(int=number), code, person, "24 Oct 2026", "5 sessions", f"{code} {person}".casefold())


def session(number: int, conditions: str, state: str = "") -> SessionLine:
    return SessionLine(UUID(int=number), "24 Oct 2026", conditions, "3 recordings", state, bool(state))


def test_thousands_of_patients_are_shown_and_searched_in_no_time(page: HomePage, qapp: QApplication) -> None:
    lines = [patient(number) for number in range(MANY)]
    began_s = process_time()
    page.show_patients(lines)
    qapp.processEvents()
    shown_s = process_time() - began_s
    began_s = process_time()
    QTest.keyClicks(page.search, "4")
    qapp.processEvents()
    searched_s = process_time() - began_s
    assert len(page.patients.lines) == sum("4" in f"P-{number:04d}" for number in range(MANY))
    assert shown_s < 3 * MOST_S  # half of it is the first painting
    assert searched_s < 2 * MOST_S


def test_the_chosen_patient_stays_chosen_when_the_list_is_read_again(page: HomePage) -> None:
    page.show_patients([patient(1), patient(2), patient(3)], UUID(int=2))
    assert page.patient_id == UUID(int=2)
    page.show_patients([patient(3), patient(2), patient(1)])
    assert page.patient_id == UUID(int=2)
    page.show_patients([patient(3), patient(1)])
    assert page.patient_id == UUID(int=3)


def test_an_empty_library_offers_a_patient_and_the_demonstration(qtbot: QtBot, page: HomePage) -> None:
    page.show_patients(())
    assert page.empty.isVisible()
    assert not page.search.isVisible()
    assert all(button.isVisible() and button.isEnabled() for button in page.empty.buttons)
    with qtbot.waitSignal(page.demonstration_requested):
        QTest.mouseClick(page.empty.demonstration, Qt.MouseButton.LeftButton)
    page.show_patients([patient(1)])
    assert not page.empty.isVisible()
    assert not page.nobody.isVisible()
    QTest.keyClicks(page.search, "nobody")
    assert page.nobody.isVisible()
    assert not page.empty.isVisible()


def test_the_first_patient_puts_the_focus_into_the_search(qtbot: QtBot, page: HomePage) -> None:
    """It went to the button beside, and Enter began another patient."""
    page.activateWindow()
    qtbot.waitUntil(page.isActiveWindow)
    page.show_patients([])
    page.focus()
    assert page.empty.new_patient.hasFocus()
    page.show_patients([patient(1)])
    assert page.search.hasFocus()


def test_a_line_states_all_of_itself_to_a_reader_of_screens(page: HomePage) -> None:
    page.show_patients([patient(147)])
    stated = page.patients.cells.data(page.patients.cells.index(0, 0), Qt.ItemDataRole.AccessibleTextRole)
    assert stated == "P-0147, 1968, male · left prosthetic, 24 Oct 2026, 5 sessions"
    page.show_sessions([session(1, "Alignment A", "recovered, needs review")])
    stated = page.sessions.cells.data(page.sessions.cells.index(0, 0), Qt.ItemDataRole.AccessibleTextRole)
    assert stated == "24 Oct 2026, Alignment A, 3 recordings, recovered, needs review"


@pytest.mark.parametrize(("width", "scale"), [(1064, 1.0), (736, 1.0), (736, 0.8), (1216, 2.0)])
def test_no_word_of_a_line_is_cut_or_lies_on_another(
    page: HomePage, qapp: QApplication, width: int, scale: float
) -> None:
    set_scale(scale)
    page.set_room(width / scale)
    page.resize(width, 728)
    page.show_patients([patient(1), patient(2, "1951, female · both sides affected, microprocessor knee")])
    page.show_patient("P-0001", "1968, male")
    page.show_sessions([session(1, "AFO, barefoot, alignment A, alignment B, alignment C", "recovered, needs review")])
    for _ in range(3):
        qapp.processEvents()
    for view in (page.patients, page.sessions):
        for at in range(view.cells.rowCount()):
            (cell,) = view.cells.rows[at].cells
            assert isinstance(cell, LineCell)
            rows = cell.word_rows(view.word_room, current_theme())
            for words in rows:
                spans = sorted((word.left, word.left + word.width(current_theme())) for word in words)
                assert all(before[1] <= after[0] for before, after in pairwise(spans))
                assert spans[0][0] >= 0
                assert spans[-1][1] <= view.word_room
            assert view.rowHeight(at) >= len(rows) * px(TEXT_ROW)
            painted = " ".join(word.text for words in rows for word in words).replace(" \N{MIDDLE DOT}", "")
            stated = cell.words.replace(" \N{MIDDLE DOT}", "")
            assert sorted(painted.replace(",", "").split()) == sorted(stated.replace(",", "").split())


def test_nothing_is_stated_of_patients_and_sessions_that_are_still_to_be_read(page: HomePage) -> None:
    assert not page.empty.isVisible()
    page.show_patients(())
    assert page.empty.isVisible()
    page.show_patients([patient(1)])
    page.show_patient("P-0001", "")
    page.show_sessions(())
    assert page.panel.none_yet.isVisible()
    page.show_sessions([session(1, "barefoot")])
    page.forget_sessions()
    assert len(page.sessions.lines) == 0
    assert not page.panel.none_yet.isVisible()
    page.forget_patients()
    assert len(page.patients.lines) == 0
    assert not page.empty.isVisible()


def test_a_list_that_is_read_again_keeps_choice_and_scroll(page: HomePage, qapp: QApplication) -> None:
    page.show_patients([patient(number) for number in range(1, 60)], UUID(int=30))
    qapp.processEvents()
    page.patients.verticalScrollBar().setValue(0)  # somebody looks elsewhere than at who is chosen
    page.show_patients([patient(number) for number in range(1, 61)])
    qapp.processEvents()
    assert page.patient_id == UUID(int=30)
    assert page.patients.verticalScrollBar().value() == 0
    assert len(page.patients.lines) == 60


def test_sessions_that_are_read_again_keep_the_one_that_is_chosen(page: HomePage) -> None:
    page.show_patients([patient(1)], UUID(int=1))
    page.show_patient("P-0001", "")
    page.show_sessions([session(2, "Barefoot"), session(1, "Barefoot")])
    page.sessions.choose_line(UUID(int=1))
    page.show_sessions([session(3, "Shoes"), session(2, "Barefoot"), session(1, "Barefoot")])
    assert page.sessions.line is not None
    assert page.sessions.line.id == UUID(int=1)


def test_values_and_states_of_visits_stand_under_one_another() -> None:
    states = ("Bericht ausstehend", "Bericht geschrieben")
    lines = tuple(
        SessionLine(uuid4(), "20. Sept. 2026", "Shoes", "24", state, is_reported=number > 0, speed=speed, knee=knee)
        for number, (state, speed, knee) in enumerate(
            zip(states, ("1,13 m/s", "0,85 m/s"), ("53°", "nicht ausgegeben"), strict=True)
        )
    )
    columns = VisitColumns(lines, ("Gehgeschwindigkeit", "Linkes Knie"))
    rights = []
    for line in lines:
        first, second = VisitCell(line, columns).word_rows(660, current_theme())
        placed = sorted(first, key=lambda word: word.left)
        ends = [word.left + word.width(current_theme()) for word in placed]
        assert [word.text for word in placed] == ["20. Sept. 2026", line.speed, line.knee, line.state]
        assert [word.text for word in second] == ["Shoes"]
        assert all(end + 8 < after.left for end, after in zip(ends, placed[1:], strict=False))
        assert ends[-1] <= 660
        rights.append((ends[1], ends[2], placed[3].left))
    assert rights[0] == rights[1], "columns are those of the list"


@pytest.mark.parametrize("speed", ["", "1.13 m/s"])
def test_a_heading_is_shown_only_over_a_column_that_has_values(speed: str) -> None:
    line = replace(session(1, "Shoes"), speed=speed)
    painted = []
    for heads in (("Walking speed", "Left knee"), ("", "")):
        image = QImage(660, 38, QImage.Format.Format_RGB32)
        image.fill(current_theme().colours.surface)
        with QPainter(image) as painter:
            VisitHead("Visits", VisitColumns([line], heads)).paint(painter, QRectF(image.rect()), current_theme())
        painted.append(image)
    assert (painted[0] != painted[1]) == bool(speed)


def test_the_last_change_is_in_a_patients_line_once_it_is_known(page: HomePage) -> None:
    page.show_patients([patient(1), patient(2)])
    page.change_patient(replace(patient(2), change="knee +18° since 1 Jul", arrow=Arrow(is_up=True, is_filled=True)))
    cells = page.patients.cells
    stated = [cells.data(cells.index(row, 0), Qt.ItemDataRole.AccessibleTextRole) for row in range(2)]
    assert [one.rsplit(", ", 1)[1] for one in stated] == ["5 sessions", "knee +18° since 1 Jul"]
    QTest.keyClicks(page.search, "P-0002")  # what is searched is what was changed
    line = page.patients.line
    assert isinstance(line, PatientLine)
    assert line.change == "knee +18° since 1 Jul"
    assert page.patient_id == UUID(int=2)


def test_only_patients_in_sight_are_asked_for(page: HomePage, qapp: QApplication) -> None:
    page.show_patients([patient(number) for number in range(MANY)])
    qapp.processEvents()
    assert 5 < len(page.patients.in_sight) < 12
    page.patients.choose(MANY - 1)
    assert page.patients.in_sight[-1].id == UUID(int=MANY - 1)
