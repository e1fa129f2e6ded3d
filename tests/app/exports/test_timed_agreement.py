"""Screen, paper and timed_test.csv give the same parts, times and verdicts of the same simulated courses."""

import csv
import io
import json
from collections.abc import Iterator
from dataclasses import replace

import pytest
from pytestqt.qtbot import QtBot

from app.exports.timed_csv import HEADER, timed_rows
from app.reports.patient.document import facts_of
from app.reports.patient.timed_page import timed_page
from app.summary.request import AnalysedVisit, ReportRequest
from app.widgets.table import CellTable
from app.widgets.table_cells import TextCell
from app.wizard.walking.timed_result import TimedAttempt, TimedResult, TimedResultView
from core.results import RecordingAnalysis
from core.session import RecordingKind
from core.timed.found import PartOfUpAndGo
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.walker import DEMONSTRATION, CourseKind, Standing, TimedCourse
from devices.simulation.walker_body import UpAndGo
from tests.app.reports.patient.conftest import MADE_AT
from tests.simulated import analysis_of, session_of

UP, RISES, STAIRS, TWO = (
    *(TimedProtocol.UP_AND_GO, TimedProtocol.SIT_TO_STAND),
    *(TimedProtocol.STAIRS, TimedProtocol.TWO_MINUTES),
)
# what was entered of each, and what was walked: the second up and go on a course twice as long as entered
PLANNED = {
    "walk 1": PlannedTest(UP, course_m=3.0),
    "walk 2": PlannedTest(UP, course_m=3.0),
    "walk 3": PlannedTest(RISES),
    "walk 4": PlannedTest(STAIRS),
    "walk 5": PlannedTest(TWO, lap_m=10.0),
}
WALKED = (
    TimedCourse(CourseKind.UP_AND_GO, 3, name="walk 1", is_joined=True),
    TimedCourse(CourseKind.UP_AND_GO, 4, name="walk 2", is_joined=True, up_and_go=UpAndGo(cone_m=6.0)),
    TimedCourse(CourseKind.SIT_TO_STAND, 5, name="walk 3", is_joined=True),
    TimedCourse(CourseKind.STAIRS, 6, name="walk 4"),
    TimedCourse(CourseKind.TWO_MINUTES, 7, lap_m=10.0, name="walk 5"),
)
PARTS = {
    PartOfUpAndGo.RISE: "Rise",
    PartOfUpAndGo.WALK_OUT: "Walk out",
    PartOfUpAndGo.TURN: "Turn",
    PartOfUpAndGo.WALK_BACK: "Walk back",
    PartOfUpAndGo.TURN_TO_SIT: "Turn to sit",
    PartOfUpAndGo.SIT: "Sit down",
}


@pytest.fixture(scope="module")
def visit() -> AnalysedVisit:
    made = session_of(replace(DEMONSTRATION, recordings=(Standing(), *WALKED)))
    recordings = tuple(
        replace(one, condition="shoes", test=PLANNED[one.name]) if one.kind is RecordingKind.WALKING else one
        for one in made.recordings
    )
    session = replace(made, recordings=recordings)
    return AnalysedVisit(session, analysis_of(session))


def in_file(visit: AnalysedVisit, name: str) -> list[dict[str, str]]:
    """The rows of one walk as another program reads them."""
    file = io.StringIO()
    writer = csv.writer(file)
    writer.writerows([HEADER, *timed_rows(visit.analysis, visit.session.recordings)])
    folder = next(one.folder for one in visit.session.recordings if one.name == name)
    return [row for row in csv.DictReader(io.StringIO(file.getvalue())) if row["recording"] == folder]


def on_screen(qtbot: QtBot, visit: AnalysedVisit, *names: str) -> TimedResultView:
    view = TimedResultView()
    qtbot.addWidget(view)
    walks = {one.name: one for one in visit.analysis.recordings}
    attempts = [TimedAttempt(name, PLANNED[name], walks[name].timed, is_kept=True) for name in names]
    view.show_state(TimedResult(attempts, names))
    view.show()
    return view


def rows_of(table: CellTable) -> dict[str, list[str]]:
    """The texts of a table's rows, by their first."""
    rows = [[cell.text for cell in row.cells if isinstance(cell, TextCell)] for row in table.cells.rows]
    return {first: rest for first, *rest in rows}


def on_paper(visit: AnalysedVisit) -> tuple[str, dict[str, dict[str, list[str]]]]:
    """All words of the page, and the rows of each table by the heading before it."""
    request = ReportRequest(visit, ("walk 1",), MADE_AT, "1.2.3")
    blocks = timed_page(request, facts_of(request))
    tables: dict[str, dict[str, list[str]]] = {}
    title = ""
    for block in blocks:
        if block["kind"] == "heading":
            title = str(block["said"])
        elif block["kind"] == "table":
            rows = [[cell["said"] for cell in row["cells"]] for row in block["rows"]]  # type: ignore[attr-defined]  # a table's
            tables[title] = {first: rest for first, *rest in rows}
    return json.dumps(blocks, ensure_ascii=False), tables


def seconds(value: str) -> str:
    return f"{float(value):.2f}"


def walks(visit: AnalysedVisit) -> Iterator[RecordingAnalysis]:
    return (one for one in visit.analysis.recordings if one.timed is not None)


def test_the_six_parts_of_an_up_and_go_are_the_same_everywhere(qtbot: QtBot, visit: AnalysedVisit) -> None:
    in_files = {row["part"]: seconds(row["time_s"]) for row in in_file(visit, "walk 1") if row["row"] == "part"}
    assert list(in_files) == [str(part) for part in PartOfUpAndGo]
    shown = rows_of(on_screen(qtbot, visit, "walk 1").parts)
    printed = on_paper(visit)[1]["Timed Up and Go: sections"]
    for part, name in PARTS.items():
        assert shown[name] == [in_files[part]]
        assert printed[name][0] == in_files[part]
    whole = float(in_file(visit, "walk 1")[0]["time_s"])
    assert 0.8 * whole < sum(map(float, in_files.values())) < whole + 0.5, "before the seat the patient may stand"


def test_every_rise_is_the_same_everywhere_and_so_is_the_slowest(qtbot: QtBot, visit: AnalysedVisit) -> None:
    rows = in_file(visit, "walk 3")
    rises = [seconds(row["time_s"]) for row in rows if row["row"] == "rise"]
    (slowest,) = [seconds(row["time_s"]) for row in rows if row["row"] == "rise_slowest"]
    assert len(rises) == 5
    assert slowest == max(rises, key=float)
    view = on_screen(qtbot, visit, "walk 3")
    shown = rows_of(view.parts)
    assert [texts[-1] for texts in shown.values()] == rises
    marked = [name for name in shown if name.endswith(", slowest")]
    assert marked == [f"Rise {1 + rises.index(slowest)}, slowest"]
    assert f"Slowest rise: number {1 + rises.index(slowest)}, {slowest} s." in view.then.text()
    assert [texts[0] for texts in on_paper(visit)[1][f"{'5 × sit to stand'}: sections"].values()] == rises


def test_strides_up_and_down_are_apart_everywhere(qtbot: QtBot, visit: AnalysedVisit) -> None:
    stairs = [row for row in in_file(visit, "walk 4") if row["row"] == "stair"]
    up = [row for row in stairs if float(row["climb_m"]) > 0.0]
    assert 0 < len(up) < len(stairs)
    shown = rows_of(on_screen(qtbot, visit, "walk 4").parts)
    printed = on_paper(visit)[1]["Stairs: sections"]
    for name, own in (("Up", up), ("Down", [row for row in stairs if row not in up])):
        mean_s = sum(float(row["time_s"]) for row in own) / len(own)
        assert shown[name][0] == printed[name][0] == str(len(own))
        assert float(shown[name][1]) == pytest.approx(mean_s, abs=0.006)
        assert shown[name] == printed[name]


def test_laps_are_the_same_everywhere_with_the_source_of_the_distance(qtbot: QtBot, visit: AnalysedVisit) -> None:
    rows = in_file(visit, "walk 5")
    assert rows[0]["distance_source"] == "found_laps"
    laps = [f"{float(row['distance_m']):.1f}" for row in rows if row["row"] == "lap"]
    view = on_screen(qtbot, visit, "walk 5")
    shown = {name: texts for name, texts in rows_of(view.parts).items() if name.startswith("Lap")}
    assert [texts[1] for texts in shown.values()] == laps[: len(shown)]
    words, printed = on_paper(visit)
    assert [printed["2-minute walk: sections"][name] for name in shown] == list(shown.values())
    for stated in (view.then.text(), words):
        assert "Distance: laps detected, 10 m each; the foot sensors measured " in stated


def test_a_course_of_another_length_is_not_valid_anywhere_and_in_no_mean(qtbot: QtBot, visit: AnalysedVisit) -> None:
    (row,) = [row for row in in_file(visit, "walk 2") if row["row"] == "test"]
    assert (row["validity"], row["course_m"]) == ("not_valid", "3.000")
    assert "course_longer_than_entered" in row["not_valid"].split()
    found = f"{float(row['course_found_m']):.1f}"
    sentence = f"Not valid: {found} m from the chair to the turn, the course is 3 m."
    view = on_screen(qtbot, visit, "walk 1", "walk 2")
    assert view.not_valid.isVisible()
    assert view.not_valid.text.startswith(sentence)
    assert list(rows_of(view.attempts)) == ["walk 1", "walk 2, not valid"], "and there is no mean of both"
    words, printed = on_paper(visit)
    assert sentence in words
    assert any(name.endswith(", not valid") for name in printed["Timed tests"])
    (valid,) = [row for row in in_file(visit, "walk 1") if row["row"] == "test"]
    assert (valid["validity"], valid["not_valid"]) == ("valid", "")
    assert not on_screen(qtbot, visit, "walk 1").not_valid.isVisible()
    assert words.count("Not valid: ") == 1
