"""A change of a prosthesis is stated with its direction in words, and what undoes it as it is to be done."""

import pytest

from app.editing.words import field_word, value_words
from app.storage.edited_fields import recording_fields
from app.wording.alignment import (
    as_entered,
    change_in_words,
    change_lines,
    since_in_words,
    to_do_in_words,
    turns_words,
)
from core.alignment import (
    AlignmentChange,
    NetChange,
    PartChange,
    ProsthesisPart,
    changed_between,
    net_of,
    undoing,
)
from core.session import Recording, RecordingKind

FRONT = ProsthesisPart.FOOT_FRONT_SCREW
B = AlignmentChange(
    "Alignment A",
    (
        PartChange(FRONT, angle_deg=2.0, turns=0.5, shift_mm=4.0),
        PartChange(ProsthesisPart.PYLON, height_mm=3.0, text="new clamp"),
    ),
)


def test_a_list_states_each_thing_that_was_done() -> None:
    assert change_lines(B) == [
        ("Foot, anterior screw", "½ out, +2° plantar"),
        ("Foot, shift", "4 mm posterior"),
        ("Pylon, height", "+3 mm"),
        ("Pylon", "new clamp"),
    ]
    assert change_lines(None) == []


def test_a_line_states_it_in_a_row_and_since_when() -> None:
    line = "Foot, anterior screw ½ turn out, +2° plantar; foot 4 mm posterior; pylon +3 mm; pylon: new clamp"
    assert change_in_words(B) == line
    assert since_in_words(B) == f"Changed from Alignment A: {line}"
    assert (change_in_words(None), since_in_words(None)) == ("", "")


def test_what_is_to_be_done_to_return_turns_every_direction_round() -> None:
    back = changed_between({"Alignment A": None, "Alignment B": B}, "Alignment B", "Alignment A")
    assert back is not None
    stated = "Foot, anterior screw ½ turn in; foot 4 mm anterior; pylon \N{MINUS SIGN}3 mm; pylon: undo: new clamp"
    assert to_do_in_words(back) == stated


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (PartChange(FRONT, angle_deg=-1.5), "+1.5° dorsal"),
        (PartChange(ProsthesisPart.FOOT_ROTATION, angle_deg=-3.0), "+3° toe-in"),
        (PartChange(ProsthesisPart.SOCKET_OUTER_SCREW, angle_deg=1.0), "+1° abduction"),
        (PartChange(ProsthesisPart.SOCKET_INNER_SCREW, shift_mm=-2.0), "2 mm medial"),
        (PartChange(ProsthesisPart.KNEE_UNIT, angle_deg=-1.0), "\N{MINUS SIGN}1°"),
    ],
)
def test_each_part_has_directions_of_its_own(change: PartChange, words: str) -> None:
    ((_, stated),) = change_lines(AlignmentChange("", (change,)))
    assert stated == words


KNEE = ProsthesisPart.KNEE_UNIT
TO_WALK_2 = PartChange(KNEE, program_before="Walk 1", program="Walk 2")
TO_50 = PartChange(KNEE, setting="Swing flexion", setting_before=45.0, setting_value=50.0)


@pytest.mark.parametrize(
    ("change", "words", "to_undo"),
    [
        (TO_WALK_2, "program Walk 2, was Walk 1", "set program Walk 1 again"),
        (TO_50, "Swing flexion 50, was 45", "set Swing flexion to 45 again"),
        (
            PartChange(KNEE, program="Walk 2"),
            "program Walk 2",
            "set program back from Walk 2; what it was is not recorded",
        ),
        (
            PartChange(KNEE, setting="Stance", setting_before=0.5, setting_value=-2.5),
            "Stance −2.5, was 0.5",
            "set Stance to 0.5 again",
        ),
        (
            PartChange(KNEE, setting="Stance", setting_value=0.0),
            "Stance 0",
            "set Stance back from 0; what it was is not recorded",
        ),
    ],
)
def test_a_program_and_a_setting_are_stated_with_what_they_were_and_are_set_again(
    change: PartChange, words: str, to_undo: str
) -> None:
    assert change_lines(AlignmentChange("A", (change,))) == [("Knee unit", words)]
    assert change_in_words([change]) == f"Knee unit: {words}"
    assert to_do_in_words(undoing(net_of([change]))) == f"Knee unit: {to_undo}"


def test_settings_of_a_foot_are_the_foots_and_no_screws() -> None:
    foot = PartChange(ProsthesisPart.FOOT, setting="Heel", setting_before=3.0, setting_value=4.0, shift_mm=2.0)
    assert change_in_words([foot]) == "Foot 2 mm posterior; foot: Heel 4, was 3"


@pytest.mark.parametrize(
    "net",
    [
        net_of([TO_WALK_2, TO_50, PartChange(FRONT, turns=0.5, text="tight")]),
        undoing(net_of([TO_WALK_2, TO_50, PartChange(KNEE, program="Stairs")])),
        (NetChange(FRONT, angle_deg=-70.5, shift_mm=100.0, turns=13.0),),  # beyond what is entered at once
        undoing(net_of([PartChange(KNEE, setting="Stance", setting_value=5.0)])),
    ],
)
def test_what_leads_back_can_be_entered_and_comes_to_the_same(net: tuple[NetChange, ...]) -> None:
    assert net_of(as_entered(net)) == net


def test_what_is_undone_in_words_is_entered_in_words() -> None:
    (entered,) = as_entered(undoing(net_of([PartChange(KNEE, text="new clamp")])))
    assert entered == PartChange(KNEE, text="undo: new clamp")


def test_a_return_is_stated_as_one() -> None:
    again = AlignmentChange("Alignment B", (PartChange(ProsthesisPart.PYLON, height_mm=-3.0),), "Alignment A")
    assert since_in_words(again) == "Back to Alignment A: Pylon −3 mm"
    assert since_in_words(AlignmentChange("Alignment B", (), "Alignment A")) == "Back to Alignment A"


def test_turns_are_eighths() -> None:
    assert [turns_words(turns) for turns in (0.125, -0.375, 1.25, -2.0)] == ["⅛ out", "⅜ in", "1¼ out", "2 in"]


def test_two_versions_of_a_change_are_stated_as_the_pages_say_it() -> None:
    """When two stations changed it, both stand side by side."""
    field = "alignment"
    value = recording_fields(Recording("walk 1", RecordingKind.WALKING, "", {}, alignment=B))[field]
    assert field_word(field) == "Alignment change"
    assert value_words(field, value) == since_in_words(B)
    assert value_words(field, "") == "not recorded"
