"""The site names the programs that opened our files: each by a test, with the version that it was run with."""

import importlib
import re
from pathlib import Path

import pytest

from tests.other_programs import version_in_node, version_in_python

SITE = Path(__file__).parents[3] / "packaging" / "site" / "pages"
TITLES = {
    "en/validation.md": "## Programs that opened the files",
    "de/validation.md": "## Programme, die die Dateien geöffnet haben",
}
ROW = re.compile(r"\| `?(?P<file>[^|`]+)`? \| (?P<program>\S+) (?P<version>[\d.]+) \| (?P<what>[^|]+) \|")
NPM, OFFICE = "npm:", "soffice"
# file and program -> the test that opens it, and the package whose version it is
PROGRAMS = {
    ("angles.mot", "OpenSim"): (
        "opensim",
        "test_opensim.test_opensim_reads_every_row",
        "test_opensim.test_a_model_moves_as_the_patient_did_and_within_its_limits",
    ),
    ("orientations.sto", "OpenSim"): (
        "opensim",
        "test_opensim.test_opensim_reads_our_orientations_and_we_read_its_own",
        "test_opensim.test_opensense_moves_its_model_as_the_patient_moved",
    ),
    ("angles.c3d", "ezc3d"): ("ezc3d", "test_c3d_readers.test_ezc3d_reads_angles_units_and_events"),
    ("angles.c3d", "c3d"): (
        "c3d",
        "test_c3d_readers.test_c3d_reads_angles_units_and_events",
        "test_c3d_readers.test_more_frames_than_a_signed_number_holds_are_counted_by_all",
    ),
    ("angles.c3d", "kineticstoolkit"): (
        "kineticstoolkit",
        "test_c3d_readers.test_kineticstoolkit_reads_angles_units_and_events",
    ),
    ("angles.c3d", "pyomeca"): ("pyomeca", "test_c3d_readers.test_pyomeca_reads_angles_and_units"),
    ("fhir_bundle.json", "fhir-resources"): (
        "fhir-resources",
        "test_fhir_transaction.test_fhir_resources_takes_the_transaction",
        "test_formats.test_another_library_takes_the_bundle",
    ),
    ("fhir_bundle.json", "fhir"): (f"{NPM}fhir", "test_fhir_transaction.test_fhir_of_npm_finds_no_error"),
    ("results.xlsx", "openpyxl"): (
        "openpyxl",
        "test_formats.test_a_sheet_holds_the_cells_of_its_csv_file",
        "test_contents.test_the_workbook_has_what_legs_and_conditions_differ_by_as_the_files_do",
        "test_workbook.test_a_column_of_numbers_holds_nothing_else",
    ),
    ("results.xlsx", "python-calamine"): (
        "python-calamine",
        "test_workbook.test_calamine_reads_the_numbers_of_every_csv_file",
    ),
    ("results.xlsx", "LibreOffice"): (
        OFFICE,
        "test_workbook.test_libreoffice_opens_it_as_it_is_meant",
        "test_workbook.test_libreoffice_prints_it_on_pages_that_name_the_patient",
    ),
    ("bids", "bids-validator-deno"): (
        "bids-validator-deno",
        "test_bids_motion.test_the_validator_of_bids_finds_no_error",
        "test_bids_motion.test_every_recording_of_a_visit_comes_back_to_the_last_digit",
        "test_round_trips.test_what_comes_back_has_the_same_figures_events_and_marks",
    ),
}


def version_of(package: str) -> str:
    if package == OFFICE:
        return ""  # what the system brings; each has another
    name = package.removeprefix(NPM)
    return version_in_python(name)[0] if name == package else version_in_node(name)


def rows(page: str) -> list[re.Match[str]]:
    _, table = (SITE / page).read_text(encoding="utf-8").split(TITLES[page])
    lines = [line for line in table.split("\n## ")[0].splitlines() if line.startswith("| ")][1:]
    found = [ROW.fullmatch(line) for line in lines]
    assert all(found), lines
    return [one for one in found if one]


@pytest.mark.parametrize("page", TITLES)
def test_every_program_that_the_site_names_has_its_tests(page: str) -> None:
    named = [(one["file"], one["program"]) for one in rows(page)]
    assert named == list(PROGRAMS)
    for _, *tests in PROGRAMS.values():
        for test in tests:
            module, name = test.split(".")
            assert callable(getattr(importlib.import_module(f"tests.app.exports.{module}"), name))


@pytest.mark.endurance  # with the locked versions, and those of programs beside them
@pytest.mark.parametrize("page", TITLES)
def test_the_versions_are_those_that_the_tests_run_with(page: str) -> None:
    for one in rows(page):
        package, *_ = PROGRAMS[one["file"], one["program"]]
        found = version_of(package)
        assert found in ("", one["version"]), one["program"]  # without it its tests are skipped too, and state so
