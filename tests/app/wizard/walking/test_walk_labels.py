"""Labels of walks: the usual ones with their digits, one's own kept, letters in the order of walking."""

from app.wizard.walking.walk_labels import MOST, label_after, labels_for
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
