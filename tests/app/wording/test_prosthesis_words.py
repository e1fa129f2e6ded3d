"""A prosthesis is named by what is stated of it, and by its side alone where nothing else is."""

import pytest

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


@pytest.mark.parametrize(
    ("one", "english", "german"),
    [
        (
            TRANSTIBIAL,
            "transtibial prosthesis left, energy-storing foot",
            "Unterschenkelprothese links, energierückgebender Fuß",
        ),
        (
            TRANSFEMORAL,
            "transfemoral prosthesis left, fluid-controlled knee, SACH foot",
            "Oberschenkelprothese links, fluidgesteuertes Kniegelenk, SACH-Fuß",
        ),
        (Prosthesis(foot=FootKind.SACH), "prosthesis left, SACH foot", "Prothese links, SACH-Fuß"),
        (Prosthesis(AmputationLevel.PARTIAL_FOOT), "partial foot prosthesis left", "Teilfußprothese links"),
    ],
)
def test_a_prosthesis_is_named_by_its_level_then_knee_and_foot(one: Prosthesis, english: str, german: str) -> None:
    assert prosthesis_words(Side.LEFT, one) == english
    use_language("de")
    try:
        assert prosthesis_words(Side.LEFT, one) == german
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


def test_both_sides_are_named_once_one_of_them_is_stated() -> None:
    both = Patient(prosthetic_side="both", prostheses={Side.RIGHT: TRANSFEMORAL})
    right = "transfemoral prosthesis right, fluid-controlled knee, SACH foot"
    assert worn_words(both) == ("prosthesis left", right)
    assert worn_words(both, is_whole=False) == ("prosthesis left", "transfemoral prosthesis right")
    assert worn_words(Patient(prosthetic_side="both", prostheses={Side.RIGHT: NOT_STATED})) == ()
    assert worn_words(Patient(prosthetic_side="none", prostheses={Side.RIGHT: TRANSFEMORAL})) == ()


def test_a_patient_is_listed_by_the_level_and_by_the_side_where_it_is_not_stated() -> None:
    assert person(STATED) == "1960, female · transtibial prosthesis left"
    assert about_and_device(STATED) == "1960, female · transtibial prosthesis left"
    assert person(Patient(prosthetic_side="left")) == "left prosthetic"
    assert person(Patient(affected_side="left", prostheses={Side.LEFT: TRANSTIBIAL})) == "left affected"


def test_who_is_asked_between_two_prostheses_reads_both_in_words() -> None:
    fields = patient_fields(STATED)
    assert field_word("prosthesis.left") == "Prosthesis, left"
    assert value_words("prosthesis.left", fields["prosthesis.left"]) == "Transtibial prosthesis, energy-storing foot"
    assert value_words("prosthesis.right", fields["prosthesis.right"]) == "not recorded"
