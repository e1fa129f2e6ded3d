"""Two stations edit the same: different fields are merged, the same field is contested, and the history has both."""

import datetime
from collections.abc import Iterator
from dataclasses import dataclass, replace
from uuid import UUID

import pytest

from app.storage.audit import about
from app.storage.database.engine import Database
from app.storage.edited_fields import KEPT, PLACEMENT, patient_fields, recording_fields, session_fields
from app.storage.library import Library
from app.storage.stored import BEGINNING, LibraryError, Limits, Operator, PlacedSensor, Role
from app.storage.three_way import Values
from core.body import Joint, Side, Site
from core.goals import Goal, GoalOf
from core.samples import SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from tests.app.storage.conftest import DATA_KEY, MakeEngine

FULL = Patient("P-7", 1966, "female", 1.68, 64.0, "knee K", "stick", "left", "none")
WALK = Recording("walk 1", RecordingKind.WALKING, "walk_1", {}, condition="shoes")
WORN = {Site.LEFT_THIGH: PlacedSensor("A", SensorInfo()), Site.RIGHT_THIGH: PlacedSensor("B", SensorInfo())}
SWAPPED = {Site.LEFT_THIGH: WORN[Site.RIGHT_THIGH], Site.RIGHT_THIGH: WORN[Site.LEFT_THIGH]}


@dataclass(frozen=True, slots=True)
class TwoStations:
    """Ours and theirs, at one database with one patient, session and walk."""

    ours: Library
    theirs: Library
    patient_id: UUID
    session_id: UUID
    walk_id: UUID


@pytest.fixture
def stations(library: Library, make_engine: MakeEngine) -> Iterator[TwoStations]:
    library.operators.add(Operator("bb", "B. Berger", Role.CLINICIAN))
    patient = library.patients.create(FULL)
    visit = library.sessions.create(patient.id, Session(()))
    library.sessions.place(visit.id, WORN)
    walk = library.recordings.start(visit.id, WALK, is_simulated=False, is_decided=False)
    with Library(Database(make_engine(), busy_s=5.0), DATA_KEY) as theirs:
        theirs.log_in("bb")
        yield TwoStations(library, theirs, patient.id, visit.id, walk.id)


DAY = datetime.date(2026, 9, 30)


def history(stations: TwoStations) -> list[tuple[str, str, object, object, bool]]:
    """Operator, field, old and new value of each change, oldest first, and whether it was taken back."""
    return [
        (one.operator, change.field, change.old, change.new, one.is_undone)
        for one in reversed(stations.ours.corrections.of_patient(stations.patient_id))
        for change in one.changes
    ]


def test_different_fields_are_merged_and_it_is_reported_what_the_other_changed(stations: TwoStations) -> None:
    base = patient_fields(FULL)
    stations.theirs.edits.patient(stations.patient_id, base, base | {"height_m": 1.80})
    edited = stations.ours.edits.patient(stations.patient_id, base, base | {"aids": "frame"})
    assert edited.stored.details == replace(FULL, height_m=1.80, aids="frame")
    assert edited.contests == ()
    assert [(one.field, one.value, one.by) for one in edited.others] == [("height_m", 1.80, "B. Berger")]
    assert stations.ours.patients.get(stations.patient_id).version == 3


def test_two_who_agree_on_two_goals_lose_neither_and_of_one_figure_are_asked(stations: TwoStations) -> None:
    speed = Goal("speed_m_s", GoalOf.WALK, 1.2, DAY, "hk")
    knee, more = Goal("knee_range_deg", GoalOf.LEFT, 55.0, DAY, "bb"), replace(speed, value=1.4, by="bb")
    base = patient_fields(FULL)
    stations.theirs.edits.patient(stations.patient_id, base, patient_fields(replace(FULL, goals=(knee,))))
    edited = stations.ours.edits.patient(stations.patient_id, base, patient_fields(replace(FULL, goals=(speed,))))
    assert set(edited.stored.details.goals) == {speed, knee}
    assert [one.field for one in edited.others] == ["goals.knee_range_deg.left"]
    edited = stations.theirs.edits.patient(stations.patient_id, base, patient_fields(replace(FULL, goals=(knee, more))))
    assert [one.field for one in edited.contests] == ["goals.speed_m_s.both"]
    assert set(stations.ours.patients.get(stations.patient_id).details.goals) == {speed, knee}


def test_the_same_stated_by_both_is_no_conflict_and_no_correction(stations: TwoStations) -> None:
    base = patient_fields(FULL)
    stations.theirs.edits.patient(stations.patient_id, base, base | {"height_m": 1.80})
    edited = stations.ours.edits.patient(stations.patient_id, base, base | {"height_m": 1.80})
    assert (edited.contests, edited.others) == ((), ())
    assert history(stations) == [("bb", "height_m", 1.68, 1.80, False)]


def test_the_same_field_is_contested_and_both_are_in_history_and_audit(stations: TwoStations) -> None:
    base = patient_fields(FULL)
    stations.theirs.edits.patient(stations.patient_id, base, base | {"height_m": 1.80})
    edited = stations.ours.edits.patient(stations.patient_id, base, base | {"height_m": 1.82, "aids": "frame"})
    (contest,) = edited.contests
    assert (contest.field, contest.mine, contest.theirs, contest.by) == ("height_m", 1.82, 1.80, "B. Berger")
    assert contest.at is not None
    assert edited.others == ()
    assert edited.stored.details == replace(FULL, height_m=1.80, aids="frame")  # what nobody contests is saved
    assert history(stations) == [
        ("bb", "height_m", 1.68, 1.80, False),
        ("hk", "aids", "stick", "frame", False),
        ("hk", "height_m", 1.80, 1.82, True),
        ("hk", "height_m", 1.82, 1.80, False),
    ]
    chosen = stations.ours.edits.patient(stations.patient_id, {"height_m": 1.80}, {"height_m": 1.82})
    assert chosen.contests == ()
    assert chosen.stored.details.height_m == 1.82
    assert history(stations)[-1] == ("hk", "height_m", 1.80, 1.82, False)
    entries = stations.ours.audit.entries(about("patient", stations.patient_id))
    noted = [entry.operator for entry in entries if "correction" in entry.details]
    assert noted == ["bb", "hk", "hk", "hk", "hk"]
    assert stations.ours.audit.verify(BEGINNING).faults == ()


def test_who_made_a_value_what_it_is_is_not_who_required_another(stations: TwoStations) -> None:
    base = patient_fields(FULL)
    stations.theirs.edits.patient(stations.patient_id, base, base | {"height_m": 1.80})
    stations.ours.edits.patient(stations.patient_id, base, base | {"height_m": 1.82})
    again = stations.ours.edits.patient(stations.patient_id, base, base | {"height_m": 1.84})
    assert [contest.by for contest in again.contests] == ["B. Berger"]


def test_a_change_between_question_and_answer_is_asked_again(stations: TwoStations) -> None:
    base = patient_fields(FULL)
    stations.theirs.edits.patient(stations.patient_id, base, base | {"height_m": 1.80})
    stations.ours.edits.patient(stations.patient_id, base, base | {"height_m": 1.82})
    stations.theirs.edits.patient(stations.patient_id, {"height_m": 1.80}, {"height_m": 1.79})
    answered = stations.ours.edits.patient(stations.patient_id, {"height_m": 1.80}, {"height_m": 1.82})
    assert [(one.mine, one.theirs) for one in answered.contests] == [(1.82, 1.79)]


@pytest.mark.parametrize("is_merged", [False, True])
def test_a_patient_who_is_gone_is_not_edited_out_of_sight(stations: TwoStations, is_merged: bool) -> None:
    patients = stations.theirs.patients
    if is_merged:
        patients.merge(patients.create(Patient("P-8")), patients.get(stations.patient_id))
    else:
        patients.delete(patients.get(stations.patient_id))
    base = patient_fields(FULL)
    with pytest.raises(LibraryError, match="been merged with another" if is_merged else "since been deleted"):
        stations.ours.edits.patient(stations.patient_id, base, base | {"height_m": 1.82})
    assert patients.get(stations.patient_id).details.height_m == 1.68


def test_two_joints_and_the_words_of_a_session_do_not_overwrite_each_other(stations: TwoStations) -> None:
    """As setting one zero once wrote all of them again."""
    base = session_fields(Session(()), "", Limits())
    theirs: Values = {"zero_rad.left_knee": 0.1, "turned_sign.right_knee": -1, "comment": "Drags."}
    stations.theirs.edits.session(stations.session_id, base, {**base, **theirs})
    mine: Values = {"zero_rad.right_knee": 0.2, "without_ankle.left": True, "comment": "Limps."}
    edited = stations.ours.edits.session(stations.session_id, base, {**base, **mine})
    reported = edited.stored.details
    assert reported.zero_rad == {Joint.LEFT_KNEE: 0.1, Joint.RIGHT_KNEE: 0.2}
    assert reported.turned_sign == {Joint.RIGHT_KNEE: -1}
    assert edited.stored.limits == Limits(frozenset({Side.LEFT}))
    assert [(one.field, one.mine, one.theirs, one.by) for one in edited.contests] == [
        ("comment", "Limps.", "Drags.", "B. Berger")
    ]
    assert {one.field: one.by for one in edited.others} == {
        "zero_rad.left_knee": "B. Berger",
        "turned_sign.right_knee": "B. Berger",
    }


def test_strides_that_two_left_out_are_all_left_out_and_nobody_is_asked(stations: TwoStations) -> None:
    base = recording_fields(WALK)
    stations.theirs.edits.recording(stations.walk_id, base, base | {"left_out_s.left": (4.0,), "condition": "AFO"})
    edited = stations.ours.edits.recording(stations.walk_id, base, base | {"left_out_s.left": (7.0,)})
    assert edited.stored.details.left_out_s == {Side.LEFT: (4.0, 7.0)}
    assert edited.stored.details.condition == "AFO"
    assert edited.contests == ()
    assert {one.field for one in edited.others} == {"left_out_s.left", "condition"}


def test_who_keeps_a_walk_that_another_discarded_is_asked_and_who_discards_it_too_is_not(stations: TwoStations) -> None:
    stations.theirs.edits.decision(stations.walk_id, is_kept=False)
    assert stations.ours.edits.decision(stations.walk_id, is_kept=False).contests == ()
    edited = stations.ours.edits.decision(stations.walk_id, is_kept=True)
    assert [(one.field, one.mine, one.theirs, one.by) for one in edited.contests] == [(KEPT, True, False, "B. Berger")]
    assert not edited.stored.details.is_kept


def test_sides_that_both_swapped_are_swapped_once(stations: TwoStations) -> None:
    """Each saw them the wrong way round; swapped twice they would be wrong again."""
    visit = stations.ours.sessions.get(stations.session_id)
    seen = {visit.recordings[0].id: visit.placements[0].id}
    for station in (stations.theirs, stations.ours):
        edited = station.edits.placement(visit.id, seen, [([stations.walk_id], SWAPPED)])
        assert edited.contests == ()
        placement = edited.stored.recordings[0].placement
        assert placement is not None
        assert placement.sensors == SWAPPED


def test_another_placement_stated_meanwhile_is_contested_and_stays(stations: TwoStations) -> None:
    visit = stations.ours.sessions.get(stations.session_id)
    seen = {visit.recordings[0].id: visit.placements[0].id}
    only = {Site.LEFT_SHANK: WORN[Site.LEFT_THIGH]}
    stations.theirs.edits.placement(visit.id, seen, [([stations.walk_id], only)])
    edited = stations.ours.edits.placement(visit.id, seen, [([stations.walk_id], SWAPPED)])
    (contest,) = edited.contests
    assert (contest.field, contest.theirs, contest.by) == (PLACEMENT, '{"left_shank": "A"}', "B. Berger")
    placement = edited.stored.recordings[0].placement
    assert placement is not None
    assert placement.sensors == only
    again = stations.ours.edits.placement(visit.id, {stations.walk_id: placement.id}, [([stations.walk_id], SWAPPED)])
    chosen = again.stored.recordings[0].placement
    assert chosen is not None
    assert chosen.sensors == SWAPPED
