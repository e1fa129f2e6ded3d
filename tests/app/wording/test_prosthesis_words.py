"""A prosthesis is named by what is stated of it, and by its side alone where nothing else is."""

import pytest
from syrupy.assertion import SnapshotAssertion

from app.editing.words import field_word, value_words
from app.storage.edited_fields import patient_fields
from app.wording.patients import about_and_device, person
from app.wording.prostheses import prosthesis_words, worn_words
from app.wording.translation import use_language
from core.body import JointKind, Side
from core.prosthesis import NOT_STATED, AmputationLevel, FootKind, KneeKind, Prosthesis
from core.session import Patient

TRANSTIBIAL = Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)
TRANSFEMORAL = Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.FLUID_CONTROLLED, FootKind.SACH)
STATED = Patient(birth_year=1960, sex="female", prosthetic_side="left", prostheses={Side.LEFT: TRANSTIBIAL})


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_prosthesis_is_named_by_its_level_then_knee_and_foot(language: str, snapshot: SnapshotAssertion) -> None:
    one_by_one = {
        "foot": TRANSTIBIAL,
        "knee and foot": TRANSFEMORAL,
        "no level": Prosthesis(foot=FootKind.SACH),
        "nothing but its level": Prosthesis(AmputationLevel.PARTIAL_FOOT),
    }
    use_language(language)
    try:
        assert {case: prosthesis_words(Side.LEFT, one) for case, one in one_by_one.items()} == snapshot
    finally:
        use_language("en")


@pytest.mark.parametrize("level", AmputationLevel)
@pytest.mark.parametrize("language", ["en", "de"])
def test_every_kind_has_words_of_its_own(level: AmputationLevel, language: str) -> None:
    use_language(language)
    try:
        knees = [None, *KneeKind] if level.replaces(JointKind.KNEE) else [None]
        feet = [None, *FootKind] if level.replaces(JointKind.ANKLE) else [None]
        named = {prosthesis_words(Side.RIGHT, Prosthesis(level, knee, foot)) for knee in knees for foot in feet}
        assert len(named) == len(knees) * len(feet)
    finally:
        use_language("en")


def test_a_patient_is_listed_by_what_is_worn_and_by_the_side_where_that_is_not_stated(
    snapshot: SnapshotAssertion,
) -> None:
    right, unstated = {Side.RIGHT: TRANSFEMORAL}, {Side.RIGHT: NOT_STATED}
    patients = {
        "left": STATED,
        "both, the right one is stated": Patient(prosthetic_side="both", prostheses=right),
        "both, neither is stated": Patient(prosthetic_side="both", prostheses=unstated),
        "none is worn": Patient(prosthetic_side="none", prostheses=right),
        "the side alone": Patient(prosthetic_side="left"),
        "affected": Patient(affected_side="left", prostheses={Side.LEFT: TRANSTIBIAL}),
    }
    assert {
        case: {
            "worn": worn_words(one),
            "in short": worn_words(one, is_whole=False),
            "listed": person(one),
            "with device": about_and_device(one),
        }
        for case, one in patients.items()
    } == snapshot


def test_who_is_asked_between_two_prostheses_reads_both_in_words() -> None:
    fields = patient_fields(STATED)
    assert field_word("prosthesis.left") == "Prosthesis, left"
    assert value_words("prosthesis.left", fields["prosthesis.left"]) == "Transtibial prosthesis, energy-storing foot"
    assert value_words("prosthesis.right", fields["prosthesis.right"]) == "not recorded"
