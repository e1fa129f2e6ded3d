"""A change of a prosthesis is stated with its direction in words, and what undoes it as it is to be done."""

import pytest
from syrupy.assertion import SnapshotAssertion

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


KNEE = ProsthesisPart.KNEE_UNIT
TO_WALK_2 = PartChange(KNEE, program_before="Walk 1", program="Walk 2")
TO_50 = PartChange(KNEE, setting="Swing flexion", setting_before=45.0, setting_value=50.0)
PARTS = {
    "an anterior screw out": PartChange(FRONT, angle_deg=-1.5),
    "a foot turned": PartChange(ProsthesisPart.FOOT_ROTATION, angle_deg=-3.0),
    "an outer screw": PartChange(ProsthesisPart.SOCKET_OUTER_SCREW, angle_deg=1.0),
    "an inner screw": PartChange(ProsthesisPart.SOCKET_INNER_SCREW, shift_mm=-2.0),
    "a knee has no direction": PartChange(KNEE, angle_deg=-1.0),
    "a program": TO_WALK_2,
    "a program that was not recorded": PartChange(KNEE, program="Walk 2"),
    "a setting": TO_50,
    "a setting below nought": PartChange(KNEE, setting="Stance", setting_before=0.5, setting_value=-2.5),
    "a setting that was not recorded": PartChange(KNEE, setting="Stance", setting_value=0.0),
    "settings of a foot are the foot's and no screw's": PartChange(
        ProsthesisPart.FOOT, setting="Heel", setting_before=3.0, setting_value=4.0, shift_mm=2.0
    ),
}


def stated(change: AlignmentChange | None) -> dict[str, object]:
    undone = undoing(net_of(change.parts)) if change is not None else ()
    return {
        "line by line": change_lines(change),
        "in a row": change_in_words(change),
        "since when": since_in_words(change),
        "to undo": to_do_in_words(undone),
    }


def test_a_change_is_stated_with_its_directions_and_what_undoes_it(snapshot: SnapshotAssertion) -> None:
    again = AlignmentChange("Alignment B", (PartChange(ProsthesisPart.PYLON, height_mm=-3.0),), "Alignment A")
    changes = {
        "several": B,
        "none": None,
        "a return": again,
        "a return, nothing was done": AlignmentChange("Alignment B", (), "Alignment A"),
    }
    changes |= {case: AlignmentChange("A", (part,)) for case, part in PARTS.items()}
    assert {case: stated(change) for case, change in changes.items()} == snapshot


def test_what_is_to_be_done_to_return_turns_every_direction_round() -> None:
    back = changed_between({"Alignment A": None, "Alignment B": B}, "Alignment B", "Alignment A")
    assert back is not None
    stated = "Foot, anterior screw ½ turn in; foot 4 mm anterior; pylon \N{MINUS SIGN}3 mm; pylon: undo: new clamp"
    assert to_do_in_words(back) == stated


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


def test_turns_are_eighths() -> None:
    assert [turns_words(turns) for turns in (0.125, -0.375, 1.25, -2.0)] == ["⅛ out", "⅜ in", "1¼ out", "2 in"]


def test_two_versions_of_a_change_are_stated_as_the_pages_say_it() -> None:
    """When two stations changed it, both stand side by side."""
    field = "alignment"
    value = recording_fields(Recording("walk 1", RecordingKind.WALKING, "", {}, alignment=B))[field]
    assert field_word(field) == "Alignment change"
    assert value_words(field, value) == since_in_words(B)
    assert value_words(field, "") == "not recorded"
