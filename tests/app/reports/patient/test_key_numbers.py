"""Tests of the rows of key numbers.

What the findings report comes first, then the same rows for everybody. The unknown is never shown.
"""

from dataclasses import replace

import pytest

from app.charts.drawing import COLOURS, MM
from app.reports.patient.key_numbers import ALWAYS, MOST_ROWS, key_numbers, key_rows
from app.reports.patient.key_strips import STRIP_WIDTH, strip
from app.summary.facts import Facts
from app.summary.request import AnalysedVisit, ReportRequest
from app.theme.colours import PAPER
from core.body import Joint, Side
from core.results import Analysis
from tests.app.changed_analysis import recalibrated, walk_of
from tests.app.reports.patient.test_what_stands_out import with_more


def facts(request: ReportRequest, analysis: Analysis | None = None) -> Facts:
    found = analysis or request.visit.analysis
    return Facts(AnalysedVisit(request.visit.session, found), walk_of(found))


def columns(shown: Facts) -> list[str]:
    return [row.column for row in key_rows(shown, None)]


def cells(shown: Facts, row: int) -> list[str]:
    (table,) = (block for block in key_numbers(shown, None) if block["kind"] == "table")
    rows = table["rows"]
    assert isinstance(rows, list)
    return [cell["said"] for cell in rows[row]["cells"]]


def test_without_a_finding_the_same_measures_stand_for_everybody(request_of_demonstration: ReportRequest) -> None:
    assert columns(facts(request_of_demonstration)) == list(ALWAYS)


@pytest.mark.parametrize("name", ["knee_while_loading", "knee_straightening"])
def test_the_measure_of_a_finding_is_first(request_of_demonstration: ReportRequest, name: str) -> None:
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, f"{name}_rad", -20.0)
    found = columns(facts(request_of_demonstration, analysis))
    assert found == [f"{name}_deg", *ALWAYS][:MOST_ROWS]


def test_a_row_shows_both_legs_their_difference_its_error_and_whether_it_exceeds(
    request_of_demonstration: ReportRequest,
) -> None:
    analysis = with_more(request_of_demonstration.visit.analysis, Side.LEFT, "knee_stance_to_swing_rad", -20.0)
    stated = cells(facts(request_of_demonstration, analysis), 0)
    assert stated[:4] == ["Knee flexion, stance to swing, °", "40.7 ± 0.8", "62.0 ± 1.0", "● \u221221.3"]
    assert stated[4] == "\u221229 to \u221214"  # hypot(1.2, 0.043 * 40.7) and hypot(1.2, 0.043 * 62): 7.1, with clocks 7.4
    assert stated[5:] == ["no reference", ""]
    assert is_bold(facts(request_of_demonstration, analysis), 0)
    assert not is_bold(facts(request_of_demonstration), 0)


def is_bold(shown: Facts, row: int) -> bool:
    """Whether the difference is set as larger than its error."""
    (table,) = (block for block in key_numbers(shown, None) if block["kind"] == "table")
    rows = table["rows"]
    assert isinstance(rows, list)
    return bool(rows[row]["cells"][3]["bold"])


def test_a_strip_draws_both_legs_with_half_of_the_error_over_the_band(request_of_demonstration: ReportRequest) -> None:
    rows = {row.column: row for row in key_rows(facts(request_of_demonstration), None)}
    stance, swing = strip(rows["stance_percent"]), strip(rows["knee_stance_to_swing_deg"])
    assert PAPER.band_2sd in stance.svg
    assert PAPER.band_2sd not in swing.svg  # no SD between people can be had
    assert COLOURS[Side.LEFT] in swing.svg
    assert COLOURS[Side.RIGHT] in swing.svg
    assert swing.svg.count(f'stroke="{PAPER.ink}" stroke-width="0.9"') == 6  # two whiskers with two caps each
    found = rows["knee_stance_to_swing_deg"]
    alone = replace(found, values={Side.LEFT: found.values[Side.LEFT]}, difference=replace(found.difference, error=0.0))
    assert COLOURS[Side.RIGHT] not in strip(alone).svg
    assert f'stroke="{PAPER.ink}" stroke-width="0.9"' not in strip(alone).svg


def test_the_band_of_stance_is_that_of_the_table_of_time(request_of_demonstration: ReportRequest) -> None:
    place = ALWAYS.index("stance_percent")
    assert cells(facts(request_of_demonstration), place)[-2] == "60.3 ± 1.1"


def test_a_measure_not_reported_on_one_leg_states_so_and_on_both_is_left_out(
    request_of_demonstration: ReportRequest,
) -> None:
    analysis = request_of_demonstration.visit.analysis
    one = recalibrated(analysis, [Joint.LEFT_KNEE], is_same_joint=False, sign_margin=1.05)
    assert cells(facts(request_of_demonstration, one), 0)[1:4:2] == ["not reported", "–"]
    both = recalibrated(analysis, [Joint.LEFT_KNEE, Joint.RIGHT_KNEE], is_same_joint=False, sign_margin=1.05)
    assert not any(column.startswith("knee") for column in columns(facts(request_of_demonstration, both)))


def test_one_leg_has_rows_without_a_difference(request_of_one_leg: ReportRequest) -> None:
    shown = facts(request_of_one_leg)
    assert columns(shown)[0] == "knee_stance_to_swing_deg"
    assert cells(shown, 0)[2:6] == ["not measured", "–", "–", "no reference"]


def test_a_strip_fits_its_column(request_of_demonstration: ReportRequest) -> None:
    (table,) = (block for block in key_numbers(facts(request_of_demonstration), None) if block["kind"] == "table")
    columns = table["columns"]
    assert isinstance(columns, list)
    assert float(columns[-1]["width"].removesuffix("mm")) * MM >= STRIP_WIDTH
