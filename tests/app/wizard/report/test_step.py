"""The report step shows what will print, keeps the clinician's words, and saves the files that were chosen."""

import json
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from uuid import UUID, uuid4

import pypdf
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.editing.confirmation import is_confirmed
from app.exports.proposed_names import free_name, session_name
from app.reports.patient.document import ReportPreview
from app.storage.audit import about
from app.storage.exchange import import_session
from app.storage.library import Library
from app.storage.operators import CLINIC
from app.storage.shared_edits import SharedEdits
from app.storage.stored import Action, LibraryError
from app.summary.request import ReportRequest
from app.widgets.rail_row import StepState
from app.wizard.keys import Intent, KeyAction
from app.wizard.report import writing
from app.wizard.report.comment_editor import CommentState
from app.wizard.report.leaving_dialog import LeavingDialog
from app.wizard.report.printing import PRINTED_PPI
from app.wizard.report.step import ReportStep
from app.wizard.visit import Visit
from app.workers.library_controller import LibraryController
from core.body import Site
from core.results import Analysis
from core.session import RecordingKind, Session
from tests.app.drawn_clips import drawn_clip
from tests.app.wizard.begun_visit import begin
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press
from tests.app.wizard.report.test_page import png
from tests.simulated import analysis_of

Stated = list[tuple[str, str]]  # what, and the remedy
PAGES, DRAFT = ReportPreview.pages, ReportPreview.comment_draft


@pytest.fixture(scope="module")
def analysis(simulated_session: Session) -> Analysis:
    return analysis_of(simulated_session)


@pytest.fixture(autouse=True)
def _blank_pages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages and a draft at once, where a test is about neither: to set them takes half a second."""
    blank = [png(40.0)] * 4
    monkeypatch.setattr(ReportPreview, "pages", lambda *_: blank)
    monkeypatch.setattr(ReportPreview, "comment_draft", lambda *_: "A draft.")


@pytest.fixture
def typeset(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages and a draft as they are."""
    monkeypatch.setattr(ReportPreview, "pages", PAGES)
    monkeypatch.setattr(ReportPreview, "comment_draft", DRAFT)


@pytest.fixture
def blank_documents(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same of the files: a report without a page, a workbook without a sheet."""
    monkeypatch.setattr(writing, "make_report", lambda *_: b"%PDF-")
    monkeypatch.setattr(writing, "workbook", lambda *_: b"")


@pytest.fixture
def reported(step: ReportStep) -> Stated:
    """What the step states above its page, from now on."""
    stated: Stated = []
    step.reported.connect(lambda what, remedy: stated.append((what, remedy)))
    return stated


@pytest.fixture
def step(
    qtbot: QtBot,
    controller: LibraryController,
    visit: Visit,
    worn: dict[str, Site],
    simulated_session: Session,
    analysis: Analysis,
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[ReportStep]:
    """On its page, the library's earlier visits read."""
    begin(qtbot, visit, worn)
    visit.evaluation.session, visit.evaluation.analysis = simulated_session, analysis
    step = ReportStep(visit, controller)
    qtbot.addWidget(step.page)
    step.page.resize(1016, 600)
    step.page.show()
    read: list[object] = []
    show_visits = step.page.report.show_visits

    def noted(visits: Sequence[tuple[UUID, str]]) -> None:
        read.append(visits)
        show_visits(visits)

    monkeypatch.setattr(step.page.report, "show_visits", noted)
    step.enter()
    qtbot.waitUntil(lambda: bool(read))
    yield step
    step.leave()


@pytest.mark.usefixtures("typeset")
def test_pages_are_shown_and_made_again_with_the_words(
    qtbot: QtBot, step: ReportStep, visit: Visit, library: Library
) -> None:
    sheets = step.page.report.sheets
    qtbot.waitUntil(lambda: sheets.count >= 4)
    step.page.report.comment.setPlainText("Keep alignment C.")
    step.leave()
    assert step.comment == "Keep alignment C."
    session_id = present(visit.session).id
    qtbot.waitUntil(lambda: library.sessions.get(session_id).comment == "Keep alignment C.")


@pytest.mark.usefixtures("typeset")
def test_the_draft_from_the_findings_is_not_printed_and_once_confirmed_it_is_with_who_confirmed_it(
    qtbot: QtBot, step: ReportStep, visit: Visit, library: Library
) -> None:
    editor = step.page.report.editor
    qtbot.waitUntil(lambda: editor.state is CommentState.DRAFT)
    draft = editor.words
    assert "knee" in draft.lower()
    assert (request_of(step).comment, request_of(step).comment_by) == ("", "")
    assert "printed once you confirm it." in editor.note.text()
    editor.button.click()
    assert editor.state is CommentState.CONFIRMED
    by = present(visit.controller.state).operator.name
    assert by
    assert (request_of(step).comment, request_of(step).comment_by) == (draft, by)
    assert editor.note.text() == f"Confirmed by {by}. Printed on page one."
    session_id = present(visit.session).id
    qtbot.waitUntil(lambda: library.sessions.get(session_id).comment == draft)
    assert is_confirmed(draft, library.sessions.get(session_id).comment_confirmed)


def test_words_changed_after_they_were_confirmed_are_not_printed_until_they_are_again(
    qtbot: QtBot, step: ReportStep
) -> None:
    editor = step.page.report.editor
    editor.field.setPlainText("Keep alignment C.")
    assert editor.state is CommentState.TYPED
    editor.flush()
    assert request_of(step).comment == ""
    assert step.bar().note == "The clinical comment is not confirmed, so it is not printed."
    editor.button.click()
    assert request_of(step).comment == "Keep alignment C."
    editor.field.setPlainText("Keep alignment C. Pain.")
    step.page.report.editor.flush()
    assert (request_of(step).comment, editor.state) == ("", CommentState.TYPED)
    QTest.keyClick(editor.field, Qt.Key.Key_Return, Qt.KeyboardModifier.ControlModifier)
    assert request_of(step).comment == "Keep alignment C. Pain."


def test_a_draft_that_somebody_cleared_does_not_come_back_while_they_look(qtbot: QtBot, step: ReportStep) -> None:
    editor = step.page.report.editor
    qtbot.waitUntil(lambda: editor.state is CommentState.DRAFT)
    editor.field.setPlainText("")
    editor.flush()
    step.comments.take_draft("Another draft.")
    assert (editor.words, editor.state) == ("", CommentState.EMPTY)


def test_a_confirmation_that_the_library_refuses_prints_nothing(
    qtbot: QtBot, step: ReportStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise LibraryError("The library is busy", "Try again")

    monkeypatch.setattr(SharedEdits, "session", refuse)
    step.page.report.editor.field.setPlainText("Keep alignment C.")
    with qtbot.waitSignal(visit.record.refused):
        step.page.report.editor.button.click()
    assert request_of(step).comment == ""


def request_of(step: ReportStep) -> ReportRequest:
    return present(step.request())


def test_save_report_writes_one_pdf_and_nothing_beside_it(
    qtbot: QtBot, step: ReportStep, visit: Visit, library: Library, tmp_path: Path
) -> None:
    press(step, "Save report")
    assert proposed(step) == [report_name(visit)]
    out = tmp_path / "report.pdf"
    step.save_report(str(out))
    qtbot.waitUntil(lambda: step.state is StepState.DONE)
    assert [file.name for file in tmp_path.iterdir() if file.name != "library"] == ["report.pdf"]
    assert out.read_bytes().startswith(b"%PDF-")
    session_id = present(visit.session).id
    assert library.audit.entries(about("session", session_id))[-1].action == Action.EXPORT
    assert session_id in library.audit.reported([session_id])


def test_a_report_replaces_no_other_file_and_is_not_written_into_the_library(
    qtbot: QtBot, step: ReportStep, visit: Visit, reported: Stated, tmp_path: Path
) -> None:
    folder = present(visit.controller.state).library.folder
    other = tmp_path / "notes.pdf"
    other.write_text("no PDF")
    for out in (other, folder / "report.pdf"):
        with qtbot.waitSignal(step.reported):
            step.save_report(str(out))
    assert [what for what, _ in reported] == ["This already exists and is not a PDF.", "This lies inside the library."]
    assert other.read_text() == "no PDF"
    assert not (folder / "report.pdf").exists()
    assert step.state is StepState.TODO


@pytest.mark.usefixtures("blank_documents")
def test_the_letter_is_exported_where_it_was_chosen(
    qtbot: QtBot, step: ReportStep, visit: Visit, tmp_path: Path
) -> None:
    step.page.report.formats.choose(["letter"])
    step.save_in(str(tmp_path / "results"))
    qtbot.waitUntil(lambda: step.exported is not None)
    name = report_name(visit).removesuffix(".pdf")
    assert {file.name for file in (tmp_path / "results").iterdir()} == {
        *(f"{name}.pdf", f"{name}_letter.pdf", "results.xlsx")
    }
    text = pypdf.PdfReader(tmp_path / "results" / f"{name}_letter.pdf").pages[0].extract_text()
    assert "Your walking" in text


def test_the_letter_is_printed_by_one_press_in_the_language_chosen_beside_it(
    qtbot: QtBot, step: ReportStep, visit: Visit, library: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[tuple[str, float]] = []

    def pages(_request: object, language: str, ppi: float) -> list[bytes]:
        drawn.append((language, ppi))
        return []

    monkeypatch.setattr(writing, "letter_pages", pages)
    asked: list[str] = []
    monkeypatch.setattr(step.letter_printer, "ask", lambda name, _paper: asked.append(name))
    step.page.report.language.choose("de")
    press(step, "Patient letter")
    assert asked == [f"{report_name(visit).removesuffix('.pdf')}_letter"]
    step.letter_printer.confirmed.emit()
    qtbot.waitUntil(lambda: bool(drawn))
    assert drawn == [("de", PRINTED_PPI)]
    noted = library.audit.entries(about("session", present(visit.session).id))[-1]
    assert (noted.action, json.loads(noted.details)["format"]) == (Action.PRINT, "letter")


def report_name(visit: Visit) -> str:
    """By the patient's code and the day."""
    details = present(visit.session).details
    return f"{session_name(details.patient.code, details.started)}.pdf"


def proposed(step: ReportStep) -> list[str]:
    """What the dialog that is open proposes, which is then closed."""
    dialog = present(step.dialog)
    dialog.close()
    return [Path(path).name for path in dialog.selectedFiles()]


def test_the_chosen_files_are_saved(
    qtbot: QtBot, step: ReportStep, visit: Visit, reported: Stated, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    out = tmp_path / "results"
    step.page.report.formats.choose(["csv"])
    step.save_in(str(out))
    qtbot.waitUntil(lambda: step.exported is not None)
    assert reported == [("", "")]
    assert [file.name for file in out.glob("*.pdf")] == [report_name(visit)]
    assert (out / report_name(visit)).read_bytes().startswith(b"%PDF-")
    assert (out / "summary.json").exists()
    assert not (out / "session.rrd").exists()
    assert step.bar().note == "Saved as results."
    request.getfixturevalue("blank_documents")
    step.save_report(str(tmp_path / "first.pdf"))
    qtbot.waitUntil(lambda: step.saved is not None)
    assert step.bar().note == "Saved as first.pdf."
    step.save_in(str(tmp_path / "more"))
    qtbot.waitUntil(lambda: step.exported == tmp_path / "more")
    assert step.bar().note == "Saved as more."


@pytest.mark.usefixtures("blank_documents")
def test_a_file_that_was_not_written_is_named_with_its_reason(
    qtbot: QtBot, step: ReportStep, reported: Stated, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = ["walk 1, mot: No angle of it can be given as a pose."]
    monkeypatch.setattr(writing, "export_from_library", lambda *_, **__: lines)
    step.page.report.formats.choose(["mot"])
    step.save_in(str(tmp_path / "results"))
    qtbot.waitUntil(lambda: step.exported is not None)
    assert reported == [("Not every file was written.", lines[0])]


def test_what_is_printed_is_in_the_audit_before_a_page_is_made(
    qtbot: QtBot, step: ReportStep, visit: Visit, library: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    subject, noted = about("session", present(visit.session).id), list[list[str]]()

    def pages(_preview: ReportPreview, _request: object, ppi: float) -> list[bytes]:
        if ppi == PRINTED_PPI:  # else for the look before
            noted.append([entry.action for entry in library.audit.entries(subject)])
        return []

    monkeypatch.setattr(ReportPreview, "pages", pages)
    qtbot.waitUntil(step.can_save)
    step.printer.confirmed.emit()
    qtbot.waitUntil(lambda: bool(noted))
    assert noted[-1][-1] == Action.PRINT


def dialog_of(qtbot: QtBot, step: ReportStep) -> LeavingDialog:
    """What is asked before files without a name are saved."""
    qtbot.waitUntil(lambda: step.page.findChild(LeavingDialog) is not None)
    return present(step.page.findChild(LeavingDialog))


@pytest.mark.endurance
def test_what_leaves_without_the_name_is_shown_first_and_nothing_typed_but_what_is_ticked(
    qtbot: QtBot, step: ReportStep, visit: Visit, library: Library, simulated_session: Session, tmp_path: Path
) -> None:
    opened = present(visit.controller.state).library
    patients, patient = library.patients, library.patients.get(present(visit.session).patient_id)
    reported = replace(simulated_session, started="2026-11-20T10:00:00+00:00")
    imported = import_session(opened, reported, lambda _share, _what: None, patient.details.code)
    visit.record.resume(library.sessions.get(imported.session_id))
    patients.change(patient, replace(patient.details, birth_year=1950, device="Qx1 knee", aids="Qx2 stick"))
    step.page.report.formats.choose(["xlsx", "fhir"])
    press(step, "Export data")
    dialog = dialog_of(qtbot, step)
    shown = dict(dialog.shown)
    assert shown["patient"] != patient.details.code
    assert "device" not in shown
    assert "birth year" not in shown
    assert shown["age, years"] == "76"
    dialog.typed.buttons[0].click()
    assert dict(dialog.shown)["device"] == "Qx1 knee"
    dialog.go.click()
    qtbot.waitUntil(lambda: step.dialog is not None)
    present(step.dialog).close()
    out = tmp_path / "results"
    step.save_in(str(out))
    qtbot.waitUntil(lambda: step.exported is not None)
    with zipfile.ZipFile(out / "gaitwright.xlsx") as book:
        stated = b"".join(book.read(name) for name in book.namelist()).decode()
    assert shown["patient"] in stated
    assert "Qx1 knee" in stated
    assert "Qx2 stick" not in stated
    assert patient.details.code not in stated.replace(shown["patient"], "")  # which begins as the code does


def test_nothing_is_asked_where_no_file_leaves_without_the_name(qtbot: QtBot, step: ReportStep, visit: Visit) -> None:
    step.page.report.formats.choose(["csv", "rrd"])
    press(step, "Export data")
    assert proposed(step) == [report_name(visit).removesuffix(".pdf")]
    assert step.page.findChild(LeavingDialog) is None


def test_of_a_free_motion_alone_no_report_is_offered(step: ReportStep, visit: Visit, analysis: Analysis) -> None:
    assert present(step.bar().primary).is_enabled
    moved = tuple(one for one in analysis.recordings if one.kind is RecordingKind.FREE_MOTION)
    assert moved
    visit.evaluation.analysis = replace(analysis, recordings=moved)
    step._show()
    assert not present(step.bar().primary).is_enabled
    assert step.page.currentWidget() is step.page.sentence


def test_whoever_cancels_writes_nothing(qtbot: QtBot, step: ReportStep) -> None:
    step.page.report.formats.choose(["fhir"])
    press(step, "Export data")
    dialog = dialog_of(qtbot, step)
    dialog.cancel.click()
    qtbot.waitUntil(lambda: step.page.findChild(LeavingDialog) is None)
    assert step.dialog is None


@pytest.mark.endurance
def test_an_earlier_visit_is_compared_with_and_the_clinic_named(
    qtbot: QtBot,
    controller: LibraryController,
    visit: Visit,
    simulated_session: Session,
    step: ReportStep,
    tmp_path: Path,
) -> None:
    code = present(visit.session).details.patient.code
    earlier = replace(simulated_session, started="2020-03-01T10:00:00+00:00")
    opened, silent = present(controller.state).library, lambda _share, _what: None
    earlier_id = import_session(opened, earlier, silent, code).session_id
    opened.library.settings.put(CLINIC, "Clinic North")
    step.enter()
    report = step.page.report
    qtbot.waitUntil(lambda: report.earlier.count() == 2)
    assert report.earlier.isVisible()
    report.earlier.setCurrentIndex(1)
    report.earlier.activated.emit(1)
    assert report.chosen_visit == earlier_id
    assert not present(step.bar().primary).is_enabled
    qtbot.waitUntil(lambda: present(step.bar().primary).is_enabled)
    step.save_in(str(tmp_path / "results"))
    qtbot.waitUntil(lambda: step.exported is not None)
    text = "".join(page.extract_text() for page in pypdf.PdfReader(tmp_path / "results" / report_name(visit)).pages)
    assert "Comparison of visits" in text
    assert "1 Mar 2020" in text
    assert "Clinic North" in text
    header, first, *_ = (tmp_path / "results" / "visits.csv").read_text().splitlines()
    assert header.startswith("part,name,walks,against_part")
    assert first.startswith("2,")


def test_a_preview_that_fails_goes_blank_and_states_so_until_one_can_be_shown(
    qtbot: QtBot, step: ReportStep, reported: Stated, monkeypatch: pytest.MonkeyPatch
) -> None:
    sheets = step.page.report.sheets
    qtbot.waitUntil(lambda: sheets.count >= 4)

    def fail(*_: object) -> None:
        raise KeyError("no such column")

    with monkeypatch.context() as broken:
        broken.setattr(ReportPreview, "pages", fail)
        step.page.report.options_changed.emit()
        qtbot.waitUntil(lambda: bool(reported))
    assert sheets.count == 0
    assert reported[-1] == ("The report cannot be shown.", "See the log for details.")
    step.page.report.options_changed.emit()
    qtbot.waitUntil(lambda: sheets.count >= 4)
    assert reported[-1] == ("", "")


def test_an_earlier_visit_that_cannot_be_read_leaves_no_page_of_another_comparison_and_nothing_to_save(
    qtbot: QtBot, step: ReportStep, reported: Stated, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise LibraryError("the visit cannot be read", "Choose another")

    monkeypatch.setattr("app.wizard.report.step.read_analysed", refuse)
    report = step.page.report
    qtbot.waitUntil(lambda: report.sheets.count >= 4)
    report.show_visits([(uuid4(), "1 Jul 2026")])
    report.earlier.setCurrentIndex(1)
    report.earlier.activated.emit(1)
    qtbot.waitUntil(lambda: bool(reported))
    assert report.sheets.count == 0
    assert not step.can_save()
    report.earlier.setCurrentIndex(0)
    report.earlier.activated.emit(0)
    qtbot.waitUntil(lambda: report.sheets.count >= 4)
    assert step.can_save()


def test_ctrl_s_saves_as_its_cap_states(qtbot: QtBot, visit: Visit, monkeypatch: pytest.MonkeyPatch) -> None:
    step = ReportStep(visit, visit.controller)
    qtbot.addWidget(step.page)
    pressed = []
    monkeypatch.setattr(step, "_save", lambda: pressed.append("save"))
    primary = present(step.bar().primary)
    assert primary.key == "Ctrl S"
    primary.run()
    assert step.on_intent(Intent(KeyAction.SAVE))
    assert pressed == ["save", "save"]
    assert not step.on_intent(Intent(KeyAction.RUN))


@pytest.mark.parametrize(
    ("code", "name"),
    [
        ("P-0158", "P-0158_2026-11-20"),
        ("../..", "______2026-11-20"),
        ("a/b:c*", "a_b_c__2026-11-20"),
        ("", "session_2026-11-20"),
        ("Ä1", "Ä1_2026-11-20"),
        ("x" * 300, "x" * 60 + "_2026-11-20"),
    ],
)
def test_the_folder_proposed_is_named_by_code_and_day_and_by_nothing_a_system_refuses(code: str, name: str) -> None:
    assert session_name(code, "2026-11-20T10:00:00+00:00") == name


def test_what_is_no_report_is_named_so_and_a_day_nobody_knows_leaves_no_gap() -> None:
    assert session_name("P-1", "2026-11-23T08:00:00+00:00", "how-found") == "P-1_2026-11-23_how-found"
    assert session_name("", "", "how-found") == "session_how-found"


def test_a_second_session_of_a_day_is_proposed_a_folder_of_its_own(tmp_path: Path) -> None:
    assert free_name(tmp_path, "P-1_2026-11-23") == "P-1_2026-11-23"
    for taken in ("P-1_2026-11-23", "P-1_2026-11-23_2"):
        (tmp_path / taken).mkdir()
    assert free_name(tmp_path, "P-1_2026-11-23") == "P-1_2026-11-23_3"


def test_pictures_of_the_video_are_in_the_report_only_where_somebody_chose_them(
    qtbot: QtBot, step: ReportStep, visit: Visit, analysis: Analysis
) -> None:
    report = step.page.report
    assert not report.video.isVisible()
    walk = next(one for one in analysis.recordings if one.name == request_of(step).walks[-1])
    clip = drawn_clip(walk, size=(64, 36))
    visit.clips.opened.emit((replace(clip, sync=None),))
    assert not report.video.isVisible()  # nobody knows which moment a frame is of
    visit.clips.opened.emit((clip,))
    assert report.video.isVisible()
    assert request_of(step).key_frames == ()
    report.video.click()
    assert len(request_of(step).key_frames) in (4, 8)
    visit.clips.opened.emit(())
    assert not report.video.isVisible()
    assert request_of(step).key_frames == ()


def test_pictures_are_offered_also_where_the_results_come_after_the_video(
    step: ReportStep, visit: Visit, analysis: Analysis
) -> None:
    report, evaluation = step.page.report, visit.evaluation
    walk = next(one for one in analysis.recordings if one.name == request_of(step).walks[-1])
    session = evaluation.session
    evaluation.session = evaluation.analysis = None
    visit.clips.opened.emit((drawn_clip(walk, size=(64, 36)),))
    assert not report.video.isVisible()
    evaluation.session, evaluation.analysis = session, analysis
    evaluation.done.emit()
    assert report.video.isVisible()
