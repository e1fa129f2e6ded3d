"""What is kept of a visit for its patient's course: it holds as long as all that it came of is as it was."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from app.storage.exchange import import_session
from app.storage.opened import OpenedLibrary
from app.storage.stored import Limits, StoredSession
from app.system.progress import nobody
from app.wizard.resuming import current_course_key, read_analysed
from core.alignment import AlignmentChange
from core.body import Joint, Side, Site
from core.prosthesis import AmputationLevel, Prosthesis
from core.session import Patient, Session
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.walker import DEMONSTRATION, Standing, Walk
from tests.app.course_material import course, walked
from tests.simulated import session_of

SHOES = course((walked(), "shoes"))
STICK = course((walked(), "shoes, stick"))


@pytest.fixture(scope="module")
def reported() -> Session:
    """A walk of one leg, short, with a condition."""
    sites = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)
    played = (Standing(duration_s=2.0), Walk(strides=8))
    found = session_of(replace(DEMONSTRATION, sites=sites, recordings=played))
    recordings = (found.recordings[0], replace(found.recordings[1], condition="shoes"))
    return replace(found, recordings=recordings, patient=Patient(code="DEMO-1"), started="2026-06-20T09:00:00")


@pytest.fixture
def visit(opened: OpenedLibrary, reported: Session) -> StoredSession:
    return opened.library.sessions.get(import_session(opened, reported, nobody).session_id)


def corrected(opened: OpenedLibrary, visit: StoredSession, change: Callable[[Session], Session]) -> None:
    opened.library.sessions.change(visit, change(visit.details))


def relabelled(opened: OpenedLibrary, visit: StoredSession) -> None:
    walk = visit.recordings[1]
    opened.library.recordings.change(walk, replace(walk.details, condition="barefoot"))


def returned(opened: OpenedLibrary, visit: StoredSession) -> None:
    walk = visit.recordings[1]
    again = AlignmentChange("boots", (), returns_to="barefoot")
    opened.library.recordings.change(walk, replace(walk.details, alignment=again))


def tested(opened: OpenedLibrary, visit: StoredSession) -> None:
    walk = visit.recordings[1]
    opened.library.recordings.change(walk, replace(walk.details, test=PlannedTest(TimedProtocol.TEN_METRES)))


def measured(opened: OpenedLibrary, visit: StoredSession) -> None:
    tested(opened, visit)
    visit = opened.library.sessions.get(visit.id)
    before, walk = current_course_key(visit), visit.recordings[1]
    longer = PlannedTest(TimedProtocol.TEN_METRES, course_m=10.0)
    opened.library.recordings.change(walk, replace(walk.details, test=longer))
    assert current_course_key(opened.library.sessions.get(visit.id)) != before


def left_out(opened: OpenedLibrary, visit: StoredSession) -> None:
    walk = visit.recordings[1]
    opened.library.recordings.change(walk, replace(walk.details, left_out_s={Side.LEFT: (4.0,)}))


def not_kept(opened: OpenedLibrary, visit: StoredSession) -> None:
    walk = visit.recordings[1]
    opened.library.recordings.change(walk, replace(walk.details, is_kept=False))


def swapped(opened: OpenedLibrary, visit: StoredSession) -> None:
    walks = visit.recordings[1:]
    placement = walks[0].placement
    assert placement is not None
    thigh, shank = placement.sensors[Site.LEFT_THIGH], placement.sensors[Site.LEFT_SHANK]
    worn = {**placement.sensors, Site.LEFT_THIGH: shank, Site.LEFT_SHANK: thigh}
    seen = {one.id: one.placement.id if one.placement is not None else None for one in walks}
    opened.library.edits.placement(visit.id, seen, [([one.id for one in walks], worn)])


def turned(opened: OpenedLibrary, visit: StoredSession) -> None:
    corrected(opened, visit, lambda reported: replace(reported, turned_sign={Joint.LEFT_KNEE: -1}))


def zeroed(opened: OpenedLibrary, visit: StoredSession) -> None:
    corrected(opened, visit, lambda reported: replace(reported, zero_rad={Joint.LEFT_KNEE: 0.1}))


def without_ankle(opened: OpenedLibrary, visit: StoredSession) -> None:
    opened.library.sessions.change(visit, visit.details, limits=Limits(frozenset({Side.LEFT})))


def other_side(opened: OpenedLibrary, visit: StoredSession) -> None:
    patient = opened.library.patients.get(visit.patient_id)
    opened.library.patients.change(patient, replace(patient.details, affected_side="right"))


def other_level(opened: OpenedLibrary, visit: StoredSession) -> None:
    patient = opened.library.patients.get(visit.patient_id)
    worn = {Side.LEFT: Prosthesis(AmputationLevel.TRANSTIBIAL)}
    opened.library.patients.change(patient, replace(patient.details, prosthetic_side="left"))
    before = current_course_key(opened.library.sessions.get(visit.id))
    patient = opened.library.patients.get(visit.patient_id)
    opened.library.patients.change(patient, replace(patient.details, prostheses=worn))
    assert current_course_key(opened.library.sessions.get(visit.id)) != before


@pytest.mark.parametrize(
    "correct",
    [
        relabelled,
        returned,
        tested,
        measured,
        left_out,
        not_kept,
        swapped,
        turned,
        zeroed,
        without_ankle,
        other_side,
        other_level,
    ],
)
def test_what_was_found_no_longer_holds_once_something_is_put_right(
    opened: OpenedLibrary, visit: StoredSession, correct: Callable[[OpenedLibrary, StoredSession], None]
) -> None:
    before = current_course_key(visit)
    assert current_course_key(opened.library.sessions.get(visit.id)) == before
    correct(opened, visit)
    assert current_course_key(opened.library.sessions.get(visit.id)) != before


def test_what_is_stated_to_people_leaves_it_as_it_is(opened: OpenedLibrary, visit: StoredSession) -> None:
    before = current_course_key(visit)
    opened.library.sessions.change(visit, replace(visit.details, notes="walked well"), comment="for the prosthetist")
    walk = visit.recordings[1]
    opened.library.recordings.change(walk, replace(walk.details, note="slow"))
    assert current_course_key(opened.library.sessions.get(visit.id)) == before


def test_other_code_computes_it_again(monkeypatch: pytest.MonkeyPatch, visit: StoredSession) -> None:
    before = current_course_key(visit)
    monkeypatch.setattr("app.storage.kept_courses.algorithm", lambda: "another")
    assert current_course_key(visit) != before


def test_a_session_that_is_evaluated_gives_its_course(opened: OpenedLibrary, visit: StoredSession) -> None:
    read_analysed(opened, visit.id, nobody)
    ((key, found),) = opened.library.courses.find([visit.id]).values()
    assert key == current_course_key(opened.library.sessions.get(visit.id))
    (condition,) = found.conditions
    assert condition.condition == "shoes"
    assert 0 < condition.strides <= 8
