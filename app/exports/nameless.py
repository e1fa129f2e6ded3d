"""What of a session and its analysis may leave without saying whose they are?

A session of a library gets the pseudonym that all exports of its patient have (`app.storage.pseudonyms`). One of a
folder has no key to make one from, so each export draws its own, and two of them cannot be put together.
"""

import secrets
from dataclasses import replace
from uuid import UUID, uuid4

from app.storage.pseudonyms import Pseudonyms
from core.results import Analysis, Calibration, JointCalibration
from core.samples import Session


def nameless(
    pseudonyms: Pseudonyms, patient_id: UUID, session: Session, analysis: Analysis
) -> tuple[Session, Analysis]:
    """Both with our names for patient, recordings and sensors, and without findings, which may quote what was typed."""
    other = pseudonyms.session(patient_id, session)
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

    spans = tuple(
        Calibration(tuple(names[name] for name in span.walks), {j: joint(found) for j, found in span.joints.items()})
        for span in analysis.calibrations
    )
    recordings = tuple(replace(r, name=names[r.name], folder=folders[r.name]) for r in analysis.recordings)
    return other, replace(analysis, calibrations=spans, recordings=recordings, findings=())


def nameless_once(session: Session, analysis: Analysis) -> tuple[Session, Analysis]:
    """As `nameless`, with a pseudonym that nothing else will have."""
    return nameless(Pseudonyms(secrets.token_bytes(32)), uuid4(), session, analysis)
