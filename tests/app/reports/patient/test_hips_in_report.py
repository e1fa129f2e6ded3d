"""The hips and the pelvis in the report: what is printed of them, what never is, and in how many pages."""

import io
import math
from dataclasses import replace
from typing import Any

import pypdf
import pytest
from syrupy.assertion import SnapshotAssertion

from app.reports.blocks import Block
from app.reports.patient.curves_page import curves_page
from app.reports.patient.document import make_report
from app.reports.patient.evidence import clocks_in_words, hips_table
from app.reports.patient.first_page import first_page
from app.reports.patient.peaks_table import peaks_table
from app.reports.patient.pelvis_table import pelvis_table
from app.summary.data_quality import data_quality, one_time_in_words
from app.summary.facts import Facts
from app.summary.headline import headline_of
from app.summary.quality import caveats
from app.summary.request import ReportRequest
from app.wording.translation import use_language
from core.body import Joint, JointKind, Side
from core.gait.clocks import ClockTie
from core.hip.results import ClockStatus, LegClock
from core.results import Analysis, RecordingAnalysis
from tests.app.changed_analysis import walk_of
from tests.app.hip_visits import hip_analysis, hip_request
from tests.core.hip.hip_sessions import rewalked, with_hip

BOTH = (Joint.LEFT_HIP, Joint.RIGHT_HIP)


def stated(blocks: object) -> str:
    """Every word of some blocks."""
    if isinstance(blocks, str):
        return blocks
    if isinstance(blocks, dict):
        return " ".join(stated(one) for one in blocks.values())
    return " ".join(stated(one) for one in blocks) if isinstance(blocks, list | tuple) else ""


def rows(blocks: list[Block]) -> dict[str, list[str]]:
    """The rows of their tables by their first cell."""
    found = {}
    for block in blocks:
        table = block.get("rows") if block["kind"] == "table" else None
        for row in table if isinstance(table, list) else []:
            if "cells" in row:
                name, *cells = (cell["said"] for cell in row["cells"])
                found[name] = cells
    return found


def of(hips: Facts, analysis: Analysis) -> Facts:
    """The same visit with another analysis."""
    return Facts(replace(hips.visit, analysis=analysis), walk_of(analysis))


def with_joints(hips: Facts, *joints: Joint, **change: Any) -> Facts:
    return of(hips, with_hip(hips.visit.analysis, *joints, **change))


def with_clock(
    hips: Facts, offset_s: float, sd_s: float, status: ClockStatus, tie: ClockTie = ClockTie.PELVIS
) -> Facts:
    def changed(walk: RecordingAnalysis) -> RecordingAnalysis:
        assert walk.clocks is not None
        return replace(walk, clocks=replace(walk.clocks, tie=tie), leg_clock=LegClock(offset_s, sd_s, status))

    return of(hips, rewalked(hips.visit.analysis, changed))


@pytest.mark.endurance
def test_six_joints_are_counted_and_the_late_clock_is_reported(hips: Facts) -> None:
    found = data_quality(hips)
    assert found.first == "All six joints are reported."
    assert (
        "left and right sensors synchronised from hip movement: the right leg was 40 ms late, ± 5 ms" in found.in_order
    )
    assert found.lines == ()


def test_what_of_a_hip_is_not_reported_is_stated_once_with_what_to_do(hips: Facts, snapshot: SnapshotAssertion) -> None:
    """Its abduction goes with it; abduction alone leaves the joints to be read."""
    gated = data_quality(with_joints(hips, Joint.LEFT_HIP, margin=1.2, is_3d=False))
    abduction = with_joints(hips, *BOTH, heading_sd_rad=math.radians(7.0), is_3d=False)
    assert {
        "a hip": [gated.first, *((line.where, line.verdict.value) for line in gated.lines)],
        "abduction": [data_quality(abduction).first, *caveats(abduction)],
    } == snapshot


def test_how_the_legs_have_one_time_is_stated(hips: Facts, snapshot: SnapshotAssertion) -> None:
    """In the line of data quality, and on page four."""
    cases = {
        "right late": (0.04, 0.005, ClockStatus.FOUND),
        "left late": (-0.04, 0.002, ClockStatus.FOUND),
        "right late by less than its error": (0.004, 0.005, ClockStatus.FOUND),
        "left late by less than its error": (-0.004, 0.005, ClockStatus.FOUND),
        "confirmed": (0.001, 0.005, ClockStatus.PROVEN),
        "not found": (math.nan, math.nan, ClockStatus.NOT_REPORTED),
    }
    found = {name: with_clock(hips, *case) for name, case in cases.items()}
    tied = {name: found[name] for name in ("right late", "left late", "right late by less than its error")}
    tied["one clock"] = with_clock(hips, 0.001, 0.005, ClockStatus.PROVEN, ClockTie.ONE_CLOCK)
    assert {name: one_time_in_words(one.walk) for name, one in tied.items()} == snapshot
    assert {name: clocks_in_words(one) for name, one in found.items()} == snapshot


def test_the_gates_of_a_hip_stand_with_their_limits_and_what_failed_is_not_reported(
    hips: Facts, snapshot: SnapshotAssertion
) -> None:
    assert rows(hips_table(with_joints(hips, Joint.LEFT_HIP, margin=1.21))) == snapshot


def test_no_difference_of_hips_is_judged_and_rotation_is_named_as_unreadable(hips: Facts) -> None:
    table = rows(peaks_table(hips))
    left, right, difference, likely, *_ = table["Abduction range of motion"]
    assert left.endswith(tuple("0123456789"))
    assert right != left
    assert (difference[0] in "+−", likely) == (True, "–")
    assert (
        "For hips and pelvis the measurement error of a difference is not known: differences are given but not judged"
    ) in stated(peaks_table(hips))


def test_no_sentence_shows_how_hips_or_pelvis_differ_however_much(hips: Facts) -> None:
    def stiffened(walk: RecordingAnalysis) -> RecordingAnalysis:
        left = walk.gait[Side.LEFT]
        halved = {
            name: 0.4 * values if name.startswith(("hip", "pelvis")) else values
            for name, values in left.parameters.items()
        }
        return replace(walk, gait={**walk.gait, Side.LEFT: replace(left, parameters=halved)})

    facts = of(hips, rewalked(hips.visit.analysis, stiffened))
    assert rows(peaks_table(facts))["Abduction range of motion"][3] == "–"
    words = f"{headline_of(facts).first} {headline_of(facts).then}".casefold()
    assert words
    assert not [word for word in ("hip", "pelvis") if word in words]


def test_the_pelvis_has_its_table_and_the_tilt_its_reason(hips: Facts) -> None:
    blocks = pelvis_table(hips)
    table = rows(blocks)
    assert set(table) == {"Obliquity, range", "Drop in swing", "Rotation, range", "Mean tilt, forward +", "Tilt, range"}
    assert table["Tilt, range"] == ["not reported", "not reported"]
    assert "A range up to 5.0° cannot be distinguished from measurement error" in stated(blocks)
    assert "1 turn." in stated(blocks)


def test_without_a_pelvis_nothing_of_it_is_printed(demo: ReportRequest) -> None:
    visit = demo.visit
    facts = Facts(visit, walk_of(visit.analysis))
    assert hips_table(facts) == pelvis_table(facts) == []
    assert "hip" not in stated(peaks_table(facts)).casefold()
    assert "hip" not in stated(first_page(demo, facts, None)).casefold()


def test_hips_are_a_row_on_page_one_and_curves_on_page_two_and_a_not_reported_one_states_why(
    hips: Facts,
) -> None:
    table = first_page(hip_request(hips.visit.analysis), hips, None)["table"]
    assert isinstance(table, dict)
    assert [row["name"] for row in table["rows"]].count("Hip range of motion") == 1
    gated = with_joints(hips, Joint.LEFT_HIP, margin=1.2)
    page = first_page(hip_request(gated.visit.analysis), gated, None)
    assert "not reported" in stated(page["caution"])
    (figures,) = (block for block in curves_page(hips) if block["kind"] == "figures")
    pictures = figures["pictures"]
    assert isinstance(pictures, list)
    assert len(pictures) == 3


def test_page_two_has_no_band_at_the_hip(hips: Facts) -> None:
    blocks = curves_page(hips)
    assert "At the hip, the reference has another zero and is not shown." in stated(blocks)
    assert hips.has_joint(JointKind.HIP)


@pytest.mark.endurance
@pytest.mark.parametrize("language", ["en", "de"])
def test_a_report_with_hips_has_four_pages(language: str) -> None:
    gated = with_hip(hip_analysis(), Joint.LEFT_HIP, margin=1.2, is_3d=False)
    use_language(language)
    try:
        for analysis in (hip_analysis(), gated, with_hip(hip_analysis(), *BOTH, margin=1.2)):
            pages = pypdf.PdfReader(io.BytesIO(make_report(hip_request(analysis)))).pages
            assert len(pages) == 4
    finally:
        use_language("en")
