"""Check that the figures of a visit kept for its patient's course still hold.

They hold as long as everything that they came of is as it was: what was stated about patient, joints and recordings,
who wore what, which strides were left out, and the code that computes. Samples never change.
"""

import hashlib
import json
import logging
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING
from uuid import UUID

from app.storage.kept_analyses import algorithm
from app.storage.stored import LibraryError, Placement, StoredRecording
from core.prosthesis import prostheses_text
from core.session import Session

if TYPE_CHECKING:  # the database takes long to load
    from app.storage.courses import Courses
    from app.summary.course import Course

_log = logging.getLogger(__name__)


def course_key(details: Session, stored: Sequence[StoredRecording]) -> str:
    """Give the SHA-256 of all that a course depends on but the samples; `stored` includes the evaluated."""
    placements = {recording.details.name: recording.placement for recording in stored}
    return hashlib.sha256(
        json.dumps(
            {
                "algorithm": algorithm(),
                "sides": [details.patient.affected_side, details.patient.prosthetic_side],
                "prostheses": prostheses_text(details.patient.worn),
                "zero_rad": {str(joint): value for joint, value in details.zero_rad.items()},
                "turned_sign": {str(joint): sign for joint, sign in details.turned_sign.items()},
                "findings": sorted({f"{finding.key} {finding.where}" for finding in details.findings}),
                "recordings": [
                    {
                        "name": one.name,
                        "kind": one.kind,
                        "condition": one.condition,
                        "returned_to": one.returned_to,
                        "test": asdict(one.test) if one.test is not None else None,
                        "is_restrapped_before": one.is_restrapped_before,
                        "left_out_s": {
                            str(side): sorted(times_s) for side, times_s in one.left_out_s.items() if times_s
                        },
                        "worn": _worn(placements, one.name),
                    }
                    for one in details.recordings
                ],
            },
            sort_keys=True,
        ).encode()
    ).hexdigest()


def keep_course(courses: "Courses", session_id: UUID, key: str, course: "Course") -> None:
    """Keep it where that can be done. That it cannot is no harm: it is computed again."""
    try:
        courses.keep(session_id, key, course)
    except LibraryError as error:
        _log.info("a course was not kept", exc_info=error)


def _worn(placements: Mapping[str, Placement | None], name: str) -> dict[str, str]:
    """Sensor by site."""
    placement = placements.get(name)
    return {str(site): sensor.name for site, sensor in placement.sensors.items()} if placement is not None else {}
