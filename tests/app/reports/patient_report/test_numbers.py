"""Is every number on paper in a file of the results, too? Told from the files alone, as a reader of them would."""

import csv
import json
import math
import re
from collections.abc import Iterable
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

import pytest

from app.reports.patient_report.document import report_data
from app.reports.patient_report.numbers_in_words import MINUS, NOTHING, against_band, fixed, signed, spread
from app.reports.patient_report.request import ReportRequest, Visit, default_walks
from app.reports.reference_bands import reference_curves, time_distance_classes
from app.reports.result_folder import write_results
from core.gait.spatiotemporal import MeanAndSd

NUMBER = re.compile(rf"[{MINUS}]?\d+(?:\.\d+)?")


@pytest.fixture(scope="module")
def results(demonstration: Visit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("results")
    write_results(demonstration.session, demonstration.analysis, folder, has_log=False)
    return folder


def known(results: Path) -> set[str]:
    """Give every number that the files hold or a band has, as it may be written."""
    values: list[float] = []
    with (results / "walk_1" / "strides.csv").open(newline="") as file:
        strides = list(csv.DictReader(file))
    for side in ("left", "right"):
        used = [row for row in strides if row["side"] == side and row["used"] == "true"]
        values.append(len(used))
        for column in strides[0]:
            numbers = [float(row[column]) for row in used if re.fullmatch(r"-?[\d.]+", row[column])]
            if len(numbers) > 1:
                values += [fmean(numbers), stdev(numbers), 100 * stdev(numbers) / fmean(numbers)]
    with (results / "walk_1" / "cycles.csv").open(newline="") as file:
        cycles = list(csv.DictReader(file))
    values += [fmean(float(row[name]) for row in cycles) for name in cycles[0] if name.endswith("_sd_deg")]
    values += numbers_in(json.loads((results / "summary.json").read_text())["walks"])
    values += [v for value in time_distance_classes()[1].values.values() for v in (value.mean, value.sd)]
    step, stance = (time_distance_classes()[1].values[name] for name in ("step_length", "stance"))
    values += [2 * step.mean, 2 * step.sd, 100 - stance.mean]
    curves = reference_curves()
    for curve in (curves.knee_mean_deg, curves.knee_sd_deg, curves.ankle_mean_deg, curves.ankle_sd_deg):
        values += [*map(float, curve), float(curve.max() - curve.min())]
    return {fixed(sign * value, decimals) for value in values for decimals in (0, 1, 2) for sign in (1, -1)}


def numbers_in(part: Any) -> list[float]:
    if isinstance(part, dict):
        return [number for inner in part.values() for number in numbers_in(inner)]
    return [float(part)] if isinstance(part, float | int) and not isinstance(part, bool) else []


def tables(data: dict[str, Any]) -> Iterable[dict[str, Any]]:
    for blocks in (data["first_page"], *data["pages"]):
        yield from (block for block in blocks if block["kind"] == "table")


def test_every_number_in_a_table_is_in_a_file(demonstration: Visit, results: Path) -> None:
    """But for when in the stride a peak comes, of which the files hold the knee's in swing alone."""
    made_at = datetime.fromisoformat("2026-11-21T22:15:30+01:00")
    data = report_data(ReportRequest(demonstration, default_walks(demonstration), made_at, "1.2.3"))
    numbers, files = [], known(results)
    for table in tables(data):
        titles = [column["title"] for column in table["columns"]]
        for row in table["rows"]:
            if "cells" not in row:
                continue
            place = 0
            for k, cell in enumerate(row["cells"]):
                is_words = k == 0 or not table["columns"][place]["is_number"] or titles[place] == "at %"
                place += cell["span"]
                numbers += [] if is_words else [(row["cells"][0]["said"], n) for n in NUMBER.findall(cell["said"])]
    assert len(numbers) > 80
    assert [(where, number) for where, number in numbers if number not in files] == []


def test_the_key_numbers_are_those_of_the_files(request_of_demonstration: ReportRequest, results: Path) -> None:
    files = known(results)
    keys = report_data(request_of_demonstration)["key_numbers"]
    shown = [number for key in keys for _, value in key["values"] for number in NUMBER.findall(value)]
    assert len(shown) == 6
    assert set(shown) <= files


def test_differences_are_formed_before_rounding_and_never_minus_zero() -> None:
    assert fixed(-0.04, 1) == "0.0"
    assert signed(-0.04, 1) == "0.0"
    assert signed(0.04, 1) == "0.0"
    assert signed(-7.25, 1) == f"{MINUS}7.2"
    assert signed(7.3, 1) == "+7.3"
    assert fixed(math.nan, 1) == fixed(None, 2) == signed(math.nan, 1) == NOTHING


def test_a_spread_needs_ten_strides_and_a_mean_three() -> None:
    assert spread(MeanAndSd(12.34, 1.26, 10), 1) == "12.3 ± 1.3"
    assert spread(MeanAndSd(12.34, 1.26, 9), 1) == "12.3"
    assert spread(MeanAndSd(12.34, 1.26, 2), 1) == NOTHING


def test_words_against_a_band_state_the_size_of_a_distance_only() -> None:
    band = (8.0, 12.0)
    words = {value: against_band(value, band).replace("\u00a0", " ") for value in (10.0, 12.0, 13.9, 5.0, 7.9)}
    assert words == {
        10.0: "inside 1 SD",
        12.0: "inside 1 SD",
        13.9: "1–2 SD above",
        5.0: "more than 2 SD below",
        7.9: "1–2 SD below",
    }


def test_no_word_of_the_report_judges(request_of_alignments: ReportRequest) -> None:
    said = json.dumps(report_data(replace(request_of_alignments, comment="")), ensure_ascii=False).lower()
    for word in ("better", "worse", "improve", "normal", "significant", "abnormal", "patholog"):
        assert not re.search(rf"\b{word}", said), word
