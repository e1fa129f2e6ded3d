"""The earlier visit whose curves page one draws thin: read once for a session, and found again with other results."""

from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.summary.conditions import Part
from app.summary.course_lanes import CourseVisit
from app.summary.facts import Facts
from app.summary.joint_panels import thin_part
from app.summary.request import AnalysedVisit

if TYPE_CHECKING:
    from app.wizard.resuming import EarlierVisit
    from app.wizard.visit import Visit


class ThinLineSource(QObject):
    """`changed`: other visits were read."""

    changed = Signal()

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._read: tuple[UUID, tuple[AnalysedVisit, ...]] | None = None  # a session, and the visits before it
        self._found: tuple[tuple[object, ...], Part | None] | None = None  # what it was made from, and the line
        visit.earlier_read.connect(self._on_read)

    def read(self) -> None:
        """Read the earlier visits, unless the results have; `changed` follows."""
        session = self._visit.session
        if session is not None and (self._read is None or self._read[0] != session.id):
            self._visit.read_earlier()

    def line(self, visit: AnalysedVisit, walks: tuple[str, ...], course: tuple[CourseVisit, ...]) -> Part | None:
        """Give the line of these results; None where there is no earlier visit, or it is not read yet."""
        session = self._visit.session
        if self._read is None or session is None or self._read[0] != session.id:
            return None
        made_from = (visit.analysis, self._read, *(one.course for one in course[:-1]))
        if self._found is None or [*map(id, self._found[0])] != [*map(id, made_from)]:
            facts = Facts(visit, visit.walk(walks[-1]), walks, course)
            self._found = made_from, thin_part(facts, self._read[1])
        return self._found[1]

    def _on_read(self, found: "list[EarlierVisit]") -> None:
        if (session := self._visit.session) is not None:
            self._read = session.id, tuple(AnalysedVisit(one.session, one.analysis) for one in found)
            if found:
                self.changed.emit()
