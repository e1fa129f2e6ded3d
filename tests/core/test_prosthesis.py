"""Tests of what a stated prosthesis makes of the joints of its side, and that it is kept as it was written."""

from typing import Any

import pytest

from core.body import Joint, JointKind, Side
from core.prosthesis import (
    NOT_STATED,
    AmputationLevel,
    FootKind,
    JointNature,
    KneeKind,
    Prosthesis,
    prostheses_of_tables,
    prostheses_of_text,
    prostheses_tables,
    prostheses_text,
)
from core.session import Patient

KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
OWN, PROSTHETIC, RIGID = JointNature.OWN, JointNature.PROSTHETIC, JointNature.RIGID
EVERY = [
    Prosthesis(level, knee, foot)
    for level in (None, *AmputationLevel)
    for knee in (None, *KneeKind)
    for foot in (None, *FootKind)
    if (knee is None or (level is not None and level.replaces(JointKind.KNEE)))
    and (foot is None or level is not AmputationLevel.PARTIAL_FOOT)
]


def left(prosthesis: Prosthesis, prosthetic_side: str = "left") -> Patient:
    return Patient(prosthetic_side=prosthetic_side, prostheses={Side.LEFT: prosthesis})


@pytest.mark.parametrize(
    ("level", "hip", "knee", "ankle"),
    [
        (None, PROSTHETIC, PROSTHETIC, PROSTHETIC),
        (AmputationLevel.PARTIAL_FOOT, OWN, OWN, OWN),
        (AmputationLevel.ANKLE_DISARTICULATION, OWN, OWN, PROSTHETIC),
        (AmputationLevel.TRANSTIBIAL, OWN, OWN, PROSTHETIC),
        (AmputationLevel.KNEE_DISARTICULATION, OWN, PROSTHETIC, PROSTHETIC),
        (AmputationLevel.TRANSFEMORAL, OWN, PROSTHETIC, PROSTHETIC),
        (AmputationLevel.HIP_DISARTICULATION, PROSTHETIC, PROSTHETIC, PROSTHETIC),
    ],
)
def test_the_level_decides_which_joints_are_the_patient_s(
    level: AmputationLevel | None, hip: JointNature, knee: JointNature, ankle: JointNature
) -> None:
    patient = left(Prosthesis(level))
    assert tuple(map(patient.nature_of, (Joint.LEFT_HIP, KNEE, ANKLE))) == (hip, knee, ankle)
    assert patient.nature_of(Joint.RIGHT_KNEE) is JointNature.NOT_STATED


@pytest.mark.parametrize("foot", FootKind)
def test_a_foot_without_a_joint_is_no_ankle(foot: FootKind) -> None:
    is_rigid = foot in (FootKind.SACH, FootKind.ENERGY_STORING)
    patient = left(Prosthesis(AmputationLevel.TRANSTIBIAL, foot=foot))
    assert patient.nature_of(ANKLE) is (RIGID if is_rigid else PROSTHETIC)
    assert patient.without_ankle(()) == ({Side.LEFT} if is_rigid else set())
    assert patient.without_ankle(set(Side)) == ({Side.LEFT, Side.RIGHT} if is_rigid else {Side.RIGHT})


def test_of_a_foot_of_no_stated_kind_what_was_answered_holds() -> None:
    for patient in (Patient(prosthetic_side="left"), left(Prosthesis(AmputationLevel.TRANSTIBIAL)), Patient()):
        assert patient.without_ankle({Side.LEFT}) == {Side.LEFT}
        assert patient.without_ankle(()) == set()


@pytest.mark.parametrize("side", ["right", "none", ""])
def test_what_is_stated_of_a_side_that_wears_nothing_means_nothing(side: str) -> None:
    patient = left(Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.SACH), side)
    assert patient.worn == {}
    assert patient.nature_of(KNEE) is JointNature.NOT_STATED
    assert patient.without_ankle(()) == set()


@pytest.mark.parametrize(
    "parts",
    [
        {"knee": KneeKind.LOCKED},
        {"level": AmputationLevel.TRANSTIBIAL, "knee": KneeKind.LOCKED},
        {"level": AmputationLevel.PARTIAL_FOOT, "foot": FootKind.SACH},
    ],
)
def test_a_knee_below_its_level_and_a_foot_beside_the_patient_s_ankle_are_none(parts: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="but the level is"):
        Prosthesis(**parts)


@pytest.mark.parametrize("one", EVERY)
def test_what_is_stated_comes_out_of_a_file_and_a_line_as_it_was(one: Prosthesis) -> None:
    worn = {Side.RIGHT: one} if one != NOT_STATED else {}
    assert prostheses_of_tables(prostheses_tables(worn)) == (worn, None)
    assert prostheses_of_text(prostheses_text(worn)) == worn
    assert bool(prostheses_text(worn)) is (one != NOT_STATED)


@pytest.mark.parametrize(
    "text", ["", "no JSON", "3", "[]", "[" * 100_000, '{"left": 3}', '{"middle": {}}', '{"left": {"level": 1}}']
)
def test_a_line_of_something_else_states_nothing(text: str) -> None:
    assert prostheses_of_text(text) == {}


@pytest.mark.parametrize(
    ("table", "known", "rest"),
    [
        (
            {"level": "transtibial", "foot": "from the year 2040"},
            Prosthesis(AmputationLevel.TRANSTIBIAL),
            {"foot": "from the year 2040"},
        ),
        (
            {"level": "hemipelvectomy", "knee": "polycentric"},
            NOT_STATED,
            {"level": "hemipelvectomy", "knee": "polycentric"},
        ),
        (
            {"level": "transtibial", "knee": "locked", "socket": "PTB"},
            Prosthesis(AmputationLevel.TRANSTIBIAL),
            {"knee": "locked", "socket": "PTB"},
        ),
        ({"foot": True, "level": ["transtibial"]}, NOT_STATED, {"foot": True, "level": ["transtibial"]}),
    ],
)
def test_words_of_a_later_version_state_nothing_and_are_written_again(
    table: dict[str, object], known: Prosthesis, rest: dict[str, object]
) -> None:
    found, left_over = prostheses_of_tables({"left": table})
    assert found.get(Side.LEFT, NOT_STATED) == known
    assert left_over == {"left": rest}
    assert prostheses_tables(found, left_over) == {"left": table}


def test_a_word_that_was_not_understood_does_not_come_back_in_another_s_place() -> None:
    found, rest = prostheses_of_tables({"left": {"level": "transtibial", "knee": "locked", "foot": "of 2040"}})
    assert found == {Side.LEFT: Prosthesis(AmputationLevel.TRANSTIBIAL)}
    other = {Side.LEFT: Prosthesis(AmputationLevel.TRANSFEMORAL, foot=None)}
    tables = prostheses_tables(other, rest)
    assert tables == {"left": {"level": "transfemoral", "foot": "of 2040"}}
    assert prostheses_of_tables(tables)[0] == other


@pytest.mark.parametrize("tables", [3, "left", ["left"]])
def test_what_is_no_table_is_kept(tables: object) -> None:
    assert prostheses_of_tables(tables) == ({}, tables)
