"""Parts of a session and its analysis that may leave without revealing whose they are.

A session of a library gets the pseudonym that all exports of its patient have (`app.storage.pseudonyms`), one of a
folder that which all exports of it on this computer have (`app.exports.folder_pseudonyms`).
"""

from collections.abc import Collection
from dataclasses import replace
from uuid import UUID

from app.storage.pseudonyms import AGE, Pseudonyms, Typed
from app.wording.alignment import since_in_words
from app.wording.measures import goal_in_words
from app.wording.prostheses import whole_words
from app.wording.timed_tests import planned_words
from app.wording.translation import later
from core.body import Side
from core.goals import Goal, held
from core.hip.results import HipAngle
from core.results import Analysis, Calibration, JointCalibration
from core.session import Recording, Session

Row = tuple[str, str | float | int | None]


def pseudonymised(
    pseudonyms: Pseudonyms, patient_id: UUID, session: Session, analysis: Analysis, kept: Collection[Typed] = ()
) -> tuple[Session, Analysis]:
    """Replace names of patient, recordings and sensors; drop findings and all free text except `kept`."""
    other = pseudonyms.session(patient_id, session, kept)
    pairs = list(zip(session.recordings, other.recordings, strict=True))
    names = {old.name: new.name for old, new in pairs}
    folders = {old.name: new.folder for old, new in pairs}

    def joint(found: JointCalibration) -> JointCalibration:
        return replace(
            found,
            standing_from=names.get(found.standing_from or ""),
            free_motion_from=names.get(found.free_motion_from or ""),
            walks_from=tuple(names[name] for name in found.walks_from),
        )

    def hip(found: HipAngle) -> HipAngle:
        standing = names.get(found.identification.standing_from, "")
        return replace(found, identification=replace(found.identification, standing_from=standing))

    spans = tuple(
        Calibration(tuple(names[name] for name in span.walks), {j: joint(found) for j, found in span.joints.items()})
        for span in analysis.calibrations
    )
    recordings = tuple(
        replace(r, name=names[r.name], folder=folders[r.name], hips={j: hip(found) for j, found in r.hips.items()})
        for r in analysis.recordings
    )
    return other, replace(analysis, calibrations=spans, recordings=recordings, findings=())


PROSTHESES = {Side.LEFT: later("prosthesis, left"), Side.RIGHT: later("prosthesis, right")}


def what_is_stated(session: Session) -> list[Row]:
    """Whose a session is, as every format that states any of it does; what is not known is empty."""
    patient = session.patient
    return [
        (later("patient"), patient.code),
        (later("birth year"), patient.birth_year),
        (later("age, years"), str(patient.unknown.get(AGE, ""))),
        (later("sex"), patient.sex),
        (later("height, m"), patient.height_m),
        (later("weight, kg"), patient.mass_kg),
        (later("device"), patient.device),
        (later("aids"), patient.aids),
        (later("affected side"), patient.affected_side),
        (later("prosthetic side"), patient.prosthetic_side),
        *((PROSTHESES[side], whole_words(one)) for side, one in patient.worn.items()),
        (later("goals"), "; ".join(map(_goal, held(patient.goals)))),
        (later("session"), session.started),
        (later("user"), session.operator),
        (later("surface"), session.surface),
        (later("notes"), session.notes),
    ]


def what_leaves(session: Session) -> list[Row]:
    """All that a pseudonymised session states beside its figures: whose it is, and each recording."""
    stated = [row for row in what_is_stated(session) if row[1] not in ("", None)]
    return stated + [(recording.name, _about(recording)) for recording in session.recordings]


def _goal(goal: Goal) -> str:
    """What was agreed and since when; by whom and what was typed of it, where that is stated."""
    stated = [f"{goal_in_words(goal)} ({goal.agreed.isoformat()})", goal.by, goal.note]
    return ", ".join(filter(None, stated))


def _about(recording: Recording) -> str:
    changed = since_in_words(recording.alignment)
    test = planned_words(recording.test) if recording.test is not None else ""
    stated = [recording.kind.replace("_", " "), recording.condition, test, changed, recording.started]
    return ", ".join(filter(None, stated))
