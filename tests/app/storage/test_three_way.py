"""Nothing of either side is lost when what both changed is brought together."""

import datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.storage.edited_fields import (
    patient_fields,
    recording_fields,
    session_fields,
    with_patient_fields,
    with_recording_fields,
    with_session_fields,
)
from app.storage.stored import Limits
from app.storage.three_way import Values, rebased, three_way
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Joint, Side
from core.goals import Goal, GoalOf, with_goal
from core.prosthesis import AmputationLevel, FootKind, KneeKind, Prosthesis
from core.session import Patient, Recording, RecordingKind, Session
from core.timed.protocols import PlannedTest, TimedProtocol

WORDS = st.sampled_from(["", "stick", "frame", "none"])
NUMBERS = st.one_of(st.none(), st.sampled_from([1.5, 1.6, 1.7]))
TIMES = st.lists(st.sampled_from([1.0, 2.0, 3.0, 4.0]), unique=True).map(lambda times_s: tuple(sorted(times_s)))
FIELDS = st.fixed_dictionaries({"aids": WORDS, "height_m": NUMBERS, "is_kept": st.booleans(), "left_out_s.left": TIMES})
DAY = datetime.date(2026, 9, 30)
ASKED = ("aids", "height_m", "is_kept")


@pytest.mark.endurance
@given(FIELDS, FIELDS, FIELDS)
def test_what_one_side_alone_changed_is_and_what_both_changed_otherwise_is_contested(
    base: Values, mine: Values, theirs: Values
) -> None:
    merge = three_way(base, mine, theirs)
    for field in ASKED:
        is_mine, is_theirs = mine[field] != base[field], theirs[field] != base[field]
        assert (field in merge.contested) is (is_mine and is_theirs and mine[field] != theirs[field])
        assert (field in merge.theirs_only) is (is_theirs and not is_mine)
        if field not in merge.contested:
            assert merge.merged[field] == (mine if is_mine else theirs)[field]
        else:
            assert merge.merged[field] == theirs[field]


@pytest.mark.endurance
@given(FIELDS, FIELDS, FIELDS)
def test_a_stride_that_either_side_left_out_or_took_in_is_left_out_or_taken_in(
    base: Values, mine: Values, theirs: Values
) -> None:
    before, own, other, merged = (
        set(one["left_out_s.left"])  # type: ignore[arg-type]  # a tuple, as the strategy has it
        for one in (base, mine, theirs, three_way(base, mine, theirs).merged)
    )
    assert merged >= (own - before) | (other - before)
    assert not merged & ((before - own) | (before - other))
    assert merged <= before | own | other


@pytest.mark.endurance
@given(FIELDS, FIELDS, FIELDS)
def test_it_is_the_same_from_either_side(base: Values, mine: Values, theirs: Values) -> None:
    here, there = three_way(base, mine, theirs), three_way(base, theirs, mine)
    assert set(here.contested) == set(there.contested)
    for field in base:
        if field not in here.contested:
            assert here.merged[field] == there.merged[field]


@pytest.mark.endurance
@given(FIELDS, FIELDS)
def test_equal_edits_are_no_conflict_and_no_news(base: Values, both: Values) -> None:
    merge = three_way(base, both, both)
    assert (merge.merged, merge.contested, merge.theirs_only) == (both, (), ())


@given(FIELDS, FIELDS, FIELDS)
def test_what_was_stated_since_is_neither_lost_nor_stated_base_what_was_never_shown(
    sent: Values, stated: Values, held: Values
) -> None:
    shown, still_stated = rebased(sent, stated, held)
    for field in sent:
        if stated[field] != sent[field]:
            assert still_stated[field] == stated[field]
            assert shown[field] in (sent[field], stated[field])
        else:
            assert still_stated[field] == shown[field] == held[field]


def test_a_side_is_one_word_of_two_columns() -> None:
    """Else one station's affected side could stand beside the other's prosthetic one."""
    base = patient_fields(Patient(affected_side="left", prosthetic_side="none"))
    mine = patient_fields(Patient(affected_side="right", prosthetic_side="none"))
    theirs = patient_fields(Patient(affected_side="none", prosthetic_side="left"))
    assert three_way(base, mine, theirs).contested == ("sides",)


WORN = {
    Side.LEFT: Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.LOCKED),
    Side.RIGHT: Prosthesis(foot=FootKind.SACH),
}


def test_two_prostheses_are_two_fields_and_all_of_one_is_one() -> None:
    transtibial = Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.SACH)
    base, mine, theirs = (
        patient_fields(Patient(prosthetic_side="both", prostheses=worn))
        for worn in ({}, {Side.LEFT: transtibial}, {Side.RIGHT: transtibial})
    )
    found = three_way(base, mine, theirs)
    assert found.contested == ()
    assert with_patient_fields(Patient(), found.merged).prostheses == {Side.LEFT: transtibial, Side.RIGHT: transtibial}
    other = patient_fields(Patient(prosthetic_side="both", prostheses={Side.LEFT: Prosthesis(foot=FootKind.SACH)}))
    assert three_way(base, mine, other).contested == ("prosthesis.left",)


def test_fields_and_back_are_the_same() -> None:
    goals: tuple[Goal, ...] = (
        Goal("speed_m_s", GoalOf.WALK, 1.2, DAY, "hk"),
        Goal("stance_percent", GoalOf.BETWEEN, 2.0, DAY, is_at_most=True),
    )
    goals = with_goal(goals, Goal("speed_m_s", GoalOf.WALK, 1.3, DAY, "bb"))
    patient = Patient("P-1", 1970, "female", 1.7, 60.0, "knee", "stick", "none", "both", {"x": 1}, goals, WORN)
    assert with_patient_fields(Patient(unknown={"x": 1}), patient_fields(patient)) == patient
    reported = Session((), surface="grass", zero_rad={Joint.LEFT_KNEE: 0.0}, turned_sign={Joint.LEFT_ANKLE: -1})
    limits = Limits(frozenset({Side.LEFT}), cannot_stand=True)
    values = session_fields(reported, "words", limits, "confirmed")
    assert with_session_fields(Session(()), "", Limits(), "", values) == (reported, "words", limits, "confirmed")
    turned = AlignmentChange("A", (PartChange(ProsthesisPart.KNEE_UNIT, turns=-0.5),))
    walk = Recording(
        "walk 1",
        RecordingKind.WALKING,
        "",
        {},
        left_out_s={Side.LEFT: (1.0, 2.0)},
        note="slow",
        alignment=turned,
        test=PlannedTest(TimedProtocol.UP_AND_GO, end_key_s=9.0),
    )
    blank = Recording("walk 1", RecordingKind.STANDING, "", {})
    assert with_recording_fields(blank, recording_fields(walk)) == walk
