"""Changes of a prosthesis add up along a chain, are undone whole, and nothing implausible is taken for one."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.alignment import (
    AlignmentChange,
    NetChange,
    PartChange,
    ProsthesisPart,
    Switched,
    added,
    alignment_of_table,
    alignment_of_text,
    alignment_table,
    alignment_text,
    changed_between,
    net_of,
    root_of,
    undoing,
)

FRONT, PYLON, FOOT = ProsthesisPart.FOOT_FRONT_SCREW, ProsthesisPart.PYLON, ProsthesisPart.FOOT_BACK_SCREW
CHAIN = {
    "A": None,
    "B": AlignmentChange("A", (PartChange(FRONT, turns=0.5, angle_deg=2.0), PartChange(PYLON, height_mm=3.0))),
    "C": AlignmentChange("B", (PartChange(FRONT, turns=-0.25, text="wedge"), PartChange(FOOT, shift_mm=4.0))),
    "D": AlignmentChange("A", (PartChange(PYLON, height_mm=-2.0),)),
}


@st.composite
def changes(draw: st.DrawFn) -> PartChange:
    eighths, half_degrees = draw(st.integers(-96, 96)), draw(st.integers(-60, 60))
    shift, height = draw(st.integers(-60, 60)), draw(st.integers(-100, 100))
    text = draw(st.sampled_from(["x", "wedge", "new \N{SNOWMAN}"]))
    part = draw(st.sampled_from(list(ProsthesisPart)))
    return PartChange(part, half_degrees / 2, eighths / 8, float(shift), float(height), text)


CHANGES = st.lists(changes(), min_size=1, max_size=6)


@given(CHANGES, CHANGES)
def test_what_undoes_changes_leaves_nothing_of_them(first: list[PartChange], second: list[PartChange]) -> None:
    net = net_of([*first, *second])
    assert added(*net, *undoing(net)) == ()
    assert added(*net_of(first), *net_of(second)) == net
    assert undoing(undoing(net)) == net


KNEE = ProsthesisPart.KNEE_UNIT
STATES = st.lists(st.one_of(st.none(), st.sampled_from(["Walk 1", "Walk 2", "Stairs"])), min_size=2, max_size=6)
VALUES = st.lists(st.one_of(st.none(), st.integers(-100, 100).map(float)), min_size=2, max_size=6)


def in_turn(programs: list[str | None], values: list[float | None]) -> list[PartChange]:
    """Changes of which each begins where the one before has ended."""
    found = [
        PartChange(KNEE, program_before=one or "", program=other or "")
        for one, other in pairwise(programs)
        if one or other
    ]
    found += [
        PartChange(KNEE, setting="Swing flexion", setting_before=one, setting_value=other)
        for one, other in pairwise(values)
        if (one, other) != (None, None)
    ]
    return found


@given(STATES, VALUES)
def test_of_programs_and_settings_the_first_state_and_the_last_count(
    programs: list[str | None], values: list[float | None]
) -> None:
    net = net_of(in_turn(programs, values))
    switched = {one.name: (one.before, one.after) for change in net for one in change.switched}
    expected = {"": (programs[0], programs[-1]), "Swing flexion": (values[0], values[-1])}
    assert switched == {name: (one, other) for name, (one, other) in expected.items() if one != other}
    assert added(*net, *undoing(net)) == ()


def test_the_way_back_from_a_setting_that_was_changed_twice_leads_to_its_first_value() -> None:
    parts = in_turn(["Walk 1", "Walk 2", "Stairs"], [10.0, 20.0, 30.0])
    back = changed_between({"A": None, "B": AlignmentChange("A", tuple(parts))}, "B", "A")
    assert back == (
        NetChange(KNEE, switched=(Switched("", "Stairs", "Walk 1"), Switched("Swing flexion", 30.0, 10.0))),
    )


def test_a_program_is_undone_by_the_one_before_however_it_was_typed() -> None:
    to_2 = PartChange(KNEE, program_before="Walk 1", program="Walk 2", setting="Stance", setting_value=5.0)
    back = PartChange(KNEE, program_before="walk 2", program="WALK 1", setting="stance ", setting_before=5.0)
    (done,) = net_of([to_2])
    assert done.switched == (Switched("", "Walk 1", "Walk 2"), Switched("Stance", None, 5.0))
    assert undoing([done])[0].switched == (Switched("", "Walk 2", "Walk 1"), Switched("Stance", 5.0, None))
    assert net_of([to_2, back]) == ()


def test_a_setting_of_zero_is_a_value_and_comes_back_from_a_file() -> None:
    reported = AlignmentChange("A", (PartChange(KNEE, setting="Step", setting_before=0.0, setting_value=2.0),))
    assert alignment_table(reported) == {
        "since": "A",
        "parts": [{"part": "knee_unit", "setting": "Step", "setting_before": 0.0, "setting_value": 2.0}],
    }
    assert alignment_of_text(alignment_text(reported)) == reported


def test_what_returns_is_the_earlier_condition_again() -> None:
    """Whatever is stated of how it was undone, and with what lay between excluded."""
    again = AlignmentChange("C", (PartChange(PYLON, height_mm=-3.0),), returns_to="A")
    chain = CHAIN | {"A again": again, "E": AlignmentChange("A again", (PartChange(PYLON, height_mm=1.0),))}
    assert changed_between(chain, "A", "A again") == ()
    back = NetChange(FRONT, angle_deg=-2.0, turns=-0.5), NetChange(PYLON, height_mm=-2.0)
    assert changed_between(chain, "B", "E") == back
    assert changed_between({"A": None, "A again": again}, "A again", "A") == ()
    assert [root_of(chain, one) for one in ("E", "A again", "C", "A", "X")] == ["A", "A", "A", "A", "X"]
    for reported in (again, AlignmentChange("C", (), returns_to="A")):
        assert alignment_of_text(alignment_text(reported)) == reported


def test_what_earlier_versions_wrote_reads_as_it_did() -> None:
    text = '{"since":"A","parts":[{"part":"knee_unit","turns":0.5,"text":"program 2"}]}'
    reported = alignment_of_text(text)
    assert reported == AlignmentChange("A", (PartChange(KNEE, turns=0.5, text="program 2"),))
    assert alignment_text(reported) == text
    assert net_of(reported.parts)[0].switched == ()


@settings(max_examples=40)
@given(CHANGES, st.text(max_size=20))
def test_a_change_comes_back_from_a_file_and_from_a_row(parts: list[PartChange], since: str) -> None:
    reported = AlignmentChange(since, tuple(parts))
    assert alignment_of_table(alignment_table(reported)) == reported
    assert alignment_of_text(alignment_text(reported)) == reported


def test_the_way_back_undoes_the_last_first_and_sums_what_one_screw_was_turned() -> None:
    back = changed_between(CHAIN, "C", "A")
    assert back == (
        NetChange(FRONT, angle_deg=-2.0, turns=-0.25, undone=("wedge",)),
        NetChange(FOOT, shift_mm=-4.0),
        NetChange(PYLON, height_mm=-3.0),
    )
    assert changed_between(CHAIN, "A", "B") == net_of(CHAIN["B"].parts if CHAIN["B"] else ())
    assert changed_between(CHAIN, "B", "B") == ()


def test_two_branches_meet_where_they_part() -> None:
    assert changed_between(CHAIN, "B", "D") == (
        NetChange(FRONT, angle_deg=-2.0, turns=-0.5),
        NetChange(PYLON, height_mm=-5.0),
    )


def test_what_no_chain_ties_is_not_known_and_a_ring_ends() -> None:
    assert changed_between(CHAIN | {"X": None}, "A", "X") is None
    ring = {name: AlignmentChange(since, (PartChange(PYLON, height_mm=1.0),)) for name, since in ("PQ", "QP")}
    assert changed_between(ring | {"A": None}, "P", "A") is None
    assert changed_between({}, "gone", "A") is None


@pytest.mark.parametrize(
    "wrong",
    [
        {"angle_deg": 0.3},
        {"angle_deg": 30.5},
        {"angle_deg": float("nan")},
        {"turns": 0.1},
        {"turns": 12.125},
        {"shift_mm": 1.5},
        {"shift_mm": -61.0},
        {"height_mm": 101.0},
        {"height_mm": float("inf")},
        {"text": "x" * 201},
        {"text": "  "},
        {"program": "x" * 41},
        {"setting": "Swing flexion"},
        {"setting_value": 50.0},
        {"setting": "Swing flexion", "setting_value": 10000.0},
        {"setting": "Swing flexion", "setting_value": float("nan")},
        {"program": " "},
        {},
    ],
)
def test_what_is_off_its_step_beyond_its_limit_or_states_nothing_is_no_change(wrong: dict[str, float | str]) -> None:
    with pytest.raises(ValueError, match=r"expected|nothing is stated"):
        PartChange(PYLON, **wrong)  # type: ignore[arg-type]  # as the cases have them


@pytest.mark.parametrize(
    "other",
    [
        None,
        5,
        "",
        [],
        {"since": "A"},
        {"since": 1, "parts": [{"part": "pylon", "height_mm": 3}]},
        {"since": "A", "parts": []},
        {"since": "A", "parts": "pylon"},
        {"since": "A", "parts": [{"part": "pylon", "height_mm": True}]},
        {"since": "A", "parts": [{"part": "hip", "height_mm": 3}]},
        {"since": "A", "parts": [{"part": "pylon", "height_mm": 3, "colour": "red"}]},
        {"since": "A", "parts": [{"part": "pylon", "text": 3}]},
        {"since": "A", "parts": [{"part": "pylon", "height_mm": 3}] * 21},
        {"since": "A", "parts": [{"part": "pylon", "height_mm": 10**400}]},
        {"since": "A", "parts": [{"part": "knee_unit", "program": 2}]},
        {"since": "A", "parts": [{"part": "knee_unit", "setting": "x", "setting_value": "50"}]},
        {"since": "A", "parts": [{"part": "knee_unit", "setting": "x", "setting_value": True}]},
        {"since": "A", "parts": [], "returns_to": ""},
        {"since": "A", "parts": [], "returns_to": 1},
        {"since": "A", "parts": [{"part": "pylon", "height_mm": 3}], "back": "A"},
    ],
)
def test_what_others_have_written_is_none_of_ours(other: object) -> None:
    assert alignment_of_table(other) is None


def test_no_text_is_taken_for_a_change() -> None:
    assert [alignment_of_text(text) for text in ("", "{", "[]", '"x"')] == [None] * 4
