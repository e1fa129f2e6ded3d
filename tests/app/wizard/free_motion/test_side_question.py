"""An answer ends the question, is shown and can be undone; what contradicts an earlier one is asked again."""

import pytest

from app.wizard.free_motion.side_question import SILENT, SideQuestion
from core.body import Side
from core.placement.arrangements import Stature
from core.placement.chains import Chain, Chains

SIDES = ("Left", "Right")


def chains(*shanks: str, lead_s: float | None = 0.1) -> Chains:
    """Legs whose thigh and foot are called after the shank."""
    legs = [Chain(f"{shank} thigh", shank, f"{shank} foot", 9.0, 9.0, Stature(0.5, 9.0), 1.0) for shank in shanks]
    return Chains(tuple(legs), 9.0, lead_s)


def asked(*shanks: str, earlier: dict[str, Side] | None = None, lead_s: float | None = 0.1) -> SideQuestion:
    question = SideQuestion()
    question.look(chains(*shanks, lead_s=lead_s), earlier or {})
    return question


@pytest.mark.parametrize(
    ("shanks", "lead_s", "is_stated"), [(("A", "B"), 0.1, True), (("A", "B"), None, False), (("A",), None, False)]
)
def test_both_legs_moved_at_once_is_stated_only_where_both_moved(
    shanks: tuple[str, ...], lead_s: float | None, is_stated: bool
) -> None:
    what, _, answers = asked(*shanks, lead_s=lead_s).words
    assert ("Both legs moved at once" in what) is is_stated
    assert "has A on the shank?" in what
    assert answers == SIDES


def test_an_answer_ends_the_question_and_a_second_press_is_no_answer() -> None:
    question = asked("A", "B")
    question.answer(1)
    for _ in range(5):
        question.look(chains("A", "B"), {})
    assert question.reported == ("A", Side.RIGHT)
    assert question.words == ("A is now assigned to the right leg.", "", ("Undo",))
    question.look(chains("B", "A"), {})  # the search puts another leg first
    assert question.reported == ("A", Side.RIGHT)


def test_what_was_understood_is_undone_and_asked_again() -> None:
    question = asked("A", "B", earlier={"A": Side.RIGHT})
    question.answer(1)
    question.answer(1)
    assert question.reported is None
    assert question.words[2] == SIDES
    question.withdraw()  # the motion has been placed by the answer meanwhile
    assert question.words[2] == SIDES
    question.answer(0)  # who undoes has stated that the earlier one was wrong
    assert question.reported == ("A", Side.LEFT)


@pytest.mark.parametrize("second", [0, 1])
def test_an_answer_that_contradicts_an_earlier_one_is_asked_again(second: int) -> None:
    question = asked("A", "B", earlier={"A": Side.RIGHT})
    question.answer(0)
    assert question.reported is None
    assert question.words == ("A was on the right leg before. Which leg is it on now?", "", SIDES)
    question.look(chains("A", "B"), {"A": Side.RIGHT})
    question.answer(second)
    assert question.reported == ("A", (Side.LEFT, Side.RIGHT)[second])


@pytest.mark.parametrize("earlier", [{}, {"A": Side.LEFT}, {"B": Side.LEFT}])
def test_an_answer_that_contradicts_nothing_is_taken_at_once(earlier: dict[str, Side]) -> None:
    question = asked("A", "B", earlier=earlier)
    question.answer(0)
    assert question.reported == ("A", Side.LEFT)


def test_what_the_motion_shows_itself_is_asked_no_longer() -> None:
    question = asked("A", "B")
    question.withdraw()
    assert question.words == SILENT


def test_a_leg_that_nobody_was_asked_about_is_asked_about() -> None:
    question = asked("A", "B")
    question.answer(0)
    question.look(chains("C", "D"), {})
    assert question.reported is None
    assert "has C on the shank?" in question.words[0]
