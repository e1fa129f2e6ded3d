"""The page of the patient: what is typed comes out as it is, and what is not typed stays as it was."""

from dataclasses import replace
from datetime import date

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QLabel, QLineEdit
from pytestqt.qtbot import QtBot

from app.theme.current import set_scale
from app.wizard.patient.cards import LastVisit
from app.wizard.patient.page import PatientDraft, PatientPage
from app.wording.translation import use_language
from core.body import Side
from core.prosthesis import AmputationLevel, FootKind, KneeKind, Prosthesis
from core.session import Patient

KNOWN = Patient(
    code="P-0147",
    birth_year=1968,
    sex="male",
    height_m=1.785,
    mass_kg=82.5,
    device="Microprocessor knee",
    aids="shoes, rollator",
    prosthetic_side="left",
    affected_side="right",
)


@pytest.fixture
def page(qtbot: QtBot) -> PatientPage:
    page = PatientPage(today=date(2026, 11, 21))
    qtbot.addWidget(page)
    page.resize(1064, 672)
    page.show()
    return page


@pytest.fixture
def edits(page: PatientPage) -> list[PatientDraft]:
    received: list[PatientDraft] = []
    page.edited.connect(received.append)
    return received


def type_into(line: QLineEdit, text: str) -> None:
    line.selectAll()
    QTest.keyClicks(line, text)


def test_a_patient_comes_out_as_shown_and_showing_is_no_edit(page: PatientPage, edits: list[PatientDraft]) -> None:
    draft = PatientDraft(KNOWN, frozenset({Side.LEFT}))
    page.show_draft(draft)
    assert page.draft == draft
    assert edits == []


def test_every_letter_is_reported(page: PatientPage, edits: list[PatientDraft]) -> None:
    page.focus()
    type_into(page.code.line_edit, "P-1")
    assert [draft.patient.code for draft in edits] == ["P", "P-", "P-1"]
    assert edits[-1].patient == Patient(code="P-1")


def test_a_number_half_typed_leaves_the_one_from_before(page: PatientPage) -> None:
    page.show_draft(PatientDraft(KNOWN))
    type_into(page.height_cm.line_edit, "17")
    assert page.draft.patient.height_m == 1.785
    type_into(page.height_cm.line_edit, "178,5")
    assert page.draft.patient.height_m == 1.785
    type_into(page.height_cm.line_edit, "180")
    assert page.draft.patient.height_m == 1.8
    page.height_cm.line_edit.selectAll()
    QTest.keyClick(page.height_cm.line_edit, Qt.Key.Key_Delete)
    assert page.draft.patient.height_m is None


def test_a_prosthetic_side_is_asked_about_its_ankle(page: PatientPage, edits: list[PatientDraft]) -> None:
    assert not page.limb.isEnabled()
    assert not page.ankles[Side.RIGHT].isVisible()
    page.side.segments[2].click()
    page.limb.segments[1].click()
    assert edits[-1].patient.prosthetic_side == "right"
    assert page.ankles[Side.RIGHT].isVisible()
    assert not page.ankles[Side.LEFT].isVisible()
    page.ankles[Side.RIGHT].buttons[0].click()
    assert edits[-1].without_ankle == {Side.RIGHT}
    page.limb.segments[0].click()
    assert edits[-1] == PatientDraft(Patient(affected_side="right", prosthetic_side="none"))


TRANSTIBIAL = Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)
TRANSFEMORAL = Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.POLYCENTRIC)


@pytest.mark.parametrize(
    "prostheses",
    [
        {Side.LEFT: TRANSTIBIAL},
        {Side.LEFT: TRANSFEMORAL},
        {Side.LEFT: Prosthesis(AmputationLevel.PARTIAL_FOOT)},
        {Side.LEFT: Prosthesis(foot=FootKind.SACH), Side.RIGHT: TRANSFEMORAL},  # the right one is not worn
    ],
)
def test_what_is_stated_of_a_prosthesis_comes_out_as_shown(
    page: PatientPage, edits: list[PatientDraft], prostheses: dict[Side, Prosthesis]
) -> None:
    draft = PatientDraft(replace(KNOWN, prostheses=prostheses))
    page.show_draft(draft)
    assert page.draft == draft
    assert edits == []


def test_a_prosthesis_is_stated_by_keys_alone(page: PatientPage, edits: list[PatientDraft]) -> None:
    page.show_draft(PatientDraft(replace(KNOWN, prosthetic_side="left")))
    level, knee, foot = page.prostheses[Side.LEFT].choices
    assert [one.isVisible() for one in (level, knee, foot)] == [True, False, True]
    assert [one in page.tab_order for one in (level, knee, foot)] == [True, True, True]
    page.aids.buttons[0].setFocus()
    QTest.keyClick(page.aids.buttons[0], Qt.Key.Key_Tab)
    assert level.hasFocus()
    for _ in range(5):
        QTest.keyClick(level, Qt.Key.Key_Down)
    assert edits[-1].patient.worn == {Side.LEFT: Prosthesis(AmputationLevel.TRANSFEMORAL)}
    QTest.keyClick(level, Qt.Key.Key_Tab)
    assert knee.hasFocus()
    QTest.keyClick(knee, Qt.Key.Key_End)
    assert edits[-1].patient.worn == {Side.LEFT: Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.MICROPROCESSOR)}
    QTest.keyClick(level, Qt.Key.Key_Up)
    QTest.keyClick(level, Qt.Key.Key_Up)
    assert edits[-1].patient.worn == {Side.LEFT: Prosthesis(AmputationLevel.TRANSTIBIAL)}
    assert not knee.isVisible()
    QTest.keyClick(level, Qt.Key.Key_Down)
    knee_again = Prosthesis(AmputationLevel.KNEE_DISARTICULATION, KneeKind.MICROPROCESSOR)
    assert edits[-1].patient.worn == {Side.LEFT: knee_again}, "a level chosen by mistake costs nothing"
    QTest.keyClick(foot, Qt.Key.Key_Down)
    assert edits[-1].patient.worn == {Side.LEFT: replace(knee_again, foot=FootKind.SACH)}
    QTest.keyClick(level, Qt.Key.Key_Home)
    QTest.keyClick(foot, Qt.Key.Key_Home)
    assert edits[-1].patient.prostheses == {}


def test_only_a_foot_of_no_stated_kind_is_asked_about_its_ankle(page: PatientPage, edits: list[PatientDraft]) -> None:
    page.show_draft(PatientDraft(KNOWN, frozenset({Side.LEFT})))
    level, _, foot = page.prostheses[Side.LEFT].choices
    assert page.ankles[Side.LEFT].isVisible()
    assert words_of(page).isdisjoint({RELATIVE})
    QTest.keyClick(foot, Qt.Key.Key_Down)
    assert not page.ankles[Side.LEFT].isVisible()
    assert edits[-1].without_ankle == set(), "its kind is asked, not what was answered before"
    assert RELATIVE in words_of(page)
    QTest.keyClick(foot, Qt.Key.Key_Down)  # single-axis
    assert words_of(page).isdisjoint({RELATIVE})
    QTest.keyClick(foot, Qt.Key.Key_Home)
    assert page.ankles[Side.LEFT].isVisible()
    QTest.keyClick(level, Qt.Key.Key_Down)  # a part of the foot, whose ankle is left
    assert not page.ankles[Side.LEFT].isVisible()
    assert not foot.isVisible()


def test_each_prosthetic_side_has_its_line_and_another_none(page: PatientPage) -> None:
    for side, shown in (("left", [Side.LEFT]), ("right", [Side.RIGHT]), ("both", [*Side]), ("none", [])):
        page.show_draft(PatientDraft(replace(KNOWN, prosthetic_side=side)))
        assert [one for one in Side if page.prostheses[one].isVisible()] == shown


def test_another_side_takes_what_was_stated_of_the_one_before_from_the_patient(
    page: PatientPage, edits: list[PatientDraft]
) -> None:
    page.show_draft(PatientDraft(replace(KNOWN, prostheses={Side.LEFT: TRANSTIBIAL})))
    page.side.segments[2].click()
    assert edits[-1].patient.prostheses == {}
    page.side.segments[1].click()
    assert edits[-1].patient.prostheses == {Side.LEFT: TRANSTIBIAL}


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_no_choice_of_a_prosthesis_is_cut(qtbot: QtBot, language: str, scale: float) -> None:
    use_language(language)
    set_scale(scale)
    try:
        page = PatientPage(today=date(2026, 11, 21))
        qtbot.addWidget(page)
        page.resize(1064, 672)
        page.set_compact(scale > 1)
        longest = Prosthesis(
            AmputationLevel.KNEE_DISARTICULATION, KneeKind.FLUID_CONTROLLED, FootKind.MICROPROCESSOR_ANKLE
        )
        syme = Prosthesis(AmputationLevel.ANKLE_DISARTICULATION, foot=FootKind.MICROPROCESSOR_ANKLE)
        worn = {Side.LEFT: longest, Side.RIGHT: syme}
        page.show_draft(PatientDraft(replace(KNOWN, prosthetic_side="both", prostheses=worn)))
        with qtbot.waitExposed(page):
            page.show()
        choices = [one for row in page.prostheses.values() for one in row.choices if one.isVisible()]
        assert len(choices) == 5
        qtbot.waitUntil(lambda: [one.currentText() for one in choices if one.is_cut] == [])  # once all is laid out
        assert all(one.mapTo(page, QPoint(one.width(), 0)).x() <= page.width() for one in choices)
    finally:
        use_language("en")


RELATIVE = "Without ankle joint, the angle is called “foot relative to shank”."


def words_of(page: PatientPage) -> set[str]:
    return {label.text() for label in page.findChildren(QLabel) if label.isVisible()}


def test_where_the_prosthetic_foot_is_asked_about_nothing_else_moves_down(page: PatientPage, qtbot: QtBot) -> None:
    """Its row came under the pointer that had just chosen it, and pushed down what was there."""
    page.side.segments[2].click()
    controls = [page.code, page.sex, page.side, page.limb, page.device, page.aids]
    qtbot.wait(20)
    before = [one.mapTo(page, QPoint(0, 0)).y() for one in controls]
    assert not page.ankles[Side.RIGHT].isVisible()
    page.limb.segments[1].click()
    qtbot.waitUntil(page.ankles[Side.RIGHT].isVisible)
    qtbot.wait(20)
    assert [one.mapTo(page, QPoint(0, 0)).y() for one in controls] == before


def test_aids_are_chosen_by_arrows_and_space(page: PatientPage, edits: list[PatientDraft]) -> None:
    page.show_draft(PatientDraft(KNOWN))
    chips = page.aids.buttons
    assert [chip.text() for chip in chips][-1] == "rollator"
    chips[0].setFocus()
    QTest.keyClick(chips[0], Qt.Key.Key_Right)
    assert chips[1].hasFocus()
    QTest.keyClick(chips[1], Qt.Key.Key_Space)
    assert edits[-1].patient.aids == "barefoot, rollator", "shoes and barefoot exclude each other"
    assert [chip.focusPolicy() for chip in chips].count(Qt.FocusPolicy.StrongFocus) == 1


def test_a_code_in_use_is_stated_and_offered(page: PatientPage) -> None:
    opened: list[str] = []
    page.open_pressed.connect(opened.append)
    type_into(page.code.line_edit, "P-0147")
    page.show_code_taken("P-0147")
    assert "P-0147 already exists. Open that patient, or choose another code." in page.code.line_edit.accessibleName()
    button = next(one for one in page.findChildren(QAbstractButton) if one.text() == "Open this patient")
    assert button.isVisible()
    QTest.keyClick(button, Qt.Key.Key_Return)
    assert opened == ["P-0147"]
    type_into(page.code.line_edit, "P-0148")
    assert not button.isVisible()
    assert not page.code.is_wrong


@pytest.mark.parametrize(
    ("birth_year", "words"),
    [
        (None, "Enter the birth year to check whether the reference fits the age"),
        (1968, "The reference does not cover age 58. It is shown, but differences from it are not reported."),
        (2000, "The speed must also fit; checking it requires the body height"),
        (2016, "The reference is for adults. Gait differs at age 10, so the reference is not shown."),
    ],
)
def test_the_band_states_whom_it_is_of(page: PatientPage, birth_year: int | None, words: str) -> None:
    page.show_draft(PatientDraft(Patient(code="P-1", birth_year=birth_year)))
    texts = [label.text() for label in page.findChildren(QLabel)]
    assert any(words in text for text in texts)
    assert any(text.startswith("24 young adults, barefoot") for text in texts)


def test_the_last_visit_can_be_had_again(page: PatientPage, qtbot: QtBot) -> None:
    button = next(one for one in page.findChildren(QAbstractButton) if one.text() == "Use last visit's set-up")
    assert not button.isVisible()
    page.show_last_visit(LastVisit("Last visit, 24 October 2026", (("Walks", "A, B"), ("Zero", "all 0°"))))
    page.show_last_visit(LastVisit("Last visit, 1 November 2026", (("Walks", "C"),)))
    assert button.isVisible()
    with qtbot.waitSignal(page.same_set_up_pressed):
        QTest.keyClick(button, Qt.Key.Key_Space)


def test_the_side_is_the_first_question_after_the_code_by_keyboard_and_in_sight(page: PatientPage) -> None:
    page.show_draft(PatientDraft(KNOWN))
    order = page.tab_order
    assert order[:5] == [page.code.line_edit, *page.side.segments]
    for is_compact, size in ((False, (1064, 672)), (True, (736, 432))):
        page.set_compact(is_compact)
        page.resize(*size)
        QTest.qWait(1)
        places = [control.mapTo(page, QPoint()) for control in order if control.isVisible()]
        assert (places[0].y(), places[0].x()) < (places[1].y() + page.height() // 10, places[1].x() + 1)
        assert all(places[1].y() < later.y() for later in places[5:])


def test_every_control_has_a_name_and_nothing_is_wider_than_the_page(page: PatientPage) -> None:
    page.show_draft(PatientDraft(KNOWN))
    for is_compact, size in ((False, (1064, 672)), (True, (736, 432))):
        page.set_compact(is_compact)
        page.resize(*size)
        QTest.qWait(1)
        for control in page.tab_order:
            assert control.accessibleName(), control
            if control.isVisible():
                left = control.mapTo(page, control.rect().topLeft()).x()
                assert left >= 0
                assert left + control.width() <= page.width()
