"""Two stations edit the same patients, sessions and recordings at once. Check that no acknowledged edit is lost.

    python -m tests.safety.concurrent_edits --edits 500              # an encrypted file of its own
    python -m tests.safety.concurrent_edits --edits 500 --postgres   # a PostgreSQL of its own
    python -m tests.safety.concurrent_edits --url postgresql+psycopg://...   # an empty database

Each station is a process. It edits on what it was shown last, which is often old, with words and numbers that occur
once, and answers what is asked about by chance. Afterwards the histories of both, the rows and the audit have to agree.
"""

import argparse
import itertools
import json
import multiprocessing
import random
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from uuid import UUID

from app.storage.database.engine import Database, postgres_engine, sqlite_engine
from app.storage.edited_fields import patient_fields, recording_fields, session_fields
from app.storage.layout import DATABASE
from app.storage.library import Library
from app.storage.stored import Change, Operator, Role
from app.storage.three_way import Value, Values
from core.session import Patient, Recording, RecordingKind, Session
from tests.driver import Found, drive
from tests.safety.clinic_material import own_server

DATA_KEY = bytes(range(32))
STATIONS = ("aa", "bb")
PATIENTS = 3
MOST = 10_000_000
OLD = 0.7  # the share of edits that are made on what was shown before, not read again
NUMBERS = ("height_m", "mass_kg", "zero_rad.left_knee", "zero_rad.right_ankle")
EDITED: Mapping[str, tuple[str, ...]] = {
    "patients": ("height_m", "mass_kg", "device", "aids"),
    "sessions": ("comment", "notes", "surface", "zero_rad.left_knee", "zero_rad.right_ankle"),
    "recordings": ("condition", "note", "left_out_s.left", "left_out_s.right"),
}


@dataclass(frozen=True, slots=True)
class Thing:
    """A row that is edited."""

    table: str
    id: UUID


def open_station(url: str) -> Library:
    """A connection of its own, as another computer has."""
    is_file = "://" not in url
    engine = sqlite_engine(Path(url) / DATABASE, DATA_KEY) if is_file else postgres_engine(url)
    return Library(Database(engine, busy_s=60.0), DATA_KEY)


def prepare(url: str) -> list[Thing]:
    """Patients with a session and a walk each."""
    with open_station(url) as library:
        library.begin(Operator("hk", "H. Keller", Role.ADMINISTRATOR))
        things = []
        for code in STATIONS:
            library.operators.add(Operator(code, f"Station {code}", Role.CLINICIAN))
        for number in range(PATIENTS):
            patient = library.patients.create(Patient(f"P-{number}"))
            visit = library.sessions.create(patient.id, Session(()))
            reported = Recording("walk 1", RecordingKind.WALKING, "walk_1", {})
            walk = library.recordings.start(visit.id, reported, is_simulated=False)
            things += [Thing("patients", patient.id), Thing("sessions", visit.id), Thing("recordings", walk.id)]
        return things


def held(library: Library, thing: Thing) -> dict[str, Value]:
    """The fields as the library has them now."""
    if thing.table == "patients":
        return patient_fields(library.patients.get(thing.id).details)
    if thing.table == "sessions":
        visit = library.sessions.get(thing.id)
        return session_fields(visit.details, visit.comment, visit.limits)
    recording = library.recordings.find(thing.id)
    assert recording is not None
    return recording_fields(recording.details)


class Station:
    """Edits, and notes what was acknowledged: the row, the field, on what, and what was stated."""

    def __init__(self, code: str, url: str, things: list[Thing], seed: int) -> None:
        self._code, self._things, self._chance = code, things, random.Random(f"{code} {seed}")
        self._library = open_station(url)
        self._library.log_in(code)
        self._count = itertools.count(1)
        self._shown = {thing: held(self._library, thing) for thing in things}
        self.log: list[dict[str, Any]] = []

    def work(self, edits: int) -> None:
        for _ in range(edits):
            thing = self._chance.choice(self._things)
            if self._chance.random() > OLD:
                self._shown[thing] = held(self._library, thing)
            base = self._shown[thing]
            names = self._chance.sample(EDITED[thing.table], k=self._chance.randint(1, 3))
            self._edit(thing, base, {**base, **{name: self._value(name, base[name]) for name in names}})
        self._library.close()

    def _edit(self, thing: Thing, base: Values, stated: Values) -> None:
        edits = self._library.edits
        edit: Callable[[UUID, Values, Values], Any] = {
            "patients": edits.patient,
            "sessions": edits.session,
            "recordings": edits.recording,
        }[thing.table]
        edited = edit(thing.id, base, stated)
        contested = {contest.field for contest in edited.contests}
        for name, value in stated.items():
            if value != base[name]:
                note = {"upon": base[name], "said": value, "is_contested": name in contested}
                self.log.append({"row": str(thing.id), "table": thing.table, "field": name, **note})
        self.log += [{"is_merge": True}] * len(edited.others)
        self._shown[thing] = held(self._library, thing)
        asked = [contest for contest in edited.contests if self._chance.random() < 0.5]
        if asked:  # ours is chosen, on what the question showed
            theirs = {contest.field: contest.theirs for contest in asked}
            self._edit(thing, theirs, {contest.field: contest.mine for contest in asked})

    def _value(self, name: str, before: Value) -> Value:
        number = next(self._count) * len(STATIONS) + STATIONS.index(self._code)
        if isinstance(before, tuple):
            return tuple(sorted((*before, float(number))))
        if name == "height_m":
            return 1.0 + number * 1e-5
        if name == "mass_kg":
            return 40.0 + number * 1e-3
        return number * 1e-5 if name in NUMBERS else f"{self._code} {number}"


def run_station(code: str, url: str, things: list[Thing], edits: int, seed: int, out: Path, gate: Any) -> None:
    station = Station(code, url, things, seed)
    gate.wait()  # both begin at once
    station.work(edits)
    (out / f"{code}.json").write_text(json.dumps(station.log), encoding="utf-8")


def judge(url: str, things: list[Thing], logs: Mapping[str, list[dict[str, Any]]]) -> Found:
    """Compare what both stations were reported with histories, rows, versions and audit."""
    verdict = Found()
    with open_station(url) as library:
        library.log_in("hk")
        for patient in {thing.id for thing in things if thing.table == "patients"}:
            _judge_patient(library, patient, logs, verdict)
        report = library.audit.verify()
        verdict.faults += [f"audit {fault.number}: {fault.what}" for fault in report.faults]
        noted = sum('"correction"' in entry.details for entry in library.audit.entries(last=MOST))
        if noted != verdict.count["corrections"]:
            verdict.faults.append(f"{noted} entries of the audit tell of {verdict.count['corrections']} corrections")
    verdict.count["contested"] = sum(bool(one.get("is_contested")) for log in logs.values() for one in log)
    verdict.count["merged of the other's"] = sum(bool(one.get("is_merge")) for log in logs.values() for one in log)
    return verdict


def _judge_patient(
    library: Library, patient_id: UUID, logs: Mapping[str, list[dict[str, Any]]], verdict: Found
) -> None:
    visits = [library.sessions.get(line.id) for line in library.sessions.list(patient_id)]
    rows = {patient_id: library.patients.get(patient_id).version}
    rows |= {visit.id: visit.version for visit in visits}
    rows |= {walk.id: walk.version for visit in visits for walk in visit.recordings}
    history = sorted(library.corrections.of_patient(patient_id), key=lambda one: one.id)
    verdict.count["corrections"] += len(history)
    taken_back = {one.undoes for one in history} | {one.id for one in history if one.undoes}
    reported = {
        (code, one["row"], one["field"].partition(".")[0], json.dumps(one["said"])): one
        for code, log in logs.items()
        for one in log
        if "row" in one and UUID(one["row"]) in rows
    }
    versions = Counter(dict.fromkeys(rows, 1))
    values: dict[tuple[UUID, str], object] = {}
    made: set[tuple[str, str, object]] = set()
    for correction in history:
        versions.update({_owner(change, visits): 1 for change in correction.changes})
        for change in correction.changes:
            key = (change.row, change.field)
            if values.get(key, change.old) != change.old:
                verdict.faults.append(f"{key}: {change.old} was replaced, but it held {values[key]}")
            values[key] = change.new
            made.add((correction.operator, change.field, change.new))
            name = (correction.operator, str(_owner(change, visits)), change.field, json.dumps(change.new))
            if correction.id not in taken_back and name in reported and reported[name]["upon"] != change.old:
                latest = [one for one in _all(logs, name) if one["upon"] == change.old]
                if not latest:  # a value was overwritten that this station had never been shown
                    verdict.faults.append(f"{name} overwrote {change.old} unseen")
    for row, version in rows.items():
        if versions[row] != version:
            verdict.faults.append(f"{row} has version {version}, {versions[row] - 1} corrections")
    for (operator, row, name, stated), _ in reported.items():
        if name == "left_out_s":
            continue
        verdict.count["values acknowledged"] += 1
        if (operator, name, json.loads(stated)) not in made:
            verdict.faults.append(f"{stated} of {operator} is not in the history of {row}")
    _judge_strides(library, rows, logs, verdict)


def _all(logs: Mapping[str, list[dict[str, Any]]], name: tuple[str, str, str, str]) -> Iterator[dict[str, Any]]:
    operator, row, column, stated = name
    for one in logs[operator]:
        is_of_row = "row" in one and one["row"] == row and one["field"].partition(".")[0] == column
        if is_of_row and json.dumps(one["said"]) == stated:
            yield one


def _owner(change: Change, visits: Any) -> UUID:
    """The row whose version counts a change: of a joint its session's, the only one that a patient has here."""
    owner: UUID = visits[0].id if change.table == "joints" else change.row
    return owner


def _judge_strides(
    library: Library, rows: Mapping[UUID, int], logs: Mapping[str, list[dict[str, Any]]], verdict: Found
) -> None:
    """No stride that anybody left out counts again: nobody has taken one in."""
    for log in logs.values():
        for one in log:
            if "row" in one and one["field"].startswith("left_out_s") and UUID(one["row"]) in rows:
                verdict.count["values acknowledged"] += 1
                now = held(library, Thing("recordings", UUID(one["row"])))[one["field"]]
                assert isinstance(now, tuple)
                if not set(one["said"]) <= set(now):
                    verdict.faults.append(f"{one['row']}: {set(one['said']) - set(now)} s count again")


def run(url: str, edits: int, seed: int = 1) -> Found:
    """Let both stations edit, each `edits` times, and judge what came of it."""
    things = prepare(url)
    context = multiprocessing.get_context("spawn")
    gate = context.Barrier(len(STATIONS))
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        made = [
            context.Process(target=run_station, args=(code, url, things, edits, seed, out, gate)) for code in STATIONS
        ]
        for process in made:
            process.start()
        for process in made:
            process.join()
        if any(process.exitcode for process in made):
            return Found(faults=[f"stations ended with {[process.exitcode for process in made]}"])
        logs = {code: json.loads((out / f"{code}.json").read_text(encoding="utf-8")) for code in STATIONS}
    return judge(url, things, logs)


def run_at(asked: argparse.Namespace, folder: Path) -> Found:
    if asked.url:
        return run(asked.url, asked.edits, asked.seed)
    if asked.postgres:
        with own_server(folder / "pg") as server:
            address = server.database().replace("postgresql://", "postgresql+psycopg://", 1)
            return run(address, asked.edits, asked.seed)
    return run(str(folder), asked.edits, asked.seed)


if __name__ == "__main__":
    drive(
        __doc__,
        run_at,
        edits=(500, "of each station"),
        seed=1,
        url=("", "an empty PostgreSQL database, as SQLAlchemy writes it, or an empty folder"),
        postgres=(False, "a PostgreSQL of its own"),
    )
