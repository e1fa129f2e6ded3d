"""Two stations edit the same patients, sessions and recordings at full speed. Check that every edit is there, once.

Each station is a process. An edit that is refused because somebody else was quicker is read again and tried again; one
that was taken is noted in a file of the station's own. Afterwards the server's tables are compared with these notes,
by SQL alone: nothing of the application is asked but whether the audit's keyed hashes are right.
"""

import json
import random
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from uuid import UUID

from app.storage.opened import open_library
from app.storage.stored import (
    ChangedMeanwhileError,
    LibraryError,
    PlacedSensor,
    StoredPatient,
    StoredRecording,
    StoredSession,
)
from core.samples import SensorInfo
from tests.driver import Found, options
from tests.safety.clinic_material import CODES, OPERATORS, PASSPHRASE, Clinic, Row, read_lines, rows_of

FIELDS = {"patients": ("height_m", "aids"), "sessions": ("notes",), "recordings": ("condition", "is_kept", "note")}
VERSIONED = ("patients", "sessions", "recordings", "operators")
SHARED_SETTING = "shared"
FORGOTTEN_S = 3600


def edit_together(clinic: Clinic, folder: Path, edits: int, seed: int) -> Found:
    """All stations of `clinic` at once, so many edits in all."""
    before = _tables(clinic.address)
    notes = [folder / f"edits-{code}" for code in OPERATORS]
    commands = [
        [
            *(sys.executable, "-m", "tests.safety.station_edits", str(station), code, str(note)),
            *("--seed", str(seed + k), "--edits", str(edits // len(OPERATORS))),
        ]
        for k, (station, code, note) in enumerate(zip(clinic.stations, OPERATORS, notes, strict=True))
    ]
    running = [subprocess.Popen(command, cwd=Path(__file__).parents[2]) for command in commands]
    found = Found()
    if sum(abs(one.wait(FORGOTTEN_S)) for one in running):
        found.faults.append("a station ended by itself")
    taken = [row for note in notes for row in read_lines(note)]
    found.count["edits taken"] = len(taken)
    found.count["refused and tried again"] = sum(row["refused"] for row in taken)
    found.faults += _judge(before, _tables(clinic.address), taken)
    with open_library(clinic.stations[0], PASSPHRASE, OPERATORS[0]) as opened:
        found.faults += [f"audit {fault.number} {fault.what}" for fault in opened.library.audit.verify().faults]
    return found


# what a station does


class Editor:
    """One station's hands."""

    def __init__(self, folder: Path, code: str, note: Path, seed: int) -> None:
        self.code, self._rng, self._note = code, random.Random(seed), note.open("a")
        self._opened = open_library(folder, PASSPHRASE, code)
        self._library = self._opened.library
        patients = [self._library.patients.find(one) for one in CODES]
        self._patients = [one.id for one in patients if one is not None]
        self._visits = [line.id for line in self._library.sessions.list()]
        self._number = 0
        # rarely what makes a visit longer: it is read whole for every edit
        self._kinds: Sequence[tuple[Callable[[], Row], float]] = (
            (self._height, 10),
            (self._aids, 10),
            (self._notes, 10),
            (self._recording, 20),
            (self._kept, 10),
            (self._deleted, 5),
            (self._patient_deleted, 5),
            (self._operator, 5),
            (self._setting, 5),
            (self._undone, 5),
            (self._placed, 0.5),
            (self._placement_corrected, 0.5),
        )

    def edit(self) -> None:
        """Make one edit, however often it is refused."""
        ways, weights = zip(*self._kinds, strict=True)
        (way,) = self._rng.choices(ways, weights)
        self._number += 1
        refused = 0
        while True:
            try:
                done = way()
                break
            except ChangedMeanwhileError:
                refused += 1
        self._note.write(json.dumps({**done, "by": self.code, "number": self._number, "refused": refused}) + "\n")
        self._note.flush()

    @property
    def _word(self) -> str:
        return f"{self.code} {self._number}"

    def _patient(self) -> StoredPatient:
        return self._library.patients.get(self._rng.choice(self._patients))

    def _visit(self) -> StoredSession:
        return self._library.sessions.get(self._rng.choice(self._visits))

    def _one_recording(self) -> StoredRecording:
        return self._rng.choice(self._visit().recordings)

    def _height(self) -> Row:
        patient = self._patient()
        height_m = 1.0 + self._number * 1e-5 + OPERATORS.index(self.code) * 5e-6
        now = self._library.patients.change(patient, replace(patient.details, height_m=height_m))
        return corrected("patients", patient.id, now.version, about_patient(patient.id), height_m=height_m)

    def _aids(self) -> Row:
        patient = self._patient()
        now = self._library.patients.change(patient, replace(patient.details, aids=self._word))
        return corrected("patients", patient.id, now.version, about_patient(patient.id), aids=self._word)

    def _notes(self) -> Row:
        visit = self._visit()
        now = self._library.sessions.change(visit, replace(visit.details, notes=self._word))
        return corrected("sessions", visit.id, now.version, about_session(visit.id), notes=self._word)

    def _recording(self) -> Row:
        one = self._one_recording()
        now = self._library.recordings.change(one, replace(one.details, condition=self._word, note=self._word))
        subject = about_session(one.session_id)
        return corrected("recordings", one.id, now.version, subject, condition=self._word, note=self._word)

    def _kept(self) -> Row:
        one = self._one_recording()
        now = self._library.recordings.decide(one, not one.details.is_kept)
        audits = [about_session(one.session_id), f"recording:{one.id}"]
        return edited("recordings", one.id, now.version, audits) | {"corrections": 1}

    def _deleted(self) -> Row:
        visit = self._visit()
        sessions = self._library.sessions
        (sessions.restore if visit.deleted_at else sessions.delete)(visit)
        return edited("sessions", visit.id, visit.version + 1, [about_session(visit.id)])

    def _patient_deleted(self) -> Row:
        patient, patients = self._patient(), self._library.patients
        now = (patients.restore if patient.deleted_at else patients.delete)(patient)
        return edited("patients", patient.id, now.version, [about_patient(patient.id)])

    def _operator(self) -> Row:
        operator = next(one for one in self._library.operators.list() if one.code == OPERATORS[0])
        now = self._library.operators.change(replace(operator, name=self._word))
        return edited("operators", operator.code, now.version, [f"operator:{operator.code}"])

    def _setting(self) -> Row:
        name = self._rng.choice([SHARED_SETTING, self.code])
        self._library.settings.put(name, self._word)
        return {"audits": [f"setting:{name}"], "setting": name, "value": self._word}

    def _undone(self) -> Row:
        visit = self._visit()
        history = [one for one in self._library.corrections.of_session(visit.id)[:5] if not one.is_undone]
        if not history:
            return self._notes()
        correction = history[0]
        try:
            self._library.corrections.undo(correction.id)
        except ChangedMeanwhileError:
            raise
        except LibraryError as refusal:  # it was undone already: somebody else was quicker
            raise ChangedMeanwhileError(refusal.what, refusal.remedy) from refusal
        rows = {(change.table, str(change.row)) for change in correction.changes}
        return {"bumped": sorted(rows), "audits": [about_session(visit.id)], "corrections": 1}

    def _placed(self) -> Row:
        visit = self._visit()
        self._library.sessions.place(visit.id, visit.placements[-1].sensors)
        return {"audits": [about_session(visit.id)], "placements": 1}

    def _placement_corrected(self) -> Row:
        visit = self._visit()
        one = self._rng.choice(visit.recordings)
        seen = {one.id: one.placement.id if one.placement is not None else None}
        sensors = visit.placements[-1].sensors
        worn = {**sensors, self._rng.choice(list(sensors)): PlacedSensor(self._word, SensorInfo())}
        try:
            now = self._library.edits.placement(visit.id, seen, [([one.id], worn)])
        except LibraryError as refusal:  # the session was deleted
            raise ChangedMeanwhileError(refusal.what, refusal.remedy) from refusal
        times = 2 if now.contests else 1  # made and taken back: somebody else was quicker
        row, subject = ("recordings", str(one.id)), about_session(visit.id)
        return {"bumped": [row] * times, "audits": [subject] * times, "corrections": times, "placements": 1}


def about_patient(row: UUID) -> str:
    return f"patient:{row}"


def about_session(row: UUID) -> str:
    return f"session:{row}"


def edited(table: str, row: UUID | str, version: int, audits: list[str]) -> Row:
    """One row has gone on to `version`; the audit has one more entry about each of `audits`."""
    return {"bumped": [(table, str(row))], "version": version, "audits": audits}


def corrected(table: str, row: UUID, version: int, subject: str, **new: object) -> Row:
    """As `edited`, and the history has one more correction, with these values that no other one has."""
    return edited(table, row, version, [subject]) | {"corrections": 1, "new": new}


# what came of it, as the server's tables report


def _tables(address: str) -> dict[str, list[Row]]:
    tables = (*VERSIONED, "settings", "placements", "corrections", "audit")
    return {table: rows_of(address, f"SELECT * FROM {table}") for table in tables}


def _judge(before: dict[str, list[Row]], after: dict[str, list[Row]], taken: list[Row]) -> list[str]:
    """What is not as it was noted."""
    return [
        *_versions(before, after, taken),
        *_history(before, after, taken),
        *_audit(before["audit"], after["audit"], taken),
        *_settings(after["settings"], taken),
        *_counted("placements", before, after, sum(row.get("placements", 0) for row in taken)),
    ]


def _counted(table: str, before: dict[str, list[Row]], after: dict[str, list[Row]], needed: int) -> list[str]:
    grown = len(after[table]) - len(before[table])
    return [] if grown == needed else [f"{grown} {table} came, not {needed}"]


def _versions(before: dict[str, list[Row]], after: dict[str, list[Row]], taken: list[Row]) -> list[str]:
    """Each edit has made its row's version one more; no two made the same one."""
    bumps = Counter(tuple(one) for row in taken for one in row.get("bumped", ()))
    reached = Counter((*map(tuple, row["bumped"]), row["version"]) for row in taken if "version" in row)
    faults = [f"version {version} of {one} was made twice" for (one, version), n in reached.items() if n > 1]
    for table in VERSIONED:
        key = "code" if table == "operators" else "id"
        was = {str(row[key]): row["version"] for row in before[table]}
        for row in after[table]:
            grown, needed = row["version"] - was[str(row[key])], bumps[table, str(row[key])]
            if grown != needed:
                faults.append(f"{table} {row[key]}: {grown} versions for {needed} edits")
    return faults


def _history(before: dict[str, list[Row]], after: dict[str, list[Row]], taken: list[Row]) -> list[str]:
    """Each correction is there once, and begins with what the one before ended with."""
    faults = _counted("corrections", before, after, sum(row.get("corrections", 0) for row in taken))
    known = {row["id"] for row in before["corrections"]}
    came = sorted((row for row in after["corrections"] if row["id"] not in known), key=lambda row: int(row["number"]))
    numbers = [row["number"] for row in sorted(after["corrections"], key=lambda row: int(row["number"]))]
    if numbers != list(range(1, len(numbers) + 1)):
        faults.append("the corrections' numbers have gaps, or come twice")
    now = {
        (table, str(row["id"]), name): row[name] for table in FIELDS for row in before[table] for name in FIELDS[table]
    }
    seen: Counter[tuple[str, object]] = Counter()
    for correction in came:
        for change in correction["changes"]:
            place = (change["table"], change["row"], change["field"])
            if change["field"] == "placement_id":
                continue
            if now[place] != change["old"]:
                faults.append(f"correction {correction['number']} of {place} begins with another value: one was lost")
            now[place] = change["new"]
            if correction["undoes_id"] is None:
                seen[f"{change['row']} {change['field']}", change["new"]] += 1
    for row in taken:
        for name, value in row.get("new", {}).items():
            ((_, row_id),) = row["bumped"]
            if seen[f"{row_id} {name}", value] != 1:
                faults.append(f"{row['by']} {row['number']}: in the history {seen[f'{row_id} {name}', value]} times")
    held = {
        (table, str(row["id"]), name): row[name] for table in FIELDS for row in after[table] for name in FIELDS[table]
    }
    faults += [f"{place} holds what no correction says" for place, value in held.items() if now[place] != value]
    return faults


def _audit(before: list[Row], after: list[Row], taken: list[Row]) -> list[str]:
    """As many entries about each as were noted, the logins besides; every link follows from the one before."""
    faults = []
    entries = sorted(after, key=lambda row: int(row["number"]))
    if [row["number"] for row in entries] != list(range(1, len(entries) + 1)):
        faults.append("the audit's numbers have gaps")
    previous = "0" * 64
    for row in entries:
        if row["previous_hash"] != previous:
            faults.append(f"audit {row['number']} does not follow")
        previous = row["hash"]
    came = Counter(row["subject"] for row in entries[len(before) :])
    needed = Counter(subject for row in taken for subject in row["audits"]) + Counter(
        f"operator:{code}" for code in OPERATORS
    )
    faults += [
        f"audit of {subject}: {came[subject]} entries, {needed[subject]} wanted"
        for subject in came.keys() | needed.keys()
        if came[subject] != needed[subject]
    ]
    return faults


def _settings(after: list[Row], taken: list[Row]) -> list[str]:
    """A station's own setting is what it put last; of the shared one, what one of them put last."""
    held = {row["name"]: row["value"] for row in after}
    last = {(row["setting"], row["by"]): row["value"] for row in taken if "setting" in row}
    faults = [
        f"setting {name} is not what was put last"
        for (name, by), value in last.items()
        if name == by and held[name] != value
    ]
    shared = [value for (name, _), value in last.items() if name == SHARED_SETTING]
    if shared and held[SHARED_SETTING] not in shared:
        faults.append("the shared setting is not what anybody put last")
    return faults


def main() -> None:
    asked = options(__doc__, folder=Path, code=str, note=Path, edits={"type": int, "required": True}, seed=1)
    editor = Editor(asked.folder, asked.code, asked.note, asked.seed)
    for _ in range(asked.edits):
        editor.edit()


if __name__ == "__main__":
    main()
