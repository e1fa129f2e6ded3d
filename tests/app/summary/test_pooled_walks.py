"""Which walks are taken together: never tests, walks towards a target, or what the prosthesis was put back to."""

from dataclasses import replace

import pytest

from app.summary.conditions import conditions_of, parts_of
from app.summary.pooled_walks import pool_letters, pools_of
from app.summary.request import AnalysedVisit, default_walks
from app.summary.visits import by_condition, by_stated_condition
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.results import Analysis, Calibration, Method
from core.session import Recording, RecordingKind, Session
from core.timed.protocols import PlannedTest, TimedProtocol
from tests.core.verdicts.built_walk import calibrations, judged_walk, walk

UP = (PartChange(ProsthesisPart.PYLON, height_mm=3.0),)
DOWN = (PartChange(ProsthesisPart.PYLON, height_mm=-3.0),)
TEST = PlannedTest(TimedProtocol.TEN_METRES)
TARGET = "target cadence both 110 steps/min: 5 of 12 strides"


def walked(*reported: tuple[str, AlignmentChange | None] | Recording) -> tuple[Recording, ...]:
    """Walks in order, each by its condition and what was changed before it."""
    found = []
    for number, one in enumerate(reported, start=1):
        name = f"walk {number}"
        if isinstance(one, Recording):
            found.append(replace(one, name=name))
        else:
            found.append(Recording(name, RecordingKind.WALKING, name, {}, condition=one[0], alignment=one[1]))
    return tuple(found)


def letters(recordings: tuple[Recording, ...]) -> list[str]:
    """What the pool of each walk is called."""
    called = pool_letters(recordings)
    return [called[pool] for pool in pools_of(recordings).values()]


def analysed(recordings: tuple[Recording, ...]) -> Analysis:
    walks = tuple(judged_walk(walk(name=one.name, folder=one.folder)) for one in recordings)
    span = Calibration(tuple(one.name for one in walks), calibrations())
    return Analysis(Method.ROBUST, is_simulated=True, calibrations=(span,), recordings=walks)


def of(condition: str, test: PlannedTest | None = None, note: str = "", *, is_restrapped: bool = False) -> Recording:
    reported = Recording("", RecordingKind.WALKING, "", {}, condition=condition, test=test, note=note)
    return replace(reported, is_restrapped_before=is_restrapped)


A, B, B_TO_C = ("A", None), ("B", AlignmentChange("A", UP)), ("C", AlignmentChange("B", UP))
SHOES = ("Shoes", None)
AGAIN = AlignmentChange("B", DOWN, returns_to="A")


def test_walks_with_what_the_prosthesis_was_put_back_to_are_taken_by_themselves() -> None:
    """That B is another alignment, or one at all, somebody has to have stated."""
    assert letters(walked(A, B, A)) == ["A", "B", "A2"]
    assert letters(walked(A, A, B, A)) == ["A", "A", "B", "A3"]
    assert letters(walked(A, B, A, A)) == ["A", "B", "A2", "A2"]
    assert letters(walked(("Barefoot", None), SHOES, ("Barefoot", None))) == ["A", "B", "A"]
    assert letters(walked(A, B, B, SHOES)) == ["A", "B", "B", "C"]
    # put back by hand and written down as a change: C is what A was, so A was left only in between
    assert letters(walked(A, B, ("C", AlignmentChange("B", DOWN)), ("C", None))) == ["A", "B", "C", "C"]


def test_a_return_that_is_stored_as_one_is_a_condition_of_its_own() -> None:
    reported = walked(A, B, ("A again", AGAIN), ("A again", AGAIN))
    assert letters(reported) == ["A", "B", "A2", "A2"]
    parts = parts_of(analysed(reported), reported)
    assert [(part.letter, part.name, len(part.walks)) for part in parts] == [
        *(("A", "A", 1), ("B", "B", 1), ("A2", "A again", 2))
    ]
    assert [part.is_again(parts[0]) for part in parts] == [False, False, True]
    excluded = (reported[0], replace(reported[1], is_kept=False), *reported[2:])  # what lay between counts no more
    assert letters(excluded) == ["A", "A2", "A2"]


def test_between_visits_a_return_is_the_alignment_that_it_leads_to() -> None:
    """As it was walked last, as those are that earlier versions stored under one name."""
    for last in (("A again", AGAIN), A):
        reported = walked(A, B, last)
        found = by_condition(analysed(reported), reported)
        assert {name: part.walks[0].name for name, part in found.items()} == {"A": "walk 3", "B": "walk 2"}
    stated = by_stated_condition(analysed(reported), reported)
    assert [part.walks[0].name for part in stated.values()] == ["walk 3", "walk 2"]
    reported = walked(A, B, ("A again", AGAIN))
    assert list(by_stated_condition(analysed(reported), reported)) == ["A", "B", "A again"]


@pytest.mark.parametrize(
    ("reported", "expected"),
    [
        ((A, B, B_TO_C, ("A again", AGAIN)), ("walk 1", "walk 3", "walk 4")),
        ((SHOES, A, B, B_TO_C, ("D", AlignmentChange("C", UP))), ("walk 2", "walk 4", "walk 5")),
        ((A, SHOES, ("AFO", None), ("Barefoot", None)), ("walk 2", "walk 3", "walk 4")),  # no chain
        ((A, B), ("walk 1", "walk 2")),
    ],
)
def test_a_report_of_a_chain_begins_with_its_starting_point(
    reported: tuple[tuple[str, AlignmentChange | None], ...], expected: tuple[str, ...]
) -> None:
    recordings = walked(*reported)
    assert default_walks(AnalysedVisit(Session(recordings), analysed(recordings))) == expected


def test_sensors_strapped_on_again_begin_another_pool() -> None:
    reported = walked(of("A"), of("A", is_restrapped=True), of("A"))
    assert letters(reported) == ["A", "B", "B"]


def test_attempts_at_one_test_are_together_and_each_walk_towards_a_target_is_alone() -> None:
    reported = walked(
        of("A"), of("A", test=TEST), of("A", note=TARGET), of("A", test=TEST), of("A", note=TARGET), of("A")
    )
    assert letters(reported) == ["A", "A2", "A3", "A2", "A5", "A"]


def test_a_condition_that_was_walked_is_without_its_tests_and_else_by_them() -> None:
    both = walked(of("A", test=TEST), of("A"), of("B", test=TEST))
    found = conditions_of(analysed(both), both)
    assert [(part.letter, part.is_apart) for part in found] == [("A2", False), ("B", True)]
    assert [part.letter for part in parts_of(analysed(both), both)] == ["A", "A2", "B"]
    assert {name: part.letter for name, part in by_condition(analysed(both), both).items()} == {"A": "A2", "B": "B"}


def test_a_visit_is_compared_by_its_walks_also_where_a_test_followed_on_another_strapping() -> None:
    reported = walked(of("A"), of("A", test=TEST, is_restrapped=True))
    assert by_condition(analysed(reported), reported)["A"].walks[0].name == "walk 1"
