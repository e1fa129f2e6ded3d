"""What a visit of the demonstration records goes the way of every recording, and is marked simulated wherever it is."""

import datetime
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from app.demonstration.patients import ReportedOfWalk, SimulatedVisit, simulated_patients
from app.demonstration.recording import add_patients, record_visit, take_in
from app.home.patients.reading import PatientReading, read_patient
from app.storage.library import DEMONSTRATOR, Library
from app.storage.opened import OpenedLibrary, create_library
from app.storage.stored import LibraryError, Limits, Operator, Role
from app.summary.course import CourseCondition, change
from app.summary.course_words import NextKind
from app.system.progress import nobody
from app.wizard.resuming import read_analysed, read_recordings
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import LEG_SITES, Joint, Side
from core.parameters import KNEE, SPEED
from core.prosthesis import JointNature
from core.results import Analysis
from core.session import RecordingKind, Session
from core.timed.measures import COLUMNS
from core.timed.protocols import PlannedTest, TimedProtocol
from core.verdicts.model import Verdict
from devices.simulation.replay import DEMONSTRATION_NAMES
from devices.simulation.walker import Standing, Walk, WalkerSettings

NOW = datetime.datetime(2026, 11, 24, 15, 0, tzinfo=datetime.UTC)
CHANGE = AlignmentChange("Alignment A", (PartChange(ProsthesisPart.KNEE_UNIT, turns=1.0),))
SHORT = SimulatedVisit(
    "DEMO-KNEE",
    NOW - datetime.timedelta(days=3),
    WalkerSettings(recordings=(Standing(), Walk(strides=4), Walk("walk 2", strides=3))),
    {"walk 1": ReportedOfWalk("Shoes", test=TimedProtocol.TEN_METRES), "walk 2": ReportedOfWalk("Alignment B", CHANGE)},
    Limits(without_ankle=frozenset({Side.LEFT})),
)


@pytest.fixture(scope="module")
def recorded() -> Session:
    return record_visit(SHORT)


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[OpenedLibrary]:
    folder = tmp_path / "demonstration"
    with OpenedLibrary(Library.create(folder, None, DEMONSTRATOR), folder, None) as opened:
        add_patients(opened, simulated_patients(NOW))
        yield opened


def test_patients_are_listed_with_the_first_one_first(opened: OpenedLibrary) -> None:
    assert [one.details.code for one in opened.library.patients.search()] == [
        "DEMO-KNEE",
        "DEMO-STROKE",
        "DEMO-AK",
        "DEMO-BK",
    ]


def test_a_visit_comes_out_of_its_journals_as_it_was_recorded_and_reported(
    opened: OpenedLibrary, recorded: Session
) -> None:
    assert recorded.is_simulated
    session_id = take_in(opened, SHORT, recorded)
    stored = opened.library.sessions.get(session_id)
    assert stored.details.is_simulated
    assert stored.limits.without_ankle == {Side.LEFT}
    assert stored.details.started == "2026-11-21T15:00:00+00:00"
    read = read_recordings(opened, stored)
    assert [one.stored.is_simulated for one in read] == [True, True, True]
    for one, sent in zip(read, recorded.recordings, strict=True):
        assert one.read_back is not None
        assert {site: block.sensor for site, block in one.read_back.imu.items()} == {
            site: DEMONSTRATION_NAMES[site] for site in LEG_SITES
        }
        for site, block in sent.imu.items():
            assert (one.read_back.imu[site].gyr_rad_s == block.gyr_rad_s).all()
            assert (one.read_back.imu[site].acc_m_s2 == block.acc_m_s2).all()
    standing, timed, changed = (one.details for one in read)
    assert (standing.kind, standing.condition) == (RecordingKind.STANDING, "")
    assert (timed.condition, timed.test) == ("Shoes", PlannedTest(TimedProtocol.TEN_METRES))
    assert (changed.condition, changed.alignment) == ("Alignment B", CHANGE)
    assert timed.started[:10] == "2026-11-21"


@pytest.mark.endurance
def test_a_report_is_stated_to_be_written_of_those_visits_alone_of_which_it_is(
    opened: OpenedLibrary, recorded: Session
) -> None:
    written = take_in(opened, SHORT, recorded)
    unwritten = take_in(opened, replace(SHORT, is_reported=False), recorded)
    assert opened.library.audit.reported([written, unwritten]) == {written}


@pytest.mark.endurance
def test_a_visit_is_refused_by_a_library_of_real_patients(tmp_path: Path, recorded: Session) -> None:
    """The demonstration's is a folder of its own; were a visit handed to another, it would stay out."""
    opened, _ = create_library(tmp_path / "own", Operator("hk", "H. Keller", Role.ADMINISTRATOR), "four short words")
    with opened:
        with pytest.raises(LibraryError, match="starts with DEMO"):
            take_in(opened, replace(SHORT, code="P-0158"), recorded)
        assert opened.library.sessions.list() == ()


@pytest.mark.endurance
def test_the_whole_library_shows_what_it_is_made_to_show(opened: OpenedLibrary) -> None:
    analyses: dict[str, list[Analysis]] = {}
    for patient in simulated_patients(NOW):
        for visit in patient.visits:
            session_id = take_in(opened, visit, record_visit(visit))
            analyses.setdefault(visit.code, []).append(read_analysed(opened, session_id, nobody)[1])
    ids = {one.details.code: one.id for one in opened.library.patients.search()}
    _knee_is_replaced(read_patient(opened, ids["DEMO-KNEE"]))
    _is_after_stroke(read_patient(opened, ids["DEMO-STROKE"]))
    _is_fitted(read_patient(opened, ids["DEMO-AK"]))
    _has_own_knee(read_patient(opened, ids["DEMO-BK"]), *analyses["DEMO-BK"])
    assert [len(found) for found in analyses.values()] == [4, 2, 1, 1]
    warned = {finding.key for found in analyses.values() for one in found for finding in one.findings}
    assert "strap_slipped" not in warned
    assert all(one.is_simulated for found in analyses.values() for one in found)


def _conditions(reading: PatientReading, name: str) -> list[CourseCondition]:
    visits = reading.visits(NOW)
    found = [visit.course.condition(name) for visit in visits if visit.course is not None]
    assert len(found) == len(visits)
    return [one for one in found if one is not None]


def _knee_is_replaced(reading: PatientReading) -> None:
    """Speed and knee come back beyond the error; of one visit the knee may not be read, and its right leg may."""
    walked = _conditions(reading, "Shoes")
    assert len(walked) == 4
    assert len(_conditions(reading, "Shoes, stick")) == 2
    assert [bool(one.not_reported) for one in walked] == [False, True, False, False]
    assert Joint.LEFT_KNEE in walked[1].not_reported
    for column, side in ((SPEED, None), (KNEE, Side.LEFT), (COLUMNS[TimedProtocol.TEN_METRES], None)):
        found = change(walked[-1], walked[0], column, side)
        assert found is not None
        assert found.exceeds
        assert found.difference > 0
    right = [figure.verdict for one in walked if (figure := one.figure(KNEE, Side.RIGHT)) is not None]
    assert Verdict.NOT_REPORTED not in right
    rises = [test.found.mean for one in walked if (test := one.test(COLUMNS[TimedProtocol.SIT_TO_STAND])) is not None]
    assert rises == sorted(rises, reverse=True)
    step = reading.next_step(NOW)
    assert step is not None
    assert step.kind is NextKind.REPORT


def _is_after_stroke(reading: PatientReading) -> None:
    """Slow, its knee stiff, its stance short; faster at the second visit, inside the error."""
    first, last = _conditions(reading, "Shoes")
    for one in (first, last):
        knees = {side: figure.found.mean for side in Side if (figure := one.figure(KNEE, side)) is not None}
        assert knees[Side.RIGHT] < knees[Side.LEFT] - 15.0
        stance = one.between_legs("stance_percent")
        assert stance is not None
        assert stance.difference > 3.0
        assert one.not_reported == ()
    found = change(last, first, SPEED)
    assert found is not None
    assert 0.0 < found.difference < found.error
    up = change(last, first, COLUMNS[TimedProtocol.UP_AND_GO])
    assert up is not None
    assert up.difference < 0.0
    assert not math.isfinite(up.error)


def _is_fitted(reading: PatientReading) -> None:
    """Three alignments of one visit, whose knee swings further with the last."""
    (visit,) = reading.visits(NOW)
    assert visit.course is not None
    assert [one.condition for one in visit.course.conditions] == ["Alignment A", "Alignment B", "Alignment C"]
    knees = [figure.found.mean for one in visit.course.conditions if (figure := one.figure(KNEE, Side.LEFT))]
    assert knees[2] - knees[1] > 5.0


def _has_own_knee(reading: PatientReading, analysis: Analysis) -> None:
    """One walk, all of it reported; the foot has no joint, and the knee above it is a person's."""
    (visit,) = reading.visits(NOW)
    assert visit.course is not None
    assert [one.not_reported for one in visit.course.conditions] == [()]
    calibrated = analysis.calibrations[-1].joints
    assert calibrated[Joint.RIGHT_KNEE].nature is JointNature.OWN
    assert not calibrated[Joint.RIGHT_KNEE].is_hinge
    assert calibrated[Joint.RIGHT_ANKLE].nature is JointNature.RIGID
    stated = [(one.key, one.where) for one in analysis.findings if one.key == "foot_against_shank"]
    assert stated == [("foot_against_shank", "right_ankle")]
