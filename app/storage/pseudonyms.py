"""Let a session leave the library without revealing whose it is.

A patient's pseudonym and the shift of the dates come from the library's key and the patient's row, so every export of
one patient has the same ones: visits can still be put together and in order, and nobody without the key gets back.
What may say a name is left out: notes, operator, software, keys and columns that mean nothing to us. Recordings get the
names that we give, sensors and their clocks are numbered. In place of the year of birth is the age at the visit,
90 and older as one. What somebody typed freely, device, aids, surface and conditions, leaves only where it is asked
for, each by itself; without their words conditions are numbered, so that equal ones are still equal. What was changed
at a prosthesis stays, part by part with its figures; what was typed of it leaves only where it is asked for. Goals
stay, without who agreed on them and what was typed of them. Sex, height, mass and sides stay. This is pseudonymous, not
anonymous: gait itself can be recognised. What limits the results stays, without the names in it.
"""

import base64
import datetime
import hmac
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from string import Formatter
from uuid import UUID

from app.storage.unit_of_work import DEMO
from app.wording.findings import SENTENCES
from core.alignment import FIGURES, AlignmentChange, PartChange
from core.body import Site
from core.findings import Finding, Severity
from core.goals import Goal
from core.samples import SensorInfo
from core.session import Patient, Recording, Session
from core.targets import tallies_of, with_tallies
from devices.files.imports import folder_for, free_name

AGE = "age_years"  # among what a patient's table of a session folder may hold beside what we read of it
OLDEST_REPORTED = 89  # older people are so few that the age alone identifies them
SEXES = ("female", "male", "other")
LETTERS = 8  # of a pseudonym: 40 bits, so that two of ten thousand patients hardly ever share one
LEAST_SHIFT, MOST_SHIFT = datetime.timedelta(days=30), datetime.timedelta(days=730)


class Typed(StrEnum):
    """What is typed freely, and may say a name."""

    DEVICE = "device"
    AIDS = "aids"
    SURFACE = "surface"
    CONDITIONS = "conditions"
    CHANGES = "changes"  # at a prosthesis


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

    def session(self, patient_id: UUID, session: Session, kept: Collection[Typed] = ()) -> Session:
        """`session` without what may say whose it is; of what was typed freely only what is `kept`."""
        sensors, conditions = _numbered(session), _conditions(session, is_kept=Typed.CONDITIONS in kept)
        clocks = _numbers("clock", (info.clock for info in session.sensors.values()))
        pseudonymised = replace(
            session,
            recordings=(),
            patient=self._patient(patient_id, session, kept),
            sensors={site: _sensor(info, sensors, clocks) for site, info in session.sensors.items()},
            started=self.shifted(patient_id, session.started),
            operator="",
            surface=session.surface if Typed.SURFACE in kept else "",
            notes="",
            software="",
            findings=(),
            unknown={},
        )
        names = {}
        for recording in session.recordings:
            own = self._recording(patient_id, recording, free_name(pseudonymised, recording.kind), sensors)
            own = replace(
                own,
                condition=conditions.get(recording.condition, ""),
                alignment=_alignment(recording.alignment, conditions, is_kept=Typed.CHANGES in kept),
            )
            names[recording.name] = own.name
            pseudonymised = replace(pseudonymised, recordings=(*pseudonymised.recordings, own))
        return replace(pseudonymised, findings=tuple(_findings(session.findings, names)))

    def _patient(self, patient_id: UUID, session: Session, kept: Collection[Typed]) -> Patient:
        reported, age = session.patient, age_in_words(session)
        return replace(
            reported,
            code=self.code(patient_id, session.is_simulated),
            birth_year=None,
            sex=reported.sex if reported.sex in SEXES else "",
            device=reported.device if Typed.DEVICE in kept else "",
            aids=reported.aids if Typed.AIDS in kept else "",
            goals=tuple(self._goal(patient_id, goal) for goal in reported.goals),
            unknown={AGE: age} if age else {},
        )

    def _goal(self, patient_id: UUID, goal: Goal) -> Goal:
        """A goal without who agreed on it and what was typed of it, its days as long before as all others."""

        def shifted(day: datetime.date | None) -> datetime.date | None:
            moved = self.shifted(patient_id, day.isoformat()) if day is not None else ""
            return datetime.date.fromisoformat(moved) if moved else None

        agreed, until, ended = shifted(goal.agreed), shifted(goal.until), shifted(goal.ended)
        own = replace(goal, by="", note="", ended_by="", until=until, ended=ended)
        return replace(own, agreed=agreed or datetime.date.min)

    def _recording(self, patient_id: UUID, recording: Recording, name: str, sensors: Mapping[str, str]) -> Recording:
        return replace(
            recording,
            name=name,
            folder=folder_for(name),
            imu={
                site: replace(block, sensor=sensors[block.sensor], unknown={}) for site, block in recording.imu.items()
            },
            started=self.shifted(patient_id, recording.started),
            note=with_tallies("", tallies_of(recording.note)),  # figures and words of the program's own
            unknown={},
        )

    def _drawn(self, what: str, patient_id: UUID) -> bytes:
        return hmac.digest(self._key, what.encode() + patient_id.bytes, "sha256")


def _findings(findings: Sequence[Finding], names: Mapping[str, str]) -> Iterator[Finding]:
    """What limits the results, as far as we have words for it, without names of files, columns and computers."""
    for one in findings:
        name, *sites = one.where.split(", ")
        if (
            one.severity is Severity.INFO
            or one.key not in SENTENCES
            or name not in names
            or not set(sites) <= set(Site)
        ):
            continue
        required = {part[1] for part in Formatter().parse(SENTENCES[one.key])}
        numbers = {
            key: "?" if isinstance(value, str) else value for key, value in one.numbers.items() if key in required
        }
        yield replace(one, where=", ".join([names[name], *sites]), numbers=numbers)


def age_in_words(session: Session) -> str:
    """The age in the year of the visit, "90+" from 90 on; empty where it is not known."""
    born, year = session.patient.birth_year, session.started[:4]
    if born is None or not (year.isascii() and year.isdigit()) or int(year) < born:
        return ""
    age_years = int(year) - born
    return str(age_years) if age_years <= OLDEST_REPORTED else f"{OLDEST_REPORTED + 1}+"


def _sensor(info: SensorInfo, names: Mapping[str, str], clocks: Mapping[str, str]) -> SensorInfo:
    return replace(info, serial=names.get(info.serial, ""), clock=clocks.get(info.clock, ""), unknown={})


def _alignment(
    reported: AlignmentChange | None, conditions: Mapping[str, str], *, is_kept: bool
) -> AlignmentChange | None:
    """What was changed, with our words for conditions. Without words what only they give is left out."""
    if reported is None:
        return None
    stated = (one if is_kept else _without_words(one) for one in reported.parts)
    parts = tuple(one for one in stated if one is not None)
    returns_to = conditions.get(reported.returns_to, "")
    return AlignmentChange(conditions.get(reported.since, ""), parts, returns_to) if parts or returns_to else None


def _without_words(reported: PartChange) -> PartChange | None:
    """The figures alone; None where there are none. A setting's number means nothing without its name."""
    figures = {name: getattr(reported, name) for name in FIGURES}
    return PartChange(reported.part, **figures) if any(figures.values()) else None


def _conditions(session: Session, *, is_kept: bool) -> Mapping[str, str]:
    typed = [recording.condition for recording in session.recordings]
    changes = [recording.alignment for recording in session.recordings if recording.alignment is not None]
    typed += [name for change in changes for name in (change.since, change.returns_to)]
    return {one: one for one in typed} if is_kept else _numbers("condition", typed)


def _numbered(session: Session) -> Mapping[str, str]:
    """A name of ours for each sensor: another program may have called it after whom it was worn by."""
    names = [info.serial for info in session.sensors.values() if info.serial]
    names += [block.sensor for recording in session.recordings for block in recording.imu.values()]
    return {name: f"sensor {number}" for number, name in enumerate(dict.fromkeys(names), 1)}


def _numbers(word: str, names: Iterable[str]) -> Mapping[str, str]:
    """A number for each name that is not empty, the same for the same."""
    return {name: f"{word} {number}" for number, name in enumerate(dict.fromkeys(filter(None, names)), 1)}
