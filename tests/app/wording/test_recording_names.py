"""A walk is called the same everywhere: by its condition and the letter that represents this in every comparison."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from syrupy.assertion import SnapshotAssertion

from app.summary.visits import condition_in_words
from app.wording.patients import aids_in_words
from app.wording.recordings import (
    LETTERS,
    ShownName,
    condition_letters,
    is_alignment,
    label_again,
    name_in_words,
    shown_names,
    where_shown,
    with_shown_names,
)
from app.wording.translation import use_language
from core.alignment import AlignmentChange
from core.findings import Finding, Severity
from core.session import Recording, RecordingKind


def walk(number: int, condition: str = "", *, is_kept: bool = True, is_restrapped_before: bool = False) -> Recording:
    recording = Recording(f"walk {number}", RecordingKind.WALKING, "", {}, condition)
    return replace(recording, is_kept=is_kept, is_restrapped_before=is_restrapped_before)


def called(*recordings: Recording) -> list[str]:
    return [str(name) for name in shown_names(recordings).values()]


def returned(number: int, condition: str, to: str, since: str = "Alignment B") -> Recording:
    return replace(walk(number, condition), alignment=AlignmentChange(since, (), returns_to=to))


def test_a_walk_is_called_by_letter_and_condition(snapshot: SnapshotAssertion) -> None:
    standing = Recording("standing", RecordingKind.STANDING, "", {})
    motion = Recording("free motion 2", RecordingKind.FREE_MOTION, "", {})
    excluded = walk(1, "Barefoot", is_kept=False), walk(3, "Shoes", is_kept=False)
    again = walk(1, "Alignment A"), walk(2, "Alignment B"), returned(3, "Alignment A again", "Alignment A")
    four = walk(1, "Barefoot"), walk(2, "Shoes"), walk(3, "Barefoot"), walk(4, "Barefoot")
    walks = {
        "two conditions": (walk(1, "Barefoot"), walk(2, "Shoes")),
        "from the second on they are numbered behind the letter": four,
        "strapped again": (walk(1, "Barefoot"), walk(2, "Barefoot", is_restrapped_before=True), walk(3, "Barefoot")),
        "excluded: no letter, no number": (excluded[0], walk(2, "Shoes"), excluded[1], walk(4, "Shoes")),
        "without a condition: its own name": (walk(1), walk(2, "Shoes")),
        "other recordings have no letter": (standing, motion, walk(1, "Shoes")),
        "a return has its letter and the next number": again,
        "a second return": (
            *again,
            walk(4, "Alignment C"),
            returned(5, "Alignment A again 2", "Alignment A", "Alignment C"),
        ),
        "what only sounds like a return": (walk(1, "Alignment A"), walk(2, "Alignment A again")),
    }
    assert {case: called(*those) for case, those in walks.items()} == snapshot
    assert shown_names([walk(1)])["walk 1"].letter == "A"
    assert list(condition_letters(four).values()) == ["A", "B", "A", "A"]
    assert list(condition_letters(again).values()) == ["A", "B", "A"]


def test_no_two_kept_walks_are_called_the_same_when_letters_have_run_out() -> None:
    many = [walk(number, f"foot {number // 2}") for number in range(2 * len(LETTERS) + 6)]
    names = called(*many)
    assert len(set(names)) == len(names)
    assert names[-2:] == ["foot 28", "foot 28 2"]


@pytest.mark.parametrize("name", ["walk", "walk 12", "standing", "free motion", "treadmill 2", "walking", ""])
def test_names_in_english_read_as_they_are(name: str) -> None:
    assert name_in_words(name) == name


def test_a_finding_states_where_it_was_found_as_the_reader_knows_it() -> None:
    names = {"walk 2": ShownName("A2", "Barefoot")}
    finding = Finding("gaps", Severity.WARNING, "left_foot, walk 2")
    assert with_shown_names(finding, names).where == "left_foot, A2 Barefoot"
    assert where_shown("walk 1, left_foot", names) == "walk 1, left_foot"


@pytest.fixture
def german() -> Iterator[None]:
    use_language("de")
    yield
    use_language("en")


@pytest.mark.usefixtures("german")
@pytest.mark.parametrize(
    ("stored", "words"),
    [
        ("Shoes", "Schuhe"),
        ("barefoot", "Barfuß"),
        ("Alignment B", "Aufbau B"),
        ("Shoes, stick", "Schuhe, Stock"),
        ("Schuhe", "Schuhe"),
        ("barfuß", "barfuß"),  # as it was typed
        ("shoes with insole", "shoes with insole"),
        ("walk 3", "Gang 3"),
    ],
)
def test_a_condition_that_we_proposed_is_read_in_german_and_one_that_was_typed_as_typed(
    stored: str, words: str
) -> None:
    assert name_in_words(stored) == words
    assert called(walk(1, stored)) == [f"A {words}"]
    assert condition_in_words(stored) == words


def test_a_condition_stored_in_german_is_read_in_english() -> None:
    assert [name_in_words(one) for one in ("Schuhe", "Barfuß", "Aufbau C", "Einlage links")] == [
        "Shoes",
        "Barefoot",
        "Alignment C",
        "Einlage links",
    ]
    assert name_in_words("shoes") == "shoes"  # as it was typed


@pytest.mark.usefixtures("german")
def test_aids_are_read_in_german_and_others_as_typed() -> None:
    assert aids_in_words("shoes, stick, AFO, rollator") == "Schuhe, Stock, Unterschenkelorthese, rollator"
    use_language("en")
    assert aids_in_words("shoes, AFO, rollator") == "shoes, AFO, rollator"


@pytest.mark.parametrize(
    ("condition", "used", "label"),
    [
        ("Alignment A", [], "Alignment A again"),
        ("Alignment A", ["alignment a again"], "Alignment A again 2"),
        ("Aufbau B", [], "Alignment B again"),  # begun in German
        ("old foot", [], "old foot again"),
        ("old foot", ["old foot again"], "old foot again 2"),
    ],
)
def test_a_return_is_called_by_what_it_returns_to(condition: str, used: list[str], label: str) -> None:
    assert label_again(condition, used) == label


def test_alignments_are_known_by_their_labels_in_each_language() -> None:
    labels = ("Alignment A", "Aufbau C", "Alignment A again", "Aufbau A erneut 3", "Shoes", "alignment of mine")
    assert [is_alignment(label) for label in labels] == [True, True, True, True, False, False]


@pytest.mark.usefixtures("german")
def test_a_return_is_read_in_german() -> None:
    assert name_in_words("Alignment A again") == "Aufbau A erneut"
    assert name_in_words("Alignment B again 2") == "Aufbau B erneut 2"
    assert label_again("Alignment A", []) == "Aufbau A erneut"
