"""The prosthetist's bench: the chain and the next change, what it states of two alignments, and its page by keys."""

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.summary.comparison import Comparison, Contrast
from app.summary.conditions import Part, parts_of
from app.widgets.table_cells import TextCell
from app.wizard.visit import Visit
from app.wizard.walking.bench import TOPICS, ChangeEntry, EntryTopic, chain_of, next_walk
from app.wizard.walking.bench_control import Bench
from app.wizard.walking.bench_differences import BenchDifferences
from app.wizard.walking.bench_words import Outcome, bench_answer
from app.wizard.walking.page import WalkingPage
from app.wizard.walking.readout import WalkingReadout
from app.wizard.walking.walk_labels import new_alignment
from app.wizard.walking.walk_list import WalkRow, WalkState
from core.alignment import AlignmentChange, NetChange, PartChange, ProsthesisPart
from core.body import Joint, Side
from core.results import SideGait
from core.session import Recording, Session
from core.timed.protocols import PlannedTest, TimedProtocol
from tests.app.room import words_cut
from tests.app.shared_page import shared
from tests.app.wizard.walking.bench_material import OF_B, OF_C, PYLON, WALKED, bench_visit, recording, state_of
from tests.core.verdicts.built_walk import calibrations, judged_walk, leg, walk


def part(letter: str, **changes: Any) -> Part:
    found = calibrations()
    return Part(letter, f"Alignment {letter}", (judged_walk(walk(**changes), found),), found)


def reported_of(one: Part, other: Part) -> tuple[Outcome, str, str]:
    found = bench_answer(Comparison(Contrast.CONDITIONS, (other, one)), Side.LEFT)
    return found.outcome, found.first, found.then


def test_a_change_is_reported_part_by_part_in_steps_up_to_its_limits() -> None:
    entry = ChangeEntry()
    assert not entry.parts
    entry.step("angle_deg", 3)
    entry.step("turns", -2)
    entry.part = PYLON
    entry.say(" new clamp ")
    entry.step("height_mm", -1000)
    front = PartChange(ProsthesisPart.FOOT_FRONT_SCREW, angle_deg=1.5, turns=-0.25)
    pylon = PartChange(PYLON, height_mm=-100.0, text="new clamp")
    assert entry.parts == (front, pylon)
    assert (entry.figure("angle_deg"), entry.text) == (0.0, " new clamp ")
    other = ChangeEntry()
    other.load(entry.parts)
    assert other.parts == entry.parts
    other.load(())
    assert not list(other.parts)


def test_with_nothing_reported_the_next_walk_is_the_same_alignment_again() -> None:
    chain, entry = chain_of(WALKED[:2], ""), ChangeEntry()
    assert (chain.base, chain.first, chain.next_letter) == ("Alignment B", "Alignment A", "C")
    assert next_walk(chain, entry, "Alignment C") == ("Alignment B", OF_B)
    entry.part = PYLON
    entry.step("height_mm", -1)
    assert next_walk(chain, entry, "Alignment C") == ("Alignment C", OF_C)


def test_put_back_to_the_first_the_next_change_is_from_there() -> None:
    chain, entry = chain_of(WALKED, "Alignment A"), ChangeEntry()
    assert chain.base == "Alignment A"
    assert chain.way_back("Alignment A") == ()
    entry.step("turns", 1)
    condition, change = next_walk(chain, entry, "Alignment D")
    assert (condition, change.since if change else "") == ("Alignment D", "Alignment A")
    latest = chain_of(WALKED, "gone")
    assert latest.base == "Alignment C"
    (back,) = latest.way_back("Alignment A") or ()
    assert back.height_mm == -2.0


def test_what_is_discarded_is_no_part_of_the_chain() -> None:
    chain = chain_of((*WALKED[:2], replace(WALKED[2], is_kept=False)), "")
    assert (chain.base, chain.next_letter) == ("Alignment B", "C")


def swinging(range_deg: float, swing_deg: float) -> SideGait:
    """A left leg whose knee also straightens and bends in swing."""
    found = leg(Side.LEFT, knee_range_deg=range_deg)
    swing = {"knee_stance_to_swing_rad": np.full(len(found.strides), np.deg2rad(swing_deg))}
    return replace(found, parameters={**found.parameters, **swing})


def test_the_sentence_is_of_the_prosthetic_sides_change_and_its_error(snapshot: SnapshotAssertion) -> None:
    """10 is between 7 and 13, as 10 -+ 1.96 sqrt(2) 1.0; seven strides are too few, and ten are enough."""
    base, from_57 = part("A"), part("A", left=swinging(59.0, 57.0))

    def bent(range_deg: float, strides: int = 12) -> tuple[Outcome, str, str]:
        return reported_of(part("B", left=leg(Side.LEFT, strides, knee_range_deg=range_deg)), base)

    def swung(swing_deg: float) -> tuple[Outcome, str, str]:
        return reported_of(part("B", left=swinging(70.0, swing_deg)), from_57)

    assert {
        "more, with both values": bent(70.0),
        "of a range and the excursion that makes it, the excursion": swung(68.0),
        "the range where the excursion hardly changes": swung(58.5),
        "the range where the excursion changes the other way and less": swung(48.0),
        "only the sound side changes": reported_of(part("B", right=leg(Side.RIGHT, knee_range_deg=70.0)), base),
        "within error, with what fits": bent(61.0),
        "nothing is judged under ten strides": bent(80.0, 7),
        "ten strides": bent(80.0, 10),
    } == snapshot


def test_strapped_on_again_between_the_error_is_the_larger_and_stated_so() -> None:
    """4° are beyond the error of one strapping and inside that of two."""
    other = part("A")
    changed = part("B", left=leg(Side.LEFT, knee_range_deg=65.0))
    assert reported_of(changed, other)[0] is Outcome.DIFFERS
    outcome, _, then = reported_of(replace(changed, attachment=1), other)
    assert outcome is Outcome.NOTHING
    assert "Sensors were reattached in between." in then


def test_a_change_that_the_table_marks_is_reported_with_its_error_however_little_it_is_beyond() -> None:
    """63.2 against 60 is beyond the error of 2.8, and by less than a sentence on paper needs, 3.3."""
    one, other = part("B", left=leg(Side.LEFT, knee_range_deg=63.2)), part("A")
    (row,) = (
        row
        for row in Comparison(Contrast.CONDITIONS, (other, one)).rows
        if (row.measure.column, row.side) == ("knee_range_deg", Side.LEFT)
    )
    assert row.exceeds
    assert not row.difference.is_worth_a_sentence
    outcome, first, then = reported_of(one, other)
    assert outcome is Outcome.DIFFERS
    assert first == "Prosthetic-side knee has 63.2° range of motion with B, 3.2° more than with A (60.0°)."
    assert then.startswith("Likely between 0.4° and 6.0°.")  # 3.2 -+ 2.8


@pytest.mark.parametrize("is_biased", [True, False])
def test_stance_of_a_prosthetic_foot_is_compared_at_the_bench_nowhere(qtbot: QtBot, is_biased: bool) -> None:
    def of(stance_percent: float) -> SideGait:
        return leg(Side.LEFT, stance_percent=stance_percent, is_toe_off_biased=is_biased)

    one, other = part("B", left=of(70.0)), part("A", left=of(60.0))
    outcome, *_ = reported_of(one, other)
    assert outcome is (Outcome.NOTHING if is_biased else Outcome.DIFFERS)
    differences = BenchDifferences()
    qtbot.addWidget(differences)
    differences.show_pair(Comparison(Contrast.CONDITIONS, (other, one)), Side.LEFT, "")
    stated = [[cell.text for cell in row.cells if isinstance(cell, TextCell)] for row in differences.table.cells.rows]
    (stance, *_) = (row for row in stated if row[0].startswith("Stance"))
    assert ("not compared" in stance) is is_biased


def test_what_was_set_at_the_foot_is_stated_beside_what_is_measured() -> None:
    plantar = AlignmentChange("Alignment A", (PartChange(ProsthesisPart.FOOT_FRONT_SCREW, angle_deg=3.0),))
    visit = bench_visit()
    walks = visit.evaluation.analysis.recordings[:2]
    for one, swing_deg in zip(walks, (5.0, 2.2), strict=True):
        left = one.gait[Side.LEFT]
        left.parameters["shank_to_foot_in_swing_rad"] = np.full(len(left.strides), np.deg2rad(swing_deg))
    recordings = (WALKED[0], recording(2, "B", plantar))
    every = [SimpleNamespace(details=one, read_back=None) for one in recordings]
    visit.recordings = SimpleNamespace(every=every, walks=every)
    visit.evaluation.session = Session(recordings)
    visit.evaluation.analysis = replace(visit.evaluation.analysis, recordings=walks)
    assert state_of(Bench(cast(Visit, visit))).notes[0] == "Set 3.0° plantarflexion, measured 2.8° (±0.7°)."
    assert state_of(Bench(cast(Visit, bench_visit()))).notes[0] == "The change itself is not measured."


def test_below_the_knee_no_knee_unit_is_offered() -> None:
    visit = bench_visit()
    bench = Bench(cast(Visit, visit))
    for joints, has_knee in ((visit.prosthetic_joints, True), (frozenset({Joint.LEFT_ANKLE}), False)):
        visit.prosthetic_joints = joints
        state_of(bench)
        assert bench.entry.has_knee is has_knee


@pytest.fixture
def visit() -> SimpleNamespace:
    return bench_visit()


@pytest.fixture
def bench(visit: SimpleNamespace) -> Bench:
    return Bench(cast(Visit, visit))


def shown(bench: Bench) -> tuple[str, str]:
    state = state_of(bench)
    return (state.found.parts[1].letter, state.found.against.letter) if state.found else (state.parts[0].letter, "")


def test_each_alignment_is_against_the_one_it_was_changed_from_until_another_is_chosen(bench: Bench) -> None:
    assert shown(bench) == ("C", "B")
    bench.choose(1, is_beside=False)
    assert shown(bench) == ("B", "A")
    bench.choose(2, is_beside=True)
    assert shown(bench) == ("B", "C")
    bench.choose(0, is_beside=False)
    assert shown(bench) == ("A", "")
    bench.choose(8, is_beside=False)
    assert shown(bench) == ("A", "")


def test_to_return_it_states_what_to_undo_and_can_be_taken_back(bench: Bench) -> None:
    assert bench.return_to_first() == "Back to A: Pylon \N{MINUS SIGN}2 mm"
    assert bench.chain.base == "Alignment A"
    assert bench.next_title == "A2: A again. Undo first: Pylon −2 mm"  # as long as it is so
    assert bench.return_to_first() == ""  # it is there
    assert bench.undo_return()
    assert bench.chain.base == "Alignment C"
    assert bench.next_title == "Next change, from C"
    assert bench.undo_return() is False
    assert bench.return_to_first()
    bench.settle_return()  # something else was done since
    assert bench.undo_return() is False
    assert bench.chain.base == "Alignment A"


AGAIN = AlignmentChange("Alignment C", (PartChange(PYLON, height_mm=-2.0),), returns_to="Alignment A")


def walked_again(visit: SimpleNamespace, letter: str = "A again", **reported: Any) -> Recording:
    """A walk more with the first alignment, 6° more of the knee; letter "A": as earlier versions stored it."""
    again = recording(4, letter, AGAIN if letter == "A again" else None, **reported)
    every = [*visit.recordings.every, SimpleNamespace(details=again, read_back=None)]
    visit.recordings.every = visit.recordings.walks = every
    evaluation = visit.evaluation
    one = judged_walk(walk(left=leg(Side.LEFT, knee_range_deg=66.0), name="walk 4", folder="walk 4"))
    evaluation.analysis = replace(evaluation.analysis, recordings=(*evaluation.analysis.recordings, one))
    evaluation.session = Session((*evaluation.session.recordings, again))
    return again


def sentence_of(bench: Bench, number: int) -> str:
    bench.choose(number, is_beside=False)
    return state_of(bench).answer.first


def test_a_walk_after_the_return_is_beside_the_first_and_changes_nothing_that_was_shown(
    bench: Bench, visit: SimpleNamespace
) -> None:
    before = sentence_of(bench, 1)
    assert "10.0° more than with A" in before
    assert bench.return_to_first()
    assert bench.next_walk() == ("Alignment A again", AGAIN)
    walked_again(visit)
    bench.begun()
    state = state_of(bench)
    assert [(row.letter, row.title, row.lines) for row in state.rows][-1] == (
        *("A2", "A again"),
        (("Pylon, height", "−2 mm"),),
    )
    assert shown(bench) == ("A2", "A")
    assert state.answer.first.endswith(" range of motion with A2, 6.0° more than with A (60.0°).")
    assert state.notes[0] == "A2 is A again: this is walk-to-walk variation, or the return is not exact."
    assert sentence_of(bench, 1) == before
    assert bench.chain.next_letter == "D"
    assert (bench.next_title, bench.next_walk()) == ("Next change, from A2", ("Alignment A again", AGAIN))
    assert bench.return_to_first() == ""  # it is there
    bench.entry.step("turns", 1)
    condition, change = bench.next_walk()
    assert (condition, change.since if change else "") == ("Alignment D", "Alignment A again")


def test_what_earlier_versions_stored_of_a_return_reads_as_it_did(bench: Bench, visit: SimpleNamespace) -> None:
    before = sentence_of(bench, 1)
    walked_again(visit, "A")
    bench.begun()
    state = state_of(bench)
    assert [(row.letter, row.title, row.lines) for row in state.rows][-1] == ("A2", "A again", ())
    assert shown(bench) == ("A2", "A")
    assert sentence_of(bench, 1) == before


def test_a_second_return_is_a_condition_of_its_own() -> None:
    chain = chain_of((*WALKED, recording(4, "A again", AGAIN)), "")
    further = AlignmentChange("Alignment A again", (PartChange(PYLON, turns=1.0),))
    back = chain_of((*chain.recordings, recording(5, "D", further)), "Alignment A")
    assert back.again == (
        "Alignment A again 2",
        AlignmentChange("Alignment D", (PartChange(PYLON, turns=-1.0),), returns_to="Alignment A"),
    )
    assert (back.again_letter, back.next_letter, back.first) == ("A3", "E", "Alignment A")
    assert dict(back.letters)["Alignment A again"] == "A2"


def test_put_back_to_another_than_the_first_the_next_walk_is_that_one_again() -> None:
    assert chain_of(WALKED, "Alignment B").again == (
        "Alignment B again",
        AlignmentChange("Alignment C", (PartChange(PYLON, height_mm=1.0),), returns_to="Alignment B"),
    )
    returned = (
        *WALKED,
        recording(4, "A again", AGAIN),
        recording(5, "D", AlignmentChange("Alignment A again", OF_C.parts)),
    )
    label, change = chain_of(returned, "Alignment A again").again
    assert (label, change.returns_to) == ("Alignment A again 2", "Alignment A")


def test_the_chain_begins_with_its_own_first_and_not_with_another_condition_walked_before() -> None:
    barefoot = replace(recording(9, "A"), condition="Barefoot")
    chain = chain_of((barefoot, *WALKED), "")
    assert chain.first == "Alignment A"
    assert chain.way_back(chain.first) == (NetChange(PYLON, height_mm=-2.0),)


@pytest.mark.parametrize(
    "reported",
    [
        {"test": PlannedTest(TimedProtocol.TEN_METRES)},
        {"note": "target knee_swing_peak left 60 deg: 5 of 12 strides"},
    ],
)
def test_a_timed_test_and_a_walk_towards_a_target_are_none_of_an_alignment(
    bench: Bench, visit: SimpleNamespace, reported: dict[str, Any]
) -> None:
    before = sentence_of(bench, 1)
    walked_again(visit, **reported)
    state = state_of(bench)
    assert [row.letter for row in state.rows] == ["A", "B", "C"]
    assert sentence_of(bench, 1) == before
    every = parts_of(visit.evaluation.analysis, visit.evaluation.session.recordings)
    assert [(part.letter, part.is_apart) for part in every][-1] == ("A2", True)


def test_where_only_tests_were_walked_the_bench_states_what_to_do(bench: Bench, visit: SimpleNamespace) -> None:
    tests = tuple(replace(one, test=PlannedTest(TimedProtocol.TEN_METRES)) for one in WALKED)
    visit.evaluation.session = Session(tests)
    assert state_of(bench).answer.first == "No walk to compare yet."


def test_a_discarded_walk_after_the_return_leaves_the_prosthesis_as_it_is(bench: Bench, visit: SimpleNamespace) -> None:
    assert bench.return_to_first()
    bench.begun()
    bench.discarded(walked_again(visit, is_kept=False))
    assert (bench.chain.base, bench.next_title) == ("Alignment A", "A2: A again")
    assert bench.next_walk() == ("Alignment A again", AGAIN)
    assert bench.entry.parts == ()
    bench.entry.step("turns", 1)
    bench.begun()
    assert bench.chain.base == "Alignment C"


def test_a_discarded_walks_change_is_reported_again_of_the_next(bench: Bench, visit: SimpleNamespace) -> None:
    change = AlignmentChange("Alignment C", (PartChange(PYLON, turns=1.0),))
    walk = recording(4, "D", change, is_kept=False)
    visit.recordings.walks = visit.recordings.every = [
        *visit.recordings.every,
        SimpleNamespace(details=walk, read_back=None),
    ]
    bench.discarded(walk)
    assert bench.entry.parts == change.parts
    bench.begun()
    assert bench.entry.parts == ()
    bench.discarded(walk)
    bench.counts_again(walk)
    assert bench.entry.parts == ()


def test_no_bench_where_no_side_is_sound_or_nothing_was_walked(bench: Bench, visit: SimpleNamespace) -> None:
    offered = [bench.is_offered]
    visit.prosthetic_sides = frozenset(Side)
    offered.append(bench.is_offered)
    visit.prosthetic_sides = frozenset({Side.LEFT})
    visit.recordings.walks = []
    offered.append(bench.is_offered)
    visit.recordings.walks = [SimpleNamespace(details=replace(WALKED[0], condition="Barefoot"), read_back=None)]
    offered.append(bench.is_offered)
    assert offered == [True, False, False, False]


def test_the_next_alignment_is_called_by_its_letter_and_never_as_one_before(bench: Bench) -> None:
    bench.entry.step("turns", 1)
    assert bench.next_walk()[0] == "Alignment D"
    assert new_alignment("B", ["Alignment A", "Alignment B"]) == "Alignment C"


def test_while_a_walk_is_analysed_nothing_is_stated_of_the_ones_before(bench: Bench, visit: SimpleNamespace) -> None:
    visit.evaluation.is_busy = True
    assert state_of(bench).answer.first == "The walk is being analysed."
    assert "10.0° more than with A" in sentence_of(bench, 1)  # somebody asks for them


def test_of_a_walk_that_was_seen_in_part_only_nothing_is_stated(bench: Bench, visit: SimpleNamespace) -> None:
    visit.recordings.walks[-1].read_back = SimpleNamespace(imu={})  # whole, after Stop
    state = state_of(bench)
    assert (state.answer.first, state.notes) == ("The walk is being analysed.", ())
    visit.recordings.walks[-1].read_back = SimpleNamespace(imu=visit.evaluation.session.recordings[-1].imu)
    assert "with C" in state_of(bench).answer.first


def test_a_walk_whose_analysis_ended_early_is_not_stated_to_be_analysed(bench: Bench, visit: SimpleNamespace) -> None:
    visit.evaluation.session = Session(WALKED[:2])
    visit.evaluation.has_failed = True
    assert state_of(bench).answer.first == "The analysis stopped before it finished."


def kept(letters: str = "ABC") -> tuple[WalkRow, ...]:
    return tuple(WalkRow(str(k), one, f"Alignment {one}", WalkState.KEPT, 12) for k, one in enumerate(letters))


def page_of(qtbot: QtBot, bench: Bench, width: int, height: int) -> WalkingPage:
    """One of its own, as of another language."""
    page = WalkingPage(bench.entry)
    qtbot.addWidget(page)
    page.resize(width, height)
    page.show_walks(kept())
    page.show_bench(bench.state())
    with qtbot.waitActive(page):
        page.show()
    return page


@pytest.fixture(scope="module")
def one_page(qapp: QApplication) -> Iterator[tuple[ChangeEntry, WalkingPage]]:
    """Made once, and what is entered on it."""
    entry = ChangeEntry()
    yield from ((entry, page) for page in shared(WalkingPage(entry)))


@pytest.fixture
def page(one_page: tuple[ChangeEntry, WalkingPage], bench: Bench) -> WalkingPage:
    bench.entry, page = one_page
    bench.entry.load(())
    page.set_compact(False)
    page.resize(1064, 600)
    page.show_walks(kept())
    page.show_bench(bench.state())
    page.show()
    return page


def test_the_chip_is_of_the_leg_that_is_prosthetic_also_once_that_was_corrected(
    page: WalkingPage, bench: Bench, visit: SimpleNamespace
) -> None:
    chip = page.bench.alignments.chip
    assert (chip.side, chip.accessibleName()) == (Side.LEFT, "left leg")
    visit.prosthetic_sides = {Side.RIGHT}
    page.show_bench(bench.state())
    assert (chip.side, chip.accessibleName()) == (Side.RIGHT, "right leg")


def test_the_page_shows_the_chain_the_curves_and_the_differences(
    page: WalkingPage, bench: Bench, snapshot: SnapshotAssertion
) -> None:
    assert page.bench.isVisible()
    assert not page.charts.isVisible()
    assert not page.next.isVisible()
    assert [(row.letter, row.title, row.lines) for row in page.bench.alignments.rows] == snapshot
    assert [[curve.letter for curve in frame.chart.curves] for frame in page.bench.frames] == [["B", "C"]] * 2
    bench.choose(1, is_beside=False)
    page.show_bench(bench.state())
    assert page.bench.differences.title.text() == "B \N{MINUS SIGN} A"
    assert "10.0° more than with A" in page.bench.first.text()
    (knee, _) = page.bench.frames
    assert np.nanmax(knee.chart.curves[1].angle_deg) - np.nanmax(knee.chart.curves[0].angle_deg) == pytest.approx(10.0)
    assert knee.chart.deviations
    page.show_bench(None)
    assert page.charts.isVisible()


def test_each_curve_states_what_may_be_read_of_it(page: WalkingPage, bench: Bench) -> None:
    state = state_of(bench)
    page.bench.show_state(state)
    assert [frame.verdict.text() for frame in page.bench.frames] == ["Good", "Good"]
    axis = replace(calibrations()[Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(8.0))
    unsure = {**calibrations(), Joint.LEFT_KNEE: axis}
    doubted = replace(state.parts[0], walks=(judged_walk(walk(), unsure),))
    page.bench.show_state(replace(state, parts=[doubted, *state.parts[1:]]))
    assert [frame.verdict.text() for frame in page.bench.frames] == ["Caution", "Good"]


def test_the_next_change_is_reported_by_keys_and_reads_as_it_prints(page: WalkingPage, bench: Bench) -> None:
    card = page.bench.alignments
    card.fields.reported.connect(lambda: card.show_entry(bench.next_title))
    assert card.fields.written.text() == "Nothing changed yet."
    for name, key, times in (
        ("turns", Qt.Key.Key_Plus, 4),
        ("angle_deg", Qt.Key.Key_Up, 5),
        ("angle_deg", Qt.Key.Key_Minus, 1),
    ):
        for _ in range(times):
            QTest.keyClick(card.fields.steppers[name], key)
    assert card.fields.written.text() == "Recorded as: Foot, anterior screw ½ turn out, +2° plantar"
    assert card.next_title.text() == "D: changed from C"
    assert card.fields.steppers["turns"].accessibleName() == "Screw turns: ½ out"
    card.fields.parts.setCurrentIndex(TOPICS.index(EntryTopic(PYLON)))
    QTest.keyClicks(card.fields.words.line_edit, "clamp")
    assert bench.entry.parts[-1] == PartChange(PYLON, text="clamp")
    assert card.fields.steppers["turns"].value == "0"


def test_in_a_small_window_each_has_a_tab(page: WalkingPage) -> None:
    page.set_compact(True)
    page.resize(896, 420)
    cards = [page.bench.alignments, page.bench.frames[0], page.bench.differences]
    for number, tab in enumerate(("alignments", "curves", "changes")):
        page.bench.tabs.segments[number].click()
        assert page.bench.tabs.choice == tab
        assert [card.isVisible() for card in cards] == [k == number for k in range(3)]


@pytest.mark.usefixtures("pseudo_language")
def test_no_word_of_the_bench_is_cut_in_a_language_as_long_as_german(qtbot: QtBot, bench: Bench) -> None:
    bench.entry.step("turns", -3)
    page = page_of(qtbot, bench, 1064, 600)
    assert words_cut(page) == []
    page.set_compact(True)
    page.resize(896, 420)
    assert words_cut(page) == []


@pytest.mark.usefixtures("pseudo_language")
def test_as_the_window_widens_the_cards_come_apart_once(qtbot: QtBot, bench: Bench) -> None:
    page = page_of(qtbot, bench, 1400, 500)  # curves that were never shown ask for less
    is_tabbed = []
    for width in range(1000, 1400, 4):
        page.resize(width, 500)
        is_tabbed.append(page.bench.tabs.isVisible())
    assert is_tabbed == sorted(is_tabbed, reverse=True)
    assert set(is_tabbed) == {False, True}


@pytest.mark.usefixtures("pseudo_language")
def test_where_three_have_no_room_curves_and_differences_take_turns_beside_the_alignments(
    qtbot: QtBot, bench: Bench
) -> None:
    page = page_of(qtbot, bench, 1000, 500)
    view = page.bench
    cards = (view.alignments, view.frames[0], view.differences)
    assert [one.isVisible() for one in view.tabs.segments] == [False, True, True]
    assert [one.isVisible() for one in cards] == [True, True, False]
    view.tabs.segments[2].click()
    assert [one.isVisible() for one in cards] == [True, False, True]
    view.focus_entry()
    assert view.alignments.fields.parts.hasFocus()
    assert view.frames[0].isVisible()


def test_in_a_small_window_the_next_change_is_reported_without_scrolling(page: WalkingPage) -> None:
    """896 x 420 is what 960 x 600 leaves of the window between header and a bar of two rows."""
    page.set_compact(True)
    page.resize(896, 420)
    page.bench.focus_entry()
    QTest.qWait(50)
    fields = page.bench.alignments.fields
    for widget in (fields.parts, *fields.steppers.values(), fields.words.line_edit, fields.written):
        assert widget.isVisible()
        seen = widget.visibleRegion().boundingRect()
        assert seen.size() == widget.size(), widget.accessibleName()


def test_a_walk_that_begins_shows_no_strides_of_the_one_before(page: WalkingPage) -> None:
    page.show_view(WalkingReadout(now_s=20.0, strides={Side.LEFT: 13, Side.RIGHT: 12}, cadence_steps_min=104.0))
    assert page.figures.in_words.startswith("13 strides.")
    page.count_again()
    assert page.figures.in_words.startswith("0 strides. Left 0. Right 0.")
    assert "104" not in page.figures.in_words


def test_the_simulated_prosthesis_is_reported_by_what_it_differs_from_the_first() -> None:
    chain = chain_of(WALKED, "")
    assert chain.set_so("Alignment A", None) == ()
    assert chain.set_so("Alignment B", OF_B) == (NetChange(PYLON, height_mm=3.0),)
    turned = AlignmentChange("Alignment C", (PartChange(ProsthesisPart.KNEE_UNIT, turns=-1.0),))
    required = (NetChange(ProsthesisPart.KNEE_UNIT, turns=-1.0), NetChange(PYLON, height_mm=2.0))
    assert chain.set_so("Alignment D", turned) == required
    assert chain_of((), "").set_so("Alignment A", None) == ()


@pytest.mark.parametrize(("rise_deg", "is_named"), [(66.0, True), (61.0, False)])
def test_a_measure_for_fitting_is_named_where_it_changes_by_more_than_its_error(
    qtbot: QtBot, rise_deg: float, is_named: bool
) -> None:
    def with_rise(of: SideGait, degrees: float) -> SideGait:
        rise = np.full(len(of.strides), np.deg2rad(degrees))
        return replace(of, parameters={**of.parameters, "foot_heel_rise_rad": rise})

    before, after = (
        part("A", left=with_rise(leg(Side.LEFT), 60.0)),
        part("B", left=with_rise(leg(Side.LEFT, knee_range_deg=62.0), rise_deg)),
    )
    shown_differences = BenchDifferences()
    qtbot.addWidget(shown_differences)
    shown_differences.show_pair(Comparison(Contrast.CONDITIONS, (before, after)), Side.LEFT, "")
    names = [row.cells[0] for row in shown_differences.table.cells.rows]
    words = [cell.text for cell in names if isinstance(cell, TextCell)]
    assert ("Heel rise" in words) is is_named
    assert "Foot flat (% gait cycle)" not in words  # was not measured


@pytest.mark.usefixtures("pseudo_language")
def test_no_word_of_what_is_not_compared_is_cut(qtbot: QtBot, bench: Bench, visit: SimpleNamespace) -> None:
    walks = visit.evaluation.analysis.recordings
    late = [{**one.gait, Side.LEFT: replace(one.gait[Side.LEFT], is_toe_off_biased=True)} for one in walks]
    judged = tuple(judged_walk(replace(one, gait=gait)) for one, gait in zip(walks, late, strict=True))
    visit.evaluation.analysis = replace(visit.evaluation.analysis, recordings=judged)
    assert words_cut(page_of(qtbot, bench, 1240, 600)) == []
