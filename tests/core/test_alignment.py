"""Changes of a prosthesis add up along a chain, are undone whole, and nothing implausible is taken for one."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.alignment import (
    AlignmentChange,
    NetChange,
    PartChange,
    ProsthesisPart,
    added,
    alignment_of_table,
    alignment_of_text,
    alignment_table,
    alignment_text,
    changed_between,
    net_of,
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
    ],
)
def test_what_others_have_written_is_none_of_ours(other: object) -> None:
    assert alignment_of_table(other) is None


def test_no_text_is_taken_for_a_change() -> None:
    assert [alignment_of_text(text) for text in ("", "{", "[]", '"x"')] == [None] * 4
