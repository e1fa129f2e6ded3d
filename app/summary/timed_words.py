"""What a change of a timed test is worth: since earlier visits, and beside what others published."""

from collections.abc import Sequence

from app.summary.course_lanes import CourseLane, CourseVisit
from app.summary.course_words import changes_since_in_words


def comparison_sentences(lane: CourseLane | None, visits: Sequence[CourseVisit]) -> list[str]:
    """The changes since the last visit and the first one, judged where an error is known."""
    return [changes_since_in_words(lane, visits)] if lane is not None else []
