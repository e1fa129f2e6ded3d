"""Tests that every number on paper is in a file of the results, too.

Reported from the files alone, as a reader of them would.
"""

import json
import math
import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from statistics import fmean, median, stdev
from typing import Any

import numpy as np
import pytest

from app.charts import joint_on_paper, on_paper
from app.charts.drawing import Picture
from app.charts.stride_chart import StrideChart
from app.exports.result_folder import write_results
from app.reports.patient import comparison_page, curves_page, first_page, time_page
from app.reports.patient.document import report_data
from app.summary.numbers_in_words import NOTHING, against_band, fixed, signed, spread
from app.summary.reference_bands import reference_curves, time_distance_classes
from app.summary.request import AnalysedVisit, ReportRequest
from app.wording.numbers import MINUS
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from tests.app.exports.written_tables import csv_rows

DIGITS = 1e-5
# 1.96 sqrt(2) times 1.0 deg, hypot(1.2, 2.58), 3.3, 0.55 and 1.1 points; healthy ankles; and "over 100"
ERRORS = (2.772, 7.887, 9.147, 1.524, 3.049, 6.2, 100.0)
NUMBER = re.compile(rf"[{MINUS}]?\d+(?:\.\d+)?")


@pytest.fixture(scope="module")
def results(demonstration: AnalysedVisit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("results")
    write_results(demonstration.session, demonstration.analysis, folder)
    return folder


def of_used(path: Path, side: Side) -> list[dict[str, str]]:
    """Give the rows of strides.csv or peaks.csv that count for a side."""
    return [row for row in csv_rows(path) if row["side"] == side and row["used"] == "true"]


def column(rows: list[dict[str, str]], name: str) -> list[float]:
    return [float(row[name]) for row in rows if re.fullmatch(r"-?[\d.]+", row[name])]


def known(results: Path, walk: str = "walk_1") -> set[str]:
    """Give every number that the files hold or a band has, as it may be written."""
    values: list[float] = []
    for side in Side:
        strides = of_used(results / walk / "strides.csv", side)
        peaks = [row for row in of_used(results / "peaks.csv", side) if row["recording"] == walk]
        values.append(len(strides))
        for rows in (strides, peaks):
            for name in rows[0] if rows else ():
                numbers = column(rows, name)
                if len(numbers) > 1:
                    values += [fmean(numbers), stdev(numbers), 100 * stdev(numbers) / fmean(numbers)]
        values += in_parts(strides)
    cycles = csv_rows(results / walk / "cycles.csv")
    values += [fmean(float(row[name]) for row in cycles) for name in cycles[0] if name.endswith("_sd_deg")]
    if (results / "differences.csv").exists():
        differences = csv_rows(results / "differences.csv")
        names = ("mean", "sd", "against_mean", "against_sd", "difference", "error", "low", "high", "healthy_limit")
        values += [number for name in names for number in column(differences, name)]
    for line in csv_rows(results / "sides.csv") if (results / "sides.csv").exists() else []:
        values += [float(line[name]) for name in ("difference", "error", "low", "high", "healthy_limit") if line[name]]
    summary = json.loads((results / "summary.json").read_text())
    values += [*numbers_in(summary["walks"]), *numbers_in(summary["joints"]), *ERRORS]
    values += [v for value in time_distance_classes()[1].values.values() for v in (value.mean, value.sd)]
    step, stance = (time_distance_classes()[1].values[name] for name in ("step_length", "stance"))
    values += [2 * step.mean, 2 * step.sd, 100 - stance.mean]
    curves = reference_curves()
    for curve in (curves.knee_mean_deg, curves.knee_sd_deg, curves.ankle_mean_deg, curves.ankle_sd_deg):
        values += [*map(float, curve), float(curve.max() - curve.min())]
    return {fixed(sign * value, decimals) for value in values for decimals in (0, 1, 2) for sign in (1, -1)}


def in_parts(strides: list[dict[str, str]]) -> list[float]:
    """What the pages report of a leg's strides that is in no file as it is: phases, lift in cm, halves and thirds."""
    values = [100 * number for name in ("clearance_m",) for number in both(column(strides, name))]
    phases = [
        [
            100 * (float(row[name]) - float(row["start_s"])) / (float(row["end_s"]) - float(row["start_s"]))
            for row in reported
        ]
        for name in ("full_contact_s", "heel_rise_s", "toe_off_s")
        if (reported := [row for row in strides if row[name]])
    ]
    if len(phases) == 3:
        flat, rise, off = map(fmean, phases)
        values += [flat, rise - flat, off - rise]
    for name in ("knee_range_deg", "ankle_range_deg"):
        ranges = column(strides, name)
        if len(ranges) >= 6:
            half, third = len(ranges) // 2, len(ranges) // 3
            values += [median(ranges), fmean(ranges[-half:]) - fmean(ranges[:half])]
            values.append(fmean(ranges[-third:]) - fmean(ranges[:third]))
    return values


def both(numbers: list[float]) -> list[float]:
    return [fmean(numbers), stdev(numbers)] if len(numbers) > 1 else []


def numbers_in(part: Any) -> list[float]:
    if isinstance(part, dict):
        return [number for inner in part.values() for number in numbers_in(inner)]
    return [float(part)] if isinstance(part, float | int) and not isinstance(part, bool) else []


def tables(data: dict[str, Any]) -> Iterable[dict[str, Any]]:
    for blocks in data["pages"]:
        yield from (block for block in blocks if block["kind"] == "table")


def numbers_of(data: dict[str, Any]) -> list[tuple[str, str]]:
    """Give every number in a column of numbers, with the name of its row."""
    numbers = []
    for row in data["first_page"]["table"]["rows"]:
        cells = (*row["values"], row["difference"], row["between"], row["reference"], row["since"])
        numbers += [(row["name"], number) for cell in cells for number in NUMBER.findall(cell.replace("+", ""))]
    for one in tables(data):
        for row in one["rows"]:
            place = 0
            for k, cell in enumerate(row.get("cells", ())):
                is_words = k == 0 or not one["columns"][place]["is_number"]
                place += cell["span"]
                numbers += [] if is_words else [(row["cells"][0]["said"], n) for n in NUMBER.findall(cell["said"])]
    return numbers


def test_every_number_in_a_table_is_in_a_file(demo: ReportRequest, results: Path) -> None:
    numbers, files = numbers_of(report_data(demo)), known(results)
    assert len(numbers) > 95
    assert [(where, number) for where, number in numbers if number not in files] == []


def test_every_number_of_one_leg_alone_is_in_a_file(request_of_one_leg: ReportRequest, tmp_path: Path) -> None:
    visit = request_of_one_leg.visit
    write_results(visit.session, visit.analysis, tmp_path)
    numbers, files = numbers_of(report_data(request_of_one_leg)), known(tmp_path)
    assert len(numbers) > 50
    assert [(where, number) for where, number in numbers if number not in files] == []
    peaks = of_used(tmp_path / "peaks.csv", Side.LEFT)
    assert fixed(fmean(column(peaks, "knee_swing_peak_percent")), 1) in {n for _, n in numbers}


@pytest.mark.endurance
def test_every_curve_is_in_a_file(demo: ReportRequest, results: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Means are of cycles.csv, single strides of angles.csv between the times of strides.csv."""
    charts = drawn(demo, monkeypatch)
    cycles, angles = csv_rows(results / "walk_1" / "cycles.csv"), csv_rows(results / "walk_1" / "angles.csv")
    assert len(charts) == 2 * len(first_page.CHART_HEIGHTS) + 2 + 4
    for chart in charts:
        kind = "knee" if "nee" in chart.title else "ankle"
        for line in chart.curves:
            strides = of_used(results / "walk_1" / "strides.csv", line.side)
            joint = f"{line.side}_{kind}"
            np.testing.assert_allclose(line.angle_deg, column(cycles, f"{joint}_mean_deg"), atol=DIGITS)
            assert line.toe_off_percent == pytest.approx(fmean(column(strides, "stance_percent")), abs=DIGITS)
            time_s, angle_deg = column(angles, "time_s"), column(angles, f"{joint}_deg")
            for stride_deg, row in zip(line.strides_deg, strides, strict=False):
                at_s = np.linspace(float(row["start_s"]), float(row["end_s"]), 101)
                np.testing.assert_allclose(stride_deg, np.interp(at_s, time_s, angle_deg), atol=0.2)


def drawn(request: ReportRequest, monkeypatch: pytest.MonkeyPatch) -> list[StrideChart]:
    """Give every panel of curves, as it was handed to be drawn."""
    charts: list[StrideChart] = []

    def draw(chart: StrideChart, plot_width: float) -> Picture:
        charts.append(chart)
        return on_paper.draw(chart, plot_width)

    def draw_page_one(chart: StrideChart, width: float, height: float) -> Picture:
        charts.append(chart)
        return joint_on_paper.draw_joint(chart, width, height)

    monkeypatch.setattr(first_page, "draw_joint", draw_page_one)
    for page in (curves_page, time_page, comparison_page):
        monkeypatch.setattr(page, "draw", draw)
    report_data(request)
    return charts


@pytest.mark.endurance
def test_every_number_and_curve_of_a_comparison_is_in_a_file(
    aligned: ReportRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    visit = aligned.visit
    write_results(visit.session, visit.analysis, tmp_path)
    numbers, files = numbers_of(report_data(aligned)), known(tmp_path, "walk_3")
    assert len(numbers) > 200
    assert [(where, number) for where, number in numbers if number not in files] == []
    cycles = csv_rows(tmp_path / "compared_cycles.csv")
    compared = [chart for chart in drawn(aligned, monkeypatch) if len(chart.curves) == 3]
    assert len(compared) == 4
    for chart in compared:
        kind = "knee" if "nee" in chart.title else "ankle"
        for line in chart.curves:
            expected = column(cycles, f"{line.letter}_{line.side}_{kind}_mean_deg")
            np.testing.assert_allclose(line.angle_deg, expected, atol=DIGITS)


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
        10.0: "within 1 SD",
        12.0: "within 1 SD",
        13.9: "1–2 SD above",
        5.0: "more than 2 SD below",
        7.9: "1–2 SD below",
    }


def test_no_word_of_the_report_judges(aligned: ReportRequest) -> None:
    stated = json.dumps(report_data(replace(aligned, comment="")), ensure_ascii=False).lower()
    for word in ("better", "worse", "improve", "normal", "significant", "abnormal", "patholog"):
        assert not re.search(rf"\b{word}", stated), word
