"""What is kept of a visit for its patient's course: it holds as long as all that it came of is as it was."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

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
from tests.app.course_material import course, walked
from tests.quick_library import quick_library
from tests.simulated import WALK_OF_ONE_LEG, session_of

SHOES = course((walked(), "shoes"))
STICK = course((walked(), "shoes, stick"))


@pytest.fixture(scope="module")
def reported() -> Session:
    """A walk of one leg, with a condition."""
    found = session_of(WALK_OF_ONE_LEG)
    recordings = (found.recordings[0], replace(found.recordings[1], condition="shoes"))
    return replace(found, recordings=recordings, patient=Patient(code="DEMO-1"), started="2026-06-20T09:00:00")


@pytest.fixture(scope="module")
def untouched(tmp_path_factory: pytest.TempPathFactory, reported: Session) -> OpenedLibrary:
    """A library that holds this walk, closed."""
    made = quick_library(tmp_path_factory.mktemp("courses"))
    import_session(made, reported, nobody)
    made.library.close()
    return made


@pytest.fixture
def visit(opened: OpenedLibrary) -> StoredSession:
    (line,) = opened.library.sessions.list()
    return opened.library.sessions.get(line.id)


Correct = Callable[[OpenedLibrary, StoredSession], object]


def of_walk(**reported: Any) -> Correct:
    """Correct what was reported of the walk."""

    def correct(opened: OpenedLibrary, visit: StoredSession) -> None:
        walk = visit.recordings[1]
        opened.library.recordings.change(walk, replace(walk.details, **reported))

    return correct


def of_session(**reported: Any) -> Correct:
    """Correct what was reported of the session."""
    return lambda opened, visit: opened.library.sessions.change(visit, replace(visit.details, **reported))


def measured(opened: OpenedLibrary, visit: StoredSession) -> None:
    of_walk(test=PlannedTest(TimedProtocol.TEN_METRES))(opened, visit)
    visit = opened.library.sessions.get(visit.id)
    before = current_course_key(visit)
    of_walk(test=PlannedTest(TimedProtocol.TEN_METRES, course_m=10.0))(opened, visit)
    assert current_course_key(opened.library.sessions.get(visit.id)) != before


def swapped(opened: OpenedLibrary, visit: StoredSession) -> None:
    walks = visit.recordings[1:]
    placement = walks[0].placement
    assert placement is not None
    thigh, shank = placement.sensors[Site.LEFT_THIGH], placement.sensors[Site.LEFT_SHANK]
    worn = {**placement.sensors, Site.LEFT_THIGH: shank, Site.LEFT_SHANK: thigh}
    seen = {one.id: one.placement.id if one.placement is not None else None for one in walks}
    opened.library.edits.placement(visit.id, seen, [([one.id for one in walks], worn)])


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


CORRECTIONS = {
    "relabelled": of_walk(condition="barefoot"),
    "returned": of_walk(alignment=AlignmentChange("boots", (), returns_to="barefoot")),
    "tested": of_walk(test=PlannedTest(TimedProtocol.TEN_METRES)),
    "measured": measured,
    "left out": of_walk(left_out_s={Side.LEFT: (4.0,)}),
    "not kept": of_walk(is_kept=False),
    "swapped": swapped,
    "turned": of_session(turned_sign={Joint.LEFT_KNEE: -1}),
    "zeroed": of_session(zero_rad={Joint.LEFT_KNEE: 0.1}),
    "without ankle": without_ankle,
    "other side": other_side,
    "other level": other_level,
}


@pytest.mark.parametrize("correct", CORRECTIONS.values(), ids=CORRECTIONS)
def test_what_was_found_no_longer_holds_once_something_is_put_right(
    opened: OpenedLibrary, visit: StoredSession, correct: Correct
) -> None:
    before = current_course_key(visit)
    assert current_course_key(opened.library.sessions.get(visit.id)) == before
    correct(opened, visit)
    assert current_course_key(opened.library.sessions.get(visit.id)) != before


def test_what_is_stated_to_people_leaves_it_as_it_is(opened: OpenedLibrary, visit: StoredSession) -> None:
    before = current_course_key(visit)
    opened.library.sessions.change(visit, replace(visit.details, notes="walked well"), comment="for the prosthetist")
    of_walk(note="slow")(opened, visit)
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
    assert 0 < condition.strides <= 12
