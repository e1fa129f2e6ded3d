"""The figures of a visit that are kept for its patient's course: replaced, refused, and made room for."""

from uuid import UUID

import pytest
from sqlalchemy import text

from app.storage.database.engine import Database
from app.storage.database.ids import uuid7
from app.storage.database.models import CourseRow
from app.storage.database.schema import bring_up_to_date
from app.storage.database.steps import move
from app.storage.kept_courses import keep_course
from app.storage.library import Library
from app.storage.stored import LibraryError, Operator, Role
from core.session import Patient, Session
from tests.app.course_material import course, walked

SHOES = course((walked(), "shoes"))
STICK = course((walked(), "shoes, stick"))


@pytest.fixture
def session_id(library: Library) -> UUID:
    return library.sessions.create(library.patients.create(Patient(code="P-1")).id, Session(())).id


def test_a_course_is_found_as_it_was_kept_and_replaced_by_the_next(library: Library, session_id: UUID) -> None:
    courses = library.courses
    assert courses.find([session_id]) == {}
    courses.keep(session_id, "first", SHOES)
    courses.keep(session_id, "first", SHOES)
    ((key, found),) = courses.find([session_id, uuid7()]).values()
    assert (key, repr(found)) == ("first", repr(SHOES))
    courses.keep(session_id, "second", STICK)
    ((key, found),) = courses.find([session_id]).values()
    assert (key, repr(found)) == ("second", repr(STICK))


def test_whoever_may_look_at_a_session_may_keep_its_course(library: Library, session_id: UUID) -> None:
    library.operators.add(Operator("vw", "V. Wirth", Role.VIEWER))
    library.log_in("vw")
    library.courses.keep(session_id, "key", SHOES)
    assert session_id in library.courses.find([session_id])


def test_a_session_that_is_gone_has_no_course_and_that_is_no_harm(library: Library) -> None:
    with pytest.raises(LibraryError, match="no longer in the library"):
        library.courses.keep(uuid7(), "key", SHOES)
    keep_course(library.courses, uuid7(), "key", SHOES)


def test_a_course_of_another_version_is_computed_again(library: Library, database: Database, session_id: UUID) -> None:
    library.courses.keep(session_id, "key", SHOES)
    with database.writing() as session:
        row = session.get(CourseRow, session_id)
        assert row is not None
        row.content = {**row.content, "format": "gaitwright-course/0"}
    assert library.courses.find([session_id]) == {}
    library.courses.keep(session_id, "key", SHOES)
    assert session_id in library.courses.find([session_id])


def test_a_library_of_the_version_before_gets_a_place_for_courses(
    library: Library, database: Database, session_id: UUID
) -> None:
    with database.rebuilding() as connection:
        move(connection, "0006")
        assert connection.execute(text("SELECT count(*) FROM sessions")).scalar() == 1
    bring_up_to_date(database)
    assert library.courses.find([session_id]) == {}
    library.courses.keep(session_id, "key", SHOES)
    assert session_id in library.courses.find([session_id])
