"""Who is in the demonstration's library: nobody real, each visit with what was stated about it, in the screen's
language."""

import datetime

import pytest

from app.demonstration.patients import SimulatedPatient, simulated_patients
from app.wording.translation import use_language
from core.alignment import changed_between
from core.body import Side
from core.goals import GoalOf
from core.prosthesis import AmputationLevel, FootKind, KneeKind, Prosthesis
from core.timed.protocols import TimedProtocol
from devices.simulation.fitted_prosthesis import BUILT
from devices.simulation.walker import FreeMotion, Standing, TimedCourse, Walk

NOW = datetime.datetime(2026, 11, 24, 15, 0, tzinfo=datetime.UTC)


@pytest.fixture
def patients() -> dict[str, SimulatedPatient]:
    return {one.details.code: one for one in simulated_patients(NOW)}


def test_four_are_simulated_and_their_codes_say_so(patients: dict[str, SimulatedPatient]) -> None:
    assert list(patients) == ["DEMO-KNEE", "DEMO-STROKE", "DEMO-AK", "DEMO-BK"]
    assert [len(one.visits) for one in patients.values()] == [4, 2, 1, 1]
    assert all(visit.code == code for code, one in patients.items() for visit in one.visits)


def test_visits_lie_behind_today_and_the_latest_of_the_first_patient_is_the_latest_of_all(
    patients: dict[str, SimulatedPatient],
) -> None:
    last = [one.visits[-1].started for one in patients.values()]
    assert last == sorted(last, reverse=True)
    for one in patients.values():
        started = [visit.started for visit in one.visits]
        assert started == sorted(started)
        assert all(at < NOW for at in started)
    knee = patients["DEMO-KNEE"].visits
    assert 140 < (knee[-1].started - knee[0].started).days < 160
    assert [visit.is_reported for visit in knee] == [True, True, True, False]


def test_of_every_walk_is_stated_what_it_was_and_of_no_other(patients: dict[str, SimulatedPatient]) -> None:
    for one in patients.values():
        for visit in one.visits:
            moved = {made.name: made for made in visit.settings.recordings}
            walks = {name for name, made in moved.items() if not isinstance(made, Standing | FreeMotion)}
            assert set(visit.reported) == walks
            for name, reported in visit.reported.items():
                made = moved[name]
                assert reported.condition
                assert (reported.test is None) is isinstance(made, Walk)
                assert reported.test is None or (isinstance(made, TimedCourse) and str(made.kind) == str(reported.test))


def test_a_patient_is_the_same_body_at_each_visit_with_other_straps(patients: dict[str, SimulatedPatient]) -> None:
    for one in patients.values():
        assert len({visit.settings.body for visit in one.visits}) == 1
        assert len({visit.settings.seed for visit in one.visits}) == len(one.visits)


def test_goals_are_agreed_at_the_first_visit_so_that_the_later_ones_are_held_against_them(
    patients: dict[str, SimulatedPatient],
) -> None:
    knee = patients["DEMO-KNEE"]
    first = knee.visits[0].started.date()
    assert {goal.agreed for goal in knee.details.goals} == {first}
    assert {goal.of for goal in knee.details.goals} >= {GoalOf.LEFT, GoalOf.WALK}
    assert any(goal.column.startswith("sit_to_stand") for goal in knee.details.goals)


def test_the_prosthesis_is_walked_as_it_was_stated_to_be_changed_from_the_alignment_before(
    patients: dict[str, SimulatedPatient],
) -> None:
    (visit,) = patients["DEMO-AK"].visits
    reported = list(visit.reported.values())
    assert [one.condition for one in reported] == ["Alignment A", "Alignment B", "Alignment C"]
    changes = {one.condition: one.alignment for one in reported}
    assert [one.alignment.since if one.alignment else "" for one in reported] == ["", "Alignment A", "Alignment B"]
    set_so = [made.prosthesis for made in visit.settings.recordings if isinstance(made, Walk)]
    assert set_so[0] == BUILT
    assert (set_so[1].plantar_deg, set_so[1].back_mm) == (4.0, 6.0)
    assert set_so[2].plantar_deg == set_so[1].plantar_deg
    assert set_so[2].swing_flexion_deg > set_so[1].swing_flexion_deg
    assert changed_between(changes, "Alignment A", "Alignment C")
    assert visit.limits.without_ankle == {Side.LEFT}


def test_who_wears_a_prosthesis_is_stated_to_wear_what_is_walked_with(patients: dict[str, SimulatedPatient]) -> None:
    worn = {code: one.details.worn for code, one in patients.items() if one.details.worn}
    assert worn == {
        "DEMO-AK": {Side.LEFT: Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.FLUID_CONTROLLED)},
        "DEMO-BK": {Side.RIGHT: Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)},
    }
    for one in patients.values():
        for visit in one.visits:
            side = visit.settings.prosthetic_side
            assert one.details.worn == ({side: visit.settings.fitted} if side is not None else {})


def test_conditions_are_words_of_the_language_on_the_screen() -> None:
    use_language("de")
    try:
        reported = simulated_patients(NOW)[0].visits[0].reported["walk 1"]
        assert reported.condition == "Schuhe"
    finally:
        use_language("en")


def test_a_stroke_is_seen_twice_with_both_tests(patients: dict[str, SimulatedPatient]) -> None:
    for visit in patients["DEMO-STROKE"].visits:
        tests = {reported.test for reported in visit.reported.values()}
        assert tests == {None, TimedProtocol.TEN_METRES, TimedProtocol.UP_AND_GO}
