"""What is stated of a prosthesis leaves with the files that have a place for it, and changes none where nothing is."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from fhir.resources.R4B.bundle import Bundle

from app.exports.bids_motion import write_bids
from app.exports.fhir_bundle import bundle, write_bundle
from app.exports.pseudonymised import what_leaves
from app.exports.spreadsheet import write_spreadsheet
from app.exports.summary import summarise
from core.body import Side
from core.prosthesis import NOT_STATED, AmputationLevel, FootKind, KneeKind, Prosthesis
from core.session import Patient
from tests.app.exports.conftest import Visit
from tests.simulated import analysis_of

LEFT = Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.POLYCENTRIC)
RIGHT = Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)
SIDES = Patient(code="P 17", affected_side="left", prosthetic_side="both")
STATED = replace(SIDES, prostheses={Side.LEFT: LEFT, Side.RIGHT: RIGHT})


@pytest.fixture(scope="module")
def stated(visit: Visit) -> Visit:
    session = replace(visit[0], patient=STATED)
    return session, analysis_of(session)


def as_written(value: object) -> Any:
    return json.loads(json.dumps(value))


def test_the_summary_ends_with_what_was_taken_for_true(stated: Visit) -> None:
    summary = as_written(summarise(stated[1]))
    assert list(summary)[-1] == "prostheses"
    assert summary["prostheses"] == {
        "left": {"level": "transfemoral", "knee": "polycentric"},
        "right": {"level": "transtibial", "foot": "energy_storing"},
    }


def test_a_participant_has_a_column_for_each_part_that_is_stated(stated: Visit, tmp_path: Path) -> None:
    write_bids(*stated, tmp_path)
    names, values = ((line.split("\t")) for line in (tmp_path / "participants.tsv").read_text().splitlines())
    row = dict(zip(names, values, strict=True))
    assert names[-5:] == [
        "prosthetic_side",
        "left_amputation_level",
        "left_prosthetic_knee",
        "right_amputation_level",
        "right_prosthetic_foot",
    ]
    assert (row["left_prosthetic_knee"], row["right_prosthetic_foot"]) == ("polycentric", "energy_storing")
    assert set(names) - {"participant_id"} == set(json.loads((tmp_path / "participants.json").read_text()))


def test_a_prosthesis_is_a_device_of_the_patient(stated: Visit, tmp_path: Path) -> None:
    write_bundle(*stated, tmp_path / "bundle.json")
    read = Bundle.model_validate_json((tmp_path / "bundle.json").read_bytes())
    resources: list[Any] = [entry.resource for entry in read.entry or ()]
    devices = [one for one in resources if one.get_resource_type() == "Device" and one.patient is not None]
    assert [one.type.text for one in devices] == [
        "Transfemoral prosthesis left, polycentric knee",
        "Transtibial prosthesis right, energy-storing foot",
    ]
    assert {one.patient.reference for one in devices} == {(read.entry or [])[0].fullUrl}
    urls = [entry.fullUrl for entry in read.entry or ()]
    assert len(set(urls)) == len(urls)


def test_the_workbook_and_what_is_shown_before_it_leaves_name_it(stated: Visit, tmp_path: Path) -> None:
    write_spreadsheet(*stated, tmp_path / "some.xlsx")
    rows: Any = openpyxl.load_workbook(tmp_path / "some.xlsx")["About"].iter_rows(values_only=True)
    about = {row[0]: row[1] for row in rows}
    assert about["prosthesis, left"] == "transfemoral prosthesis, polycentric knee"
    assert dict(what_leaves(stated[0]))["prosthesis, right"] == "transtibial prosthesis, energy-storing foot"


@pytest.mark.parametrize(
    "prostheses",
    [{}, {Side.LEFT: NOT_STATED}],
)
def test_nothing_stated_leaves_every_file_as_it_was(
    visit: Visit, tmp_path: Path, prostheses: dict[Side, Prosthesis]
) -> None:
    session = replace(visit[0], patient=replace(SIDES, prostheses=prostheses))
    analysis = analysis_of(session)
    assert "prostheses" not in summarise(analysis)
    kinds = [entry["resource"]["resourceType"] for entry in bundle(session, analysis)["entry"]]
    assert kinds.count("Device") == 1  # Gaitwright
    write_bids(session, analysis, tmp_path)
    assert (tmp_path / "participants.tsv").read_text().splitlines()[0].endswith("prosthetic_side")
    assert not [name for name, _ in what_leaves(session) if name.startswith("prosthesis")]
