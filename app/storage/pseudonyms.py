"""How does a session leave the library so that it does not say whose it is?

A patient's pseudonym and the shift of the dates come from the library's key and the patient's row, so every export of
one patient has the same ones: visits can still be put together and in order, and nobody without the key gets back.
What may say a name is left out: notes, operator, keys and columns that mean nothing to us. Recordings get the names
that we give, sensors are numbered. What is needed to read the angles stays as it was typed: year of birth, sex,
height, mass, sides, device, aids, surface and conditions. This is pseudonymous, not anonymous: gait itself can be
recognised.
"""

import base64
import datetime
import hmac
from collections.abc import Mapping
from dataclasses import replace
from uuid import UUID

from app.storage.desk import DEMO
from core.samples import Recording, Session
from devices.files.imports import folder_for, free_name

LETTERS = 8  # of a pseudonym: 40 bits, so that two of ten thousand patients hardly ever share one
LEAST_SHIFT, MOST_SHIFT = datetime.timedelta(days=30), datetime.timedelta(days=730)


class Pseudonyms:
    """Those of one library, whose `pseudonyms_key` it is."""

    def __init__(self, key: bytes) -> None:
        self._key = key

    def code(self, patient_id: UUID, is_simulated: bool = False) -> str:
        """Like P-7Q2M4XKA; simulated ones stay known as such."""
        letters = base64.b32encode(self._drawn("code", patient_id)).decode()[:LETTERS]
        return f"{DEMO if is_simulated else 'P'}-{letters}"

    def shifted(self, patient_id: UUID, when: str) -> str:
        """An ISO 8601 date or time as long before as all of this patient's; empty where it is none."""
        seconds = int.from_bytes(self._drawn("dates", patient_id)[:8], "big")
        shift = LEAST_SHIFT + datetime.timedelta(seconds=seconds % int((MOST_SHIFT - LEAST_SHIFT).total_seconds()))
        try:
            if len(when) == len("2026-11-21"):
                return (datetime.date.fromisoformat(when) - shift).isoformat()
            return (datetime.datetime.fromisoformat(when) - shift).isoformat()
        except (ValueError, OverflowError):
            return ""

    def session(self, patient_id: UUID, session: Session) -> Session:
        """`session` without what may say whose it is."""
        sensors = _numbered(session)
        nameless = replace(
            session,
            recordings=(),
            patient=replace(session.patient, code=self.code(patient_id, session.is_simulated), unknown={}),
            sensors={
                site: replace(info, serial=sensors.get(info.serial, ""), unknown={})
                for site, info in session.sensors.items()
            },
            started=self.shifted(patient_id, session.started),
            operator="",
            notes="",
            findings=(),
            unknown={},
        )
        for recording in session.recordings:
            own = self._recording(patient_id, recording, free_name(nameless, recording.kind), sensors)
            nameless = replace(nameless, recordings=(*nameless.recordings, own))
        return nameless

    def _recording(self, patient_id: UUID, recording: Recording, name: str, sensors: Mapping[str, str]) -> Recording:
        return replace(
            recording,
            name=name,
            folder=folder_for(name),
            imu={
                site: replace(block, sensor=sensors[block.sensor], unknown={}) for site, block in recording.imu.items()
            },
            started=self.shifted(patient_id, recording.started),
            note="",
            unknown={},
        )

    def _drawn(self, what: str, patient_id: UUID) -> bytes:
        return hmac.digest(self._key, what.encode() + patient_id.bytes, "sha256")


def _numbered(session: Session) -> dict[str, str]:
    """A name of ours for each sensor: another program may have called it after whom it was worn by."""
    names = [info.serial for info in session.sensors.values() if info.serial]
    names += [block.sensor for recording in session.recordings for block in recording.imu.values()]
    return {name: f"sensor {number}" for number, name in enumerate(dict.fromkeys(names), 1)}
