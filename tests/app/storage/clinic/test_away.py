"""What a station records while the server does not answer goes to the others once, wherever it is broken off."""

import datetime
import json
import shutil
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import pytest

from app.storage.clinic import away
from app.storage.clinic.away import AWAY, COMING_HOME, bring_away_home, open_away, remember_operators
from app.storage.clinic.handing_over import hand_over
from app.storage.clinic.server_state import ServerState, set_state
from app.storage.exchange import session_with_samples
from app.storage.opened import OpenedLibrary, held_alone
from app.storage.recovery import adopt_home, find_interrupted, recover
from app.storage.stored import LibraryError, NotAllowedError, Role
from app.system.progress import nobody
from app.workers.library_holder import LibraryHolder
from app.workers.library_state import NotOpened, OpenedState
from core.goals import Goal, GoalOf, ordered
from core.session import Patient, Session
from tests.app.storage.clinic.conftest import PASSPHRASE
from tests.app.storage.clinic.test_stations import found, read, record

pytestmark = pytest.mark.endurance  # each starts with an empty server

Stations = tuple[OpenedLibrary, OpenedLibrary]


def begin_away(station: OpenedLibrary, code: str = "hk") -> OpenedLibrary:
    """The station works without the server."""
    remember_operators(station)
    assert station.data_key is not None
    return open_away(station.folder, station.data_key, code)


def visit_away(station: OpenedLibrary, code: str = "DEMO-9", walks: int = 1) -> tuple[UUID, list[UUID]]:
    """A session that is made while the server is away; its id, and those of its walks."""
    with begin_away(station) as opened:
        library = opened.library
        patient = library.patients.find(code) or library.patients.create(Patient(code=code, height_m=1.6))
        visit = library.sessions.create(patient.id, Session((), notes="while the server was away"))
        return visit.id, [record(opened, visit.id, f"walk {k}") for k in range(1, walks + 1)]


def test_a_session_that_was_made_without_the_server_is_read_at_the_other_station(stations: Stations) -> None:
    first, second = stations
    session_id, walks = visit_away(first, walks=2)
    assert bring_away_home(first) == 1
    assert hand_over(first) == set(walks)
    visit = second.library.sessions.get(session_id)
    assert [recording.details.name for recording in visit.recordings] == ["walk 1", "walk 2"]
    assert len(session_with_samples(second, visit, {}, nobody).recordings) == 2
    patient = second.library.patients.find("DEMO-9")
    assert patient is not None
    assert patient.details.height_m == 1.6
    assert not (first.folder / AWAY).exists()
    assert not (first.folder / COMING_HOME).exists()
    assert bring_away_home(first) == 0


def test_a_patient_whom_the_clinic_knows_keeps_what_it_states(stations: Stations) -> None:
    first, second = stations
    before = second.library.patients.find("DEMO-1")
    assert before is not None
    session_id, _ = visit_away(first, code="DEMO-1")
    bring_away_home(first)
    after = second.library.patients.find("DEMO-1")
    assert after is not None
    assert (after.id, after.details) == (before.id, before.details)
    assert second.library.sessions.get(session_id).patient_id == before.id


def test_a_goal_agreed_without_the_server_is_added_to_the_clinics(stations: Stations) -> None:
    first, second = stations
    known = second.library.patients.find("DEMO-1")
    assert known is not None
    day = datetime.date(2026, 9, 30)
    theirs, ours = Goal("speed_m_s", GoalOf.WALK, 1.2, day), Goal("knee_range_deg", GoalOf.LEFT, 55.0, day)
    second.library.patients.change(known, replace(known.details, goals=(theirs,)))
    with begin_away(first) as opened:
        opened.library.patients.create(Patient(code="DEMO-1", goals=(ours,)))
    bring_away_home(first)
    after = second.library.patients.find("DEMO-1")
    assert after is not None
    assert after.details.goals == ordered((theirs, ours))


def test_a_deleted_patient_who_is_measured_is_one_again(stations: Stations) -> None:
    first, second = stations
    patient = second.library.patients.find("DEMO-1")
    assert patient is not None
    second.library.patients.delete(patient)
    visit_away(first, code="DEMO-1")
    bring_away_home(first)
    assert second.library.patients.find("DEMO-1") is not None


def test_a_station_that_was_restored_from_an_image_brings_what_it_recorded_since(
    stations: Stations, tmp_path: Path
) -> None:
    first, second = stations
    old, _ = visit_away(first)
    image = Path(shutil.copytree(first.folder / AWAY, tmp_path / "image"))
    assert bring_away_home(first) == 1
    hand_over(first)
    shutil.copytree(image, first.folder / AWAY)  # the same library, as it was before
    new, walks = visit_away(first, code="DEMO-8")
    entries = len(second.library.audit.entries())
    assert bring_away_home(first) == 1
    hand_over(first)
    visit = second.library.sessions.get(new)
    assert len(session_with_samples(second, visit, {}, nobody).recordings) == len(walks)
    assert second.library.sessions.get(old).recordings
    assert len(second.library.audit.entries()) > entries
    shutil.copytree(image, first.folder / AWAY)
    assert bring_away_home(first) == 0
    assert second.library.audit.verify().faults == ()


def test_an_edit_that_the_server_does_not_cover_is_kept(stations: Stations, tmp_path: Path) -> None:
    first, _ = stations
    old, _ = visit_away(first)
    image = Path(shutil.copytree(first.folder / AWAY, tmp_path / "image"))
    bring_away_home(first)
    shutil.copytree(image, first.folder / AWAY)
    with begin_away(first) as opened:
        visit = opened.library.sessions.get(old)
        opened.library.sessions.change(visit, replace(visit.details, notes="written after the image"), visit.comment)
    assert bring_away_home(first) == 0
    (kept,) = first.folder.glob("away-not-covered-*")
    assert (kept / "library.db").exists()


def test_corrections_and_audit_go_on_the_clinics_own(stations: Stations) -> None:
    first, second = stations
    patient = first.library.patients.find("DEMO-1")
    assert patient is not None
    first.library.patients.change(patient, replace(patient.details, height_m=1.7))
    with begin_away(first) as opened:
        stranger = opened.library.patients.create(Patient(code="DEMO-9"))
        opened.library.patients.change(stranger, replace(stranger.details, mass_kg=70.0))
        entries = len(opened.library.audit.entries())
    before = len(second.library.audit.entries())
    bring_away_home(first)
    assert second.library.audit.verify().faults == ()
    reported = second.library.audit.entries()[before:]
    assert len(reported) == entries
    assert all("was_away_at" in json.loads(entry.details) for entry in reported)
    home = second.library.patients.find("DEMO-9")
    assert home is not None
    assert home.details.mass_kg == 70.0
    assert len(second.library.corrections.of_patient(home.id)) == 1


def test_a_recording_that_was_killed_without_the_server_is_recovered_as_any(stations: Stations) -> None:
    first, second = stations
    with begin_away(first) as opened:
        patient = opened.library.patients.create(Patient(code="DEMO-9"))
        visit = opened.library.sessions.create(patient.id, Session(()))
        orphan = record(opened, visit.id, "walk 1", has_row=False)
    bring_away_home(first)
    (one,) = find_interrupted(first)
    assert (one.recording_id, one.is_orphan) == (orphan, True)
    assert one.belonging is not None
    assert one.belonging.session_id == visit.id
    adopt_home(first, one, nobody)
    hand_over(first)
    read(second, orphan)


def test_a_recording_that_is_open_is_the_stations_to_recover(stations: Stations) -> None:
    first, second = stations
    with begin_away(first) as opened:
        patient = opened.library.patients.create(Patient(code="DEMO-9"))
        visit = opened.library.sessions.create(patient.id, Session(()))
        walk = record(opened, visit.id, "walk 1", is_closed=False)
    bring_away_home(first)
    assert find_interrupted(second) == ()
    (one,) = find_interrupted(first)
    recover(first, one, nobody)
    assert hand_over(first) == {walk}


@pytest.mark.parametrize("step", ["_bring_rows", "_bring_journals", "sync_folder", "shutil.rmtree"])
@pytest.mark.parametrize("is_done", [False, True])
def test_broken_off_anywhere_it_goes_there_once(
    stations: Stations, monkeypatch: pytest.MonkeyPatch, step: str, is_done: bool
) -> None:
    first, second = stations
    session_id, walks = visit_away(first)
    target, name = (shutil, "rmtree") if step == "shutil.rmtree" else (away, step)
    real = getattr(target, name)

    def broken(*arguments: object, **named: object) -> None:
        if is_done:
            real(*arguments, **named)
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(target, name, broken)
        with pytest.raises(KeyboardInterrupt):
            bring_away_home(first)
    later_id, later = visit_away(first, code="DEMO-8")  # the server is gone again
    bring_away_home(first)
    assert hand_over(first) == {*walks, *later}
    for session, walk in ((session_id, walks[0]), (later_id, later[0])):
        assert [one.id for one in second.library.sessions.get(session).recordings] == [walk]
        read(second, walk)
    assert second.library.audit.verify().faults == ()
    assert found(second, walks[0]).session_id == session_id


def test_what_is_still_worked_with_stays_until_it_is_not(stations: Stations) -> None:
    first, second = stations
    session_id, _ = visit_away(first)
    with (
        held_alone(first.folder / AWAY),
        pytest.raises(LibraryError, match="This library is already open in Gaitwright"),
    ):
        bring_away_home(first)
    assert bring_away_home(first) == 1
    assert second.library.sessions.get(session_id).details.notes == "while the server was away"


def test_who_never_worked_here_cannot_begin_without_the_server(stations: Stations) -> None:
    first, _ = stations
    remember_operators(first)
    assert first.data_key is not None
    with pytest.raises(NotAllowedError, match="Log in once while the clinic's server is available"):
        open_away(first.folder, first.data_key, "zz")
    assert not Path(first.folder / AWAY).exists()


def test_who_may_only_look_records_nothing_without_the_server(stations: Stations) -> None:
    first, _ = stations
    reported = next(one for one in first.library.operators.list() if one.code == "ab")
    first.library.operators.change(replace(reported, role=Role.VIEWER))
    with begin_away(first, "ab") as opened, pytest.raises(NotAllowedError):
        opened.library.patients.create(Patient(code="DEMO-9"))


def test_a_closed_server_is_no_reason_to_work_without_it(stations: Stations) -> None:
    first, _ = stations
    with first.library.database.writing() as session:
        set_state(session, ServerState.CLOSED)
    first.library.close()
    outcome = LibraryHolder(None).open(first.folder, PASSPHRASE, "hk", False, None)
    assert isinstance(outcome, NotOpened)
    assert outcome.what == "The library is no longer on the clinic's server."
    assert not outcome.can_work_away


def test_what_the_server_does_not_take_is_stated_at_the_log_in_until_it_does(
    stations: Stations, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, _ = stations
    visit_away(first)
    first.library.close()

    def refused(*_: object) -> int:
        raise LibraryError("The server is full", "Ask whoever keeps it")

    holder = LibraryHolder(None)
    with monkeypatch.context() as patched:
        patched.setattr(away, "_bring_rows", refused)
        outcome = holder.open(first.folder, PASSPHRASE, "hk", False, None)
    assert isinstance(outcome, OpenedState)
    assert outcome.still_away == ("The server is full.", "Ask whoever keeps it.")
    again = holder.open(first.folder, PASSPHRASE, "hk", False, None)
    holder.close()
    assert isinstance(again, OpenedState)
    assert (again.still_away, again.brought_from_away) == (None, 1)
