"""Every requirement has a test, every risk a control, every use error its message."""

import importlib
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest
from babel.messages.pofile import read_po

from app.wording.findings import SENTENCES
from tests.safety.broken_controls import ROOT, controls

PACKAGING = Path(__file__).parents[2] / "packaging"


@pytest.fixture
def tables() -> ModuleType:
    return importlib.import_module("safety_tables")


def test_requirements_risks_and_use_errors_lead_to_tests_that_are_there(tables: ModuleType) -> None:
    assert tables.faults() == []


def test_the_tables_hold_every_entry_and_are_not_committed(tables: ModuleType) -> None:
    made = tables.pages()
    assert set(made) == set(tables.TABLES)
    entries = (tables.requirements(), tables.risks(), tables.use_errors())
    for text, known in zip(made.values(), entries, strict=True):
        assert [one.id for one in known if one.id not in text] == []
    ignored = (PACKAGING.parent / ".gitignore").read_text(encoding="utf-8").splitlines()
    assert {f"packaging/safety/{name}" for name in made} <= set(ignored)


def test_the_sentences_of_the_screen_are_those_of_the_catalogue(tables: ModuleType) -> None:
    with tables.TEMPLATE.open("rb") as file:
        ids = [one.id for one in read_po(file) if one.id]
    every = {text for one in ids for text in ([one] if isinstance(one, str) else one)}
    assert every | set(SENTENCES) == set(tables.sentences_of_screen())


def test_each_control_that_is_broken_on_purpose_is_in_the_code_once(tables: ModuleType) -> None:
    every = controls([])
    found = {one: (ROOT / one.file).read_text(encoding="utf-8").count(one.find) for one in every}
    assert [(one.requirement, one.what, count) for one, count in found.items() if count != 1] == []
    assert {one.requirement for one in every} <= {one.id for one in tables.requirements()}


def test_a_requirement_that_leads_nowhere_is_named(tables: ModuleType) -> None:
    known = tables.requirements()[0]
    gone = "tests/core/test_goals.py::test_that_was_renamed"
    recorded = "tests/core/test_hinge_recordings.py::test_a_mechanical_hinge_is_called_one"
    wrong = {
        f"{known.id} has no test": replace(known, tests=()),
        f"{known.id}: there is no test {gone}": replace(known, tests=(*known.tests, gone)),
        f"{known.id}: no test of the default run holds it where the shared recordings are not at hand": replace(
            known, tests=(recorded,)
        ),
        f"{known.id}: there is no script tests.safety.nothing": replace(known, runs=("tests.safety.nothing",)),
        f"{known.id}: the source 'hearsay' is not among the sources": replace(known, source="hearsay"),
        "R1 is no id, such as R-REC-01": replace(known, id="R1"),
    }
    for fault, changed in wrong.items():
        assert fault in list(tables.faults_of_requirements([changed], {known.source})), fault
    assert list(tables.faults_of_requirements([known, known], {known.source})) == [f"{known.id} is there twice"]


def test_a_risk_without_a_control_or_whose_controls_leave_it_is_named(tables: ModuleType) -> None:
    risk = tables.risks()[0]
    known = set(risk.controls)
    wrong = {
        f"{risk.id} has no control": replace(risk, controls=()),
        f"{risk.id}: there is no requirement R-REC-99": replace(risk, controls=("R-REC-99",)),
        f"{risk.id}: 9 x 1 is not on the scale": replace(risk, before=(9, 1)),
        f"{risk.id}: the controls leave 9 of 9": replace(risk, before=(3, 3), after=(3, 3)),
        f"{risk.id}: the controls leave 4 of 2": replace(risk, before=(1, 2), after=(2, 2)),
    }
    for fault, changed in wrong.items():
        assert list(tables.faults_of_risks([changed], known)) == [fault]
    assert list(tables.faults_of_risks([risk], known)) == []


def test_a_use_error_without_a_message_is_named(tables: ModuleType) -> None:
    error = tables.use_errors()[0]
    wrong = {
        f"{error.id}: no message reads 'Well done.'": replace(error, messages=("Well done.",)),
        f"{error.id} meets no message": replace(error, messages=()),
        f"{error.id} has no test": replace(error, tests=()),
    }
    for fault, changed in wrong.items():
        assert list(tables.faults_of_use_errors([changed])) == [fault]


def test_a_promise_that_no_test_holds_is_named(tables: ModuleType) -> None:
    model = (tables.SAFETY / "threat_model.md").read_text(encoding="utf-8")
    security = (tables.ROOT / "SECURITY.md").read_text(encoding="utf-8")
    row, silent = "| x | T: y | z | R-PRI-01 |", "test_a_server_that_falls_silent_amid_a_statement_is_given_up"
    assert list(tables.faults_of_promises("a page", model)) == []
    assert list(tables.faults_of_promises("a page", security)) == []
    assert len(list(tables.promises(model))) > 40
    assert len(list(tables.promises(security))) > 6
    wrong = {
        f"a page: no test holds: {row}": model.replace("| journals |", f"{row}\n| journals |"),
        "a page: there is no note nothing": model.replace("| R-PRI-04 [^audit] |", "| [^nothing] [^audit] |"),
        "a page: nothing is promised by the note more": f"{model}[^more]: `{tables.NODE.findall(model)[0]}`\n",
        "a page: silent is held by long tests alone where its note ends with (long), and only there": model.replace(
            f"{silent}` (long)", f"{silent}`"
        ),
        "a page: there is no script tests.safety.nothing": model.replace("tests.safety.bombs", "tests.safety.nothing"),
        "a page: no test holds: Everything.": security.replace("defended\n\n", "defended\n\n- Everything.\n", 1),
    }
    for fault, changed in wrong.items():
        assert list(tables.faults_of_promises("a page", changed)) == [fault]


def test_each_test_bears_the_requirements_that_it_holds(request: pytest.FixtureRequest, tables: ModuleType) -> None:
    """Of the tests that were collected with this one: by the whole run, of all."""
    held = {(test, one.id) for one in tables.requirements() for test in one.tests}
    collected = {item.nodeid.partition("[")[0] for item in request.session.items}
    marked = {
        (item.nodeid.partition("[")[0], mark.kwargs["id"])
        for item in request.session.items
        for mark in item.iter_markers("requirement")
    }
    assert marked == {(test, one) for test, one in held if test in collected}
