"""The bench states by itself what is shown otherwise than before, what is provisional, and why something is doubted."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from PySide6.QtCore import Qt
from pytestqt.qtbot import QtBot

from app.summary.comparison import Comparison, Contrast
from app.summary.conditions import Part
from app.widgets.table_cells import ErrorStrip, TextCell
from app.wizard.visit import Visit
from app.wizard.walking.bench_control import Bench
from app.wizard.walking.bench_differences import BenchDifferences
from app.wizard.walking.bench_rows import cautions_of_table, marked_rows, reported_row, shown_rows
from app.wizard.walking.bench_view import BenchView
from app.wizard.walking.shown_before import ShownBefore
from core.body import Joint, JointKind, Side
from core.results import SideGait
from tests.app.wizard.walking.bench_material import bench_visit, state_of
from tests.core.verdicts.built_walk import calibrations, judged_walk, leg, walk


def part(letter: str, joint: Joint | None = None, axis_sd_deg: float = 2.0, **changes: Any) -> Part:
    found = calibrations(joint, axis_sd_rad=np.deg2rad(axis_sd_deg)) if joint is not None else calibrations()
    return Part(letter, f"Alignment {letter}", (judged_walk(walk(name=f"walk {letter}", **changes), found),), found)


def pair(shown: Part, base: Part) -> Comparison:
    return Comparison(Contrast.CONDITIONS, (base, shown))


def bent(range_deg: float, strides: int = 12) -> SideGait:
    return leg(Side.LEFT, strides, knee_range_deg=range_deg)


A, B, C = part("A"), part("B", left=bent(70.0)), part("C", left=bent(72.0))


def test_another_pair_than_before_is_stated_until_somebody_chooses() -> None:
    shown = ShownBefore()
    assert shown.note(pair(B, A), Side.LEFT) == ""
    for _ in range(2):  # it is drawn again and again
        assert shown.note(pair(C, B), Side.LEFT) == "Now C − B; before: B − A."
    shown.chosen()
    assert shown.note(pair(C, A), Side.LEFT) == ""
    assert shown.note(pair(C, B), Side.LEFT) == "Now C − B; before: C − A."  # what it is compared with has changed


def test_a_figure_that_a_further_walk_changes_is_stated_with_what_it_was() -> None:
    shown = ShownBefore()
    shown.note(pair(B, A), Side.LEFT)
    assert shown.note(pair(B, A), Side.LEFT) == ""
    more = replace(B, walks=(*B.walks, judged_walk(walk(left=bent(71.0)), calibrations())))
    stated = "Recalculated with the walks since: knee range of motion +10.5°, before +10.0°."
    assert shown.note(pair(more, A), Side.LEFT) == stated
    assert shown.note(pair(more, A), Side.LEFT) == stated
    shown.chosen()
    assert shown.note(pair(more, A), Side.LEFT) == ""


def test_a_walk_in_the_place_of_an_excluded_one_recalculates_nothing() -> None:
    shown = ShownBefore()
    shown.note(pair(B, A), Side.LEFT)
    repeated = replace(B, walks=(judged_walk(walk(name="walk B again", left=bent(75.0)), calibrations()),))
    assert shown.note(pair(repeated, A), Side.LEFT) == ""


NOT_MEASURED = "The change itself is not measured."


def test_a_new_walk_takes_the_place_of_the_pair_with_a_word_and_leaves_its_figures() -> None:
    visit = bench_visit()
    everything = visit.evaluation.session, visit.recordings.every
    visit.evaluation.session = replace(everything[0], recordings=everything[0].recordings[:2])
    visit.recordings.every = visit.recordings.walks = everything[1][:2]
    analysis = visit.evaluation.analysis
    visit.evaluation.analysis = replace(analysis, recordings=analysis.recordings[:2])
    bench = Bench(cast(Visit, visit))
    before = state_of(bench)
    assert before.found is not None
    assert before.notes == (NOT_MEASURED,)
    bench.begun()
    visit.evaluation.session, visit.evaluation.analysis = everything[0], analysis
    visit.recordings.every = visit.recordings.walks = everything[1]
    after = state_of(bench)
    assert after.notes == (NOT_MEASURED, "Now C − B; before: B − A.")
    bench.choose(1, is_beside=False)
    again = state_of(bench)
    assert again.notes == (NOT_MEASURED,)
    assert (again.answer, again.rows[1].title) == (before.answer, before.rows[1].title)


@pytest.fixture
def differences(qtbot: QtBot) -> BenchDifferences:
    found = BenchDifferences()
    qtbot.addWidget(found)
    return found


def cells(differences: BenchDifferences, name: str) -> tuple[TextCell, Any]:
    """The figures of the first row that begins so, and its strip."""
    rows = (row for row in differences.table.cells.rows if row.cells[0].words.startswith(name))
    _, value, strip = next(rows).cells
    assert isinstance(value, TextCell)
    return value, strip


def test_a_judged_difference_has_its_error_in_figures_and_an_explanation(differences: BenchDifferences) -> None:
    differences.show_pair(pair(B, A), Side.LEFT, "")
    value, strip = cells(differences, "Knee range of motion")
    assert (value.text, value.small, value.tone) == ("○ +10.0°", "±2.8°", "ink")
    assert isinstance(strip, ErrorStrip)
    assert strip.error == pytest.approx(2.77, abs=0.01)  # 1.96 sqrt(2) 1.0, as TRUTH has it
    assert differences.provisional.isHidden()
    row = next(one for one in differences.table.cells.rows if one.cells[0].words.startswith("Knee range"))
    assert row.hint.startswith(
        "Knee range of motion: 60.0° with A, 70.0° with B. Likely between 7° and 13°. Grey: measurement error."
    )


def test_under_ten_strides_the_table_looks_provisional_and_has_no_error(differences: BenchDifferences) -> None:
    differences.show_pair(pair(part("B", left=bent(70.0, 5)), A), Side.LEFT, "")
    assert not differences.provisional.isHidden()
    assert differences.provisional.text() == "Provisional: 5 of 10 strides"
    value, strip = cells(differences, "Ankle dorsiflexion")
    assert (value.tone, value.small) == ("ink2", "")
    assert not isinstance(strip, ErrorStrip)
    heads = [column.head.words for column in differences.table.cells.columns]
    assert heads == ["", "change", ""]
    differences.show_pair(pair(part("B", left=bent(70.0, 10)), A), Side.LEFT, "")
    assert differences.provisional.isHidden()
    assert [column.head.words for column in differences.table.cells.columns] == ["", "change ± error", "error"]


def test_every_head_and_row_is_explained_under_the_mouse(differences: BenchDifferences) -> None:
    differences.show_pair(pair(B, A), Side.LEFT, "")
    hints = [column.hint for column in differences.table.cells.columns[1:]]
    assert all("measurement error" in hint for hint in hints)
    assert differences.table.cells.headerData(1, Qt.Orientation.Horizontal, Qt.ItemDataRole.ToolTipRole) == hints[0]
    assert differences.title.toolTip() == "With B, less what it was with A."
    assert all(row.is_heading or row.hint for row in differences.table.cells.rows)


def test_why_a_value_is_doubted_is_shown_with_the_walk_that_it_is_of(differences: BenchDifferences) -> None:
    doubted = part("B", Joint.RIGHT_KNEE, 8.0, left=bent(70.0))
    assert cautions_of_table(pair(B, A), Side.LEFT) == []
    (stated,) = cautions_of_table(pair(doubted, A), Side.LEFT)
    assert stated.startswith("Caution, right knee. B: ")
    assert "8.0°" in stated
    differences.show_pair(pair(doubted, A), Side.LEFT, "")
    assert (differences.cautions.text(), differences.cautions.isHidden()) == (stated, False)
    differences.show_pair(pair(B, A), Side.LEFT, "")
    assert differences.cautions.isHidden()


def test_why_a_curve_is_doubted_is_beside_it(qtbot: QtBot) -> None:
    bench = Bench(cast(Visit, bench_visit()))
    state = state_of(bench)
    view = BenchView(bench.entry)
    qtbot.addWidget(view)
    view.show_state(state)
    knee, _ = view.frames
    assert (knee.note, knee.verdict.toolTip()) == ("", "")
    doubted = replace(state.parts[0], walks=part("B", Joint.LEFT_KNEE, 8.0).walks)
    view.show_state(replace(state, parts=[doubted, *state.parts[1:]]))
    assert knee.note.startswith("Caution. B: ")
    assert "8.0°" in knee.note
    assert knee.verdict.toolTip().startswith("B: ")


def test_the_table_holds_what_the_sentence_names_and_the_curve_marks_it() -> None:
    """The usual rows have no range of the ankle, and the knee's range is one movement with its flexion in swing."""
    found = pair(part("B", left=leg(Side.LEFT, ankle_range_deg=40.0)), A)
    row = reported_row(found, Side.LEFT)
    assert row is not None
    assert row.measure.column == "ankle_range_deg"
    assert row.measure in [one.measure for one in shown_rows(found, Side.LEFT).prosthetic]
    assert {kind: one.measure.column for kind, one in marked_rows(found, Side.LEFT).items()} == {
        JointKind.ANKLE: "ankle_range_deg"
    }
    assert marked_rows(pair(part("B"), A), Side.LEFT) == {}


def test_what_changes_on_the_sound_side_alone_is_in_the_table_and_on_no_curve() -> None:
    found = pair(part("B", right=leg(Side.RIGHT, ankle_range_deg=40.0)), A)
    assert "ankle_range_deg" in [row.measure.column for row in shown_rows(found, Side.LEFT).sound if row.exceeds]
    assert marked_rows(found, Side.LEFT) == {}


def test_without_a_pair_nothing_is_provisional_or_doubted(differences: BenchDifferences) -> None:
    differences.show_pair(None, Side.LEFT, "")
    assert differences.title.text() == "Nothing to compare yet"
    assert differences.provisional.isHidden()
    assert differences.cautions.isHidden()
