"""Labels of walks: the usual ones with their digits, one's own kept, letters in the order of walking."""

from app.wizard.walking.walk_labels import MOST, label_after, labels_for, stored_label
from app.wording.recordings import is_alignment
from app.wording.translation import use_language
from core.session import Patient

ANYBODY, PROSTHETIC = Patient(), Patient(prosthetic_side="left")


def test_a_prosthesis_is_aligned() -> None:
    assert labels_for(PROSTHETIC, [])[:3] == ("Alignment A", "Alignment B", "Alignment C")
    assert labels_for(ANYBODY, []) == ("Barefoot", "Shoes", "AFO", "Alignment A")


def test_own_words_are_offered_again() -> None:
    assert labels_for(ANYBODY, ["new foot", "new foot"])[-1] == "new foot"
    many = [f"foot {k}" for k in range(12)]
    assert len(labels_for(ANYBODY, many)) == MOST
    assert labels_for(ANYBODY, many)[-1] == "foot 11"


def test_there_is_always_a_further_alignment() -> None:
    used = [f"Alignment {letter}" for letter in "ABC"]
    assert "Alignment D" in labels_for(PROSTHETIC, used)
    assert label_after(PROSTHETIC, used) == "Alignment D"


def test_the_next_walk_is_called_as_the_last_one() -> None:
    assert label_after(PROSTHETIC, []) == "Alignment A"
    assert label_after(PROSTHETIC, ["Shoes"]) == "Shoes"
    assert label_after(Patient(aids="barefoot"), []) == "Barefoot"
    assert label_after(ANYBODY, []) == "Shoes"


def test_a_session_begun_in_english_goes_on_in_german_with_the_same_conditions() -> None:
    use_language("de")
    try:
        assert labels_for(ANYBODY, ["Shoes", "new foot"]) == (
            "Barfuß", "Schuhe", "Unterschenkelorthese", "Aufbau A", "new foot",
        )  # fmt: skip
        assert stored_label("Schuhe", ["Shoes", "new foot"]) == "Shoes"  # as the walks before, to be compared with
        assert stored_label("Barfuß", ["Shoes"]) == "Barfuß"
        assert label_after(ANYBODY, ["Shoes"]) == "Shoes"
        assert label_after(PROSTHETIC, ["Alignment A"]) == "Aufbau B"
        assert is_alignment("Alignment A")
        assert not is_alignment("Shoes")
    finally:
        use_language("en")
