"""The prosthetist's page: what was set and measured, whether the return returned, and the same figures in the files."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from syrupy.assertion import SnapshotAssertion

from app.exports.result_folder import write_results
from app.reports.patient.document import facts_of, report_data
from app.reports.patient.fitting_page import fitting_page
from app.summary.prosthesis_fitting import SET_ANGLES, ProsthesisFitting, fitting_of
from app.summary.request import AnalysedVisit, ReportRequest
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Side
from core.session import Patient, Recording, RecordingKind
from devices.simulation.walker import (
    PEOPLE,
    FreeMotion,
    ProsthesisSetting,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
)
from tests.app.exports.written_tables import csv_rows
from tests.app.reports.patient.conftest import MADE_AT
from tests.simulated import analysis_of, session_of

OF_B = AlignmentChange("Alignment A", (PartChange(ProsthesisPart.FOOT_FRONT_SCREW, angle_deg=4.0, shift_mm=6.0),))


def walked(*settings: ProsthesisSetting, changes: dict[str, AlignmentChange], letters: str) -> AnalysedVisit:
    walks = [Walk(f"walk {k}", strides=16, prosthesis=one) for k, one in enumerate(settings, 1)]
    made = session_of(
        WalkerSettings(
            seed=61,
            tissue=Tissue.SOFT,
            prosthetic_side=Side.LEFT,
            variation=PEOPLE,
            recordings=(Standing(), FreeMotion(), *walks),
        )
    )
    labels = iter(letters)

    def named(one: Recording) -> Recording:
        if one.kind is not RecordingKind.WALKING:
            return one
        condition = f"Alignment {next(labels)}"
        return replace(one, condition=condition, alignment=changes.get(condition))

    session = replace(made, recordings=tuple(map(named, made.recordings)))
    return AnalysedVisit(session, analysis_of(session))


@pytest.fixture(scope="module")
def there_and_back() -> AnalysedVisit:
    built, plantar = ProsthesisSetting(), ProsthesisSetting(plantar_deg=4.0)
    return walked(built, plantar, built, changes={"Alignment B": OF_B}, letters="ABA")


@pytest.fixture(scope="module")
def not_put_back() -> AnalysedVisit:
    """The foot was to be put back before the third walk, and was not."""
    built, plantar = ProsthesisSetting(), ProsthesisSetting(plantar_deg=4.0)
    return walked(built, plantar, plantar, changes={"Alignment B": OF_B}, letters="ABA")


def request_of(visit: AnalysedVisit) -> ReportRequest:
    return ReportRequest(visit, ("walk 1",), MADE_AT, "1.2.3")


def fitting(visit: AnalysedVisit) -> ProsthesisFitting:
    found = fitting_of(visit.session, visit.analysis)
    assert found is not None
    return found


def page_of(visit: AnalysedVisit) -> list[dict[str, Any]]:
    page: list[dict[str, Any]] = fitting_page(fitting(visit), facts_of(request_of(visit)))
    return page


def cells(block: dict[str, Any]) -> list[list[str]]:
    return [[cell["said"] for cell in row["cells"]] for row in block["rows"] if "cells" in row]


def stated(visit: AnalysedVisit) -> list[str]:
    """The sentence that opens the page, and the rows of its alignments, without marks of direction."""
    opening, alignments = page_of(visit)[1:3]
    lines = [opening["said"], *(" | ".join(row) for row in cells(alignments))]
    return [line.replace("\u2068", "").replace("\u2069", "") for line in lines]


def test_the_page_has_each_alignment_in_order_with_what_was_set_and_measured(
    there_and_back: AnalysedVisit, snapshot: SnapshotAssertion
) -> None:
    assert stated(there_and_back) == snapshot


def test_a_foot_that_was_not_put_back_is_named(not_put_back: AnalysedVisit, snapshot: SnapshotAssertion) -> None:
    assert stated(not_put_back) == snapshot


def test_the_files_have_the_figures_of_the_page(there_and_back: AnalysedVisit, tmp_path: Path) -> None:
    write_results(there_and_back.session, there_and_back.analysis, tmp_path)
    page = page_of(there_and_back)
    rows = csv_rows(tmp_path / SET_ANGLES)
    assert [(row["condition"], row["since"]) for row in rows] == [
        ("Alignment B", "Alignment A"),
        ("Alignment A", "Alignment A"),
    ]
    assert (rows[0]["agrees"], rows[0]["other_changes"], rows[1]["other_changes"]) == ("yes", "yes", "no")
    stated = cells(page[2])[1][3]
    assert f"measured {float(rows[0]['measured_deg']):.1f}° (±{float(rows[0]['error_deg']):.1f}°)" in stated
    of_b = [row for row in csv_rows(tmp_path / "differences.csv") if row["part"] == "B"]
    differences = {(row["name"], row["side"], row["parameter"]): row for row in of_b}
    printed = next(row for row in cells(page[3]) if row[0].startswith("Foot angle at contact"))
    kept = differences["Alignment B", "left", "foot_pitch_at_contact_deg"]
    assert printed[2] == f"○ −{abs(float(kept['difference'])):.1f}\u00a0±\u00a0{float(kept['error']):.1f}"


def test_the_report_has_the_page_and_states_the_changes_once(there_and_back: AnalysedVisit) -> None:
    pages = report_data(request_of(there_and_back))["pages"]
    headings = [page[0].get("said") for page in pages]
    assert headings.count("Prosthesis fitting") == 1
    both = replace(request_of(there_and_back), walks=("walk 1", "walk 2"))
    texts = str(report_data(both)["pages"])
    assert texts.count("Changes to the prosthesis") == 1


@pytest.mark.parametrize("patient", [Patient(), Patient(prosthetic_side="both")])
def test_without_one_prosthetic_leg_there_is_no_such_page(there_and_back: AnalysedVisit, patient: Patient) -> None:
    session = replace(there_and_back.session, patient=patient)
    assert fitting_of(session, there_and_back.analysis) is None


def test_without_a_change_there_is_no_such_page(there_and_back: AnalysedVisit) -> None:
    same = tuple(replace(one, alignment=None) for one in there_and_back.session.recordings)
    assert fitting_of(replace(there_and_back.session, recordings=same), there_and_back.analysis) is None
