"""Targets of a walk: what counts as reached, and how it goes into a recording's note and back."""

import pytest

from core.body import Side
from core.targets import Target, TargetMeasure, TargetTally, shown_value, tallies_of, with_tallies

KNEE = Target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, 55)
BEAT = Target(TargetMeasure.CADENCE, None, 110)
TOES = Target(TargetMeasure.FOOT_STRIKE, Side.RIGHT, -5)


@pytest.mark.parametrize(("value", "shown", "is_reached"), [(54.4, 54, False), (54.5, 55, True), (55.0, 55, True)])
def test_a_target_is_reached_where_the_shown_number_reaches_it(value: float, shown: int, is_reached: bool) -> None:
    assert shown_value(value) == shown
    assert KNEE.is_reached(shown_value(value)) is is_reached


@pytest.mark.parametrize(("value", "shown"), [(-0.5, 0), (-0.6, -1), (-5.5, -5)])
def test_halves_go_up_on_either_side_of_zero(value: float, shown: int) -> None:
    assert shown_value(value) == shown


def test_tallies_come_back_from_a_note_that_states_other_things_too() -> None:
    tallies = (TargetTally(KNEE, 41, 60), TargetTally(BEAT, 0, 7), TargetTally(TOES, 3, 3))
    note = with_tallies("Walked with a stick.", tallies)
    assert note.splitlines()[:2] == ["Walked with a stick.", "target knee_swing_peak left 55 deg: 41 of 60 strides"]
    assert tallies_of(note) == tallies


def test_a_target_without_strides_is_not_noted() -> None:
    assert with_tallies("", [TargetTally(KNEE, 0, 0)]) == ""
    assert with_tallies("as before", []) == "as before"


@pytest.mark.parametrize(
    "line",
    [
        "target knee_swing_peak left 55 deg: 61 of 60 strides",  # more than there were
        "target knee_swing_peak both 55 deg: 6 of 60 strides",  # of no leg
        "target cadence left 110 steps/min: 6 of 60 strides",  # of one leg
        "target knee_swing_peak left 55 %: 6 of 60 strides",
        "target hip left 55 deg: 6 of 60 strides",
        "target knee_swing_peak left 55 deg: 0 of 0 strides",
        "the target knee_swing_peak left 55 deg: 6 of 60 strides",
    ],
)
def test_a_line_that_states_something_else_is_no_tally(line: str) -> None:
    assert tallies_of(line) == ()
