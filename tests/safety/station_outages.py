"""Stations record while the server is stopped, the shared place is taken away, and they themselves are killed.

Afterwards, with server and place back, each station is started once more. Every journal that any of them had on its
disk has to be in the library once, handed over once, byte for byte, and readable at the other station.
"""

import hashlib
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from itertools import cycle
from pathlib import Path
from uuid import UUID

import numpy as np

from app.storage.clinic.handing_over import begin_station, hand_over
from app.storage.journal.header import JournalRefusedError
from app.storage.journal.reader import JournalReader
from app.storage.journal.records import Record, RecordKind
from app.storage.layout import SUFFIX
from app.storage.opened import held_alone, open_library
from app.storage.stored import LibraryError, PlacedSensor
from core.samples import IntArray, SensorInfo
from core.session import Patient, Session
from tests.driver import Found
from tests.safety.clinic_material import OPERATORS, PASSPHRASE, Clinic, OwnServer, Row, read_lines, rows_of
from tests.safety.live_material import LOOP, numbered_session
from tests.safety.station_life import ADOPTING, HANDING_OVER, RECORDING, STOP, is_at, read_all_of, recover_all

MOMENTS = {RECORDING: "recording", HANDING_OVER: "handing over", ADOPTING: "adopting", -1: "at any instant"}
STOPPED = "times the server was stopped"
LOOKED_S, FORGOTTEN_S = 0.002, 180.0
REQUIRED_S = 3.0  # so long a moment to kill at is waited for


def live_through_outages(clinic: Clinic, server: OwnServer, folder: Path, outage_s: float, seed: int) -> Found:
    """For `outage_s` seconds; then all has to come to rest."""
    storm = _Storm(clinic, server, folder, seed)
    storm.rage(outage_s)
    storm.calm()
    _settle(clinic, storm.found)
    _judge(clinic, storm)
    return storm.found


class _Storm:
    """What happens to a clinic, and what was on its stations' disks meanwhile."""

    def __init__(self, clinic: Clinic, server: OwnServer, folder: Path, seed: int) -> None:
        self.clinic, self.found, self.session_id = clinic, Found(), _visit(clinic)
        self.sha256_of: dict[str, str] = {}
        self.noted = folder / "notes"
        self.noted.mkdir()
        self._moments = cycle(MOMENTS)
        self._server, self._rng = server, random.Random(seed)
        self._is_up = self._is_place_there = True
        self._away = clinic.place.with_name("taken away")
        command = [sys.executable, "-m", "tests.safety.station_life"]
        root, pipe = Path(__file__).parents[2], subprocess.PIPE
        with (folder / "said").open("w") as stated:
            self._nursery = subprocess.Popen(command, cwd=root, stdin=pipe, stdout=pipe, stderr=stated, text=True)
        assert self._nursery.stdout is not None
        self._nursery.stdout.readline()  # it has loaded everything
        self._living = {code: self._start(code) for code in OPERATORS}
        while not all(is_at(self.noted / f"{code}.moments", RECORDING) for code in OPERATORS):
            time.sleep(LOOKED_S)

    def rage(self, outage_s: float) -> None:
        end_s = time.monotonic() + outage_s
        due_s = {
            what: time.monotonic() + self._rng.uniform(2.0, 6.0) for what in (self._switch, self._take, self._kill)
        }
        while time.monotonic() < end_s or not self.found.count[STOPPED]:  # on a busy machine a kill takes seconds
            what = min(due_s, key=lambda one: due_s[one])
            time.sleep(max(0.0, due_s[what] - time.monotonic()))
            what()
            due_s[what] = time.monotonic() + self._rng.uniform(1.0, 6.0)

    def calm(self) -> None:
        """Server and place are back; the stations end by themselves."""
        if not self._is_up:
            self._switch()
        if not self._is_place_there:
            self._take()
        (self.noted / STOP).touch()
        for code in self._living:
            if status := self._ended(code):
                self.found.faults.append(f"station {code} ended by itself, with {status}")
            self._look_at_disk(code)
        assert self._nursery.stdin is not None
        self._nursery.stdin.close()
        self._nursery.wait(FORGOTTEN_S)
        assert self._nursery.stdout is not None
        self._nursery.stdout.close()

    def _start(self, code: str) -> int:
        station = self.clinic.stations[OPERATORS.index(code)]
        reported = {"folder": str(station), "code": code, "session": str(self.session_id), "notes": str(self.noted)}
        return self._ask(reported)

    def _ended(self, code: str) -> int:
        """How a station ended, once it has: the signal's number, negative, where it was killed."""
        return self._ask({"ended": self._living[code]})

    def _ask(self, reported: dict[str, object] | dict[str, str] | dict[str, int]) -> int:
        assert self._nursery.stdin is not None
        assert self._nursery.stdout is not None
        print(json.dumps(reported), file=self._nursery.stdin, flush=True)
        return int(self._nursery.stdout.readline())

    def _switch(self) -> None:
        if self._is_up:
            self._server.kill()
            self.found.count[STOPPED] += 1
        else:
            self._server.start()
        self._is_up = not self._is_up

    def _take(self) -> None:
        if self._is_place_there:
            self.clinic.place.rename(self._away)
            self.found.count["times the place was taken"] += 1
        else:
            self._away.rename(self.clinic.place)
        self._is_place_there = not self._is_place_there

    def _kill(self) -> None:
        """Kill a station at the moment whose turn it is, where that can be had, and start it again."""
        code, moment = self._rng.choice(OPERATORS), next(self._moments)
        if moment == ADOPTING:  # which it does at its start
            self._end(code)
        wish, give_up_s = self.noted / f"{code}.wish", time.monotonic() + REQUIRED_S
        if moment >= 0:
            wish.with_suffix(".new").write_text(str(moment))
            wish.with_suffix(".new").replace(wish)
        while wish.exists() and time.monotonic() < give_up_s:
            time.sleep(LOOKED_S)
        if moment < 0 or wish.exists():
            wish.unlink(missing_ok=True)
            moment = -1
            time.sleep(self._rng.uniform(0.0, 0.02))
            os.kill(self._living[code], signal.SIGKILL)
        self._end(code, is_killed=True)
        self.found.count[f"killed {MOMENTS[moment]}"] += 1

    def _end(self, code: str, *, is_killed: bool = False) -> None:
        """Kill a station, unless it was, and start it again."""
        if not is_killed:
            os.kill(self._living[code], signal.SIGKILL)
        if (status := self._ended(code)) >= 0:
            self.found.faults.append(f"station {code} ended by itself, with {status}")
        (self.noted / f"{code}.moments").unlink(missing_ok=True)
        self._look_at_disk(code)
        self._living[code] = self._start(code)

    def _look_at_disk(self, code: str) -> None:
        """Nobody writes there now: what is there is what has to be in the library."""
        for path in (self.clinic.stations[OPERATORS.index(code)] / "recordings").glob(f"*{SUFFIX}"):
            sha256 = _sha256(path)
            if self.sha256_of.setdefault(path.name, sha256) != sha256:
                self.found.faults.append(f"{path.name} was changed on the station's disk")


def _visit(clinic: Clinic) -> UUID:
    """A session in which the sensors that are played are worn."""
    imu = numbered_session("a", 2).recordings[0].imu
    with open_library(clinic.stations[0], PASSPHRASE, OPERATORS[0]) as opened:
        patient = opened.library.patients.create(Patient(code="DEMO-3"))
        visit = opened.library.sessions.create(patient.id, Session(()))
        opened.library.sessions.place(visit.id, {site: PlacedSensor(imu[site].sensor, SensorInfo()) for site in imu})
        return visit.id


def _settle(clinic: Clinic, found: Found) -> None:
    """Each station is started twice more, without haste."""
    for code, station in zip(OPERATORS, clinic.stations, strict=True):
        for _ in range(2):
            with open_library(station, PASSPHRASE, code) as opened, held_alone(station):
                begin_station(opened)
                recover_all(opened)
                try:
                    hand_over(opened)
                except (LibraryError, OSError) as error:
                    found.faults.append(f"not handed over: {error}")


def _judge(clinic: Clinic, storm: _Storm) -> None:
    found, session_id = storm.found, storm.session_id
    journals = rows_of(
        clinic.address,
        "SELECT r.id, r.state, j.file, j.kept_as FROM recordings r JOIN journals j ON j.recording_id = r.id "
        f"WHERE r.session_id = '{session_id}'",
    )
    rows = Counter(row["file"] for row in journals)
    kept_as = {row["file"]: row["kept_as"] for row in journals}
    found.count["recordings"] = len(journals)
    for name, sha256 in storm.sha256_of.items():
        if not rows[name]:
            found.count["killed before anything was in the journal"] += 1
            if _has_samples(clinic, name):
                found.faults.append(f"{name} is lost: no row tells of it")
        elif rows[name] > 1 or kept_as[name] != sha256 + SUFFIX:
            found.faults.append(f"{name}: {rows[name]} rows, kept as {kept_as[name]}, was {sha256}")
    found.faults += [
        f"{name} is in the library, and was on nobody's disk" for name in rows - Counter(storm.sha256_of.keys())
    ]
    found.faults += [f"{row['file']} is still {row['state']}" for row in journals if row["state"] == "open"]
    noted = [line for path in storm.noted.iterdir() for line in _lines(path)]
    found.faults += [
        f"{line['id']} was stopped as {line['sha256']}, and is not there as that"
        for line in noted
        if "sha256" in line and kept_as.get(f"{line['id']}.1{SUFFIX}") != line["sha256"] + SUFFIX
    ]
    _judge_place(clinic, found)
    _judge_reading(clinic, session_id, found)


def _lines(path: Path) -> list[Row]:
    return [] if path.suffix in (".moments", ".wish") or path.name == STOP else read_lines(path)


def _judge_place(clinic: Clinic, found: Found) -> None:
    """In the shared place is one file for each journal, which is what its name states, and nothing else."""
    required = Counter(row["kept_as"] for row in rows_of(clinic.address, "SELECT kept_as FROM journals"))
    there = {path.name for path in clinic.place.iterdir() if path.suffix == SUFFIX}
    found.faults += [f"{name} is kept for {count} journals" for name, count in required.items() if count > 1]
    found.faults += [f"{name} is kept there for nobody" for name in there - required.keys()]
    found.faults += [f"{name} is not there" for name in required.keys() - there]
    for name in there:
        if _sha256(clinic.place / name) + SUFFIX != name:
            found.faults.append(f"{name} is not what its name says")


def _judge_reading(clinic: Clinic, session_id: UUID, found: Found) -> None:
    """Every station reads all of them, and each sample follows from the one before."""
    for code, station in zip(OPERATORS, clinic.stations, strict=True):
        with open_library(station, PASSPHRASE, code) as opened:
            for recording_id, recording in read_all_of(opened, session_id):
                for site, block in recording.imu.items():
                    number: IntArray = block.gyr_rad_s[:, 0].astype(np.int64)
                    steps = np.mod(np.diff(number), LOOP)
                    if np.any(steps != 1):
                        found.faults.append(f"{recording_id}: {site} has a gap at station {code}")
            found.faults += [f"audit {fault.number} {fault.what}" for fault in opened.library.audit.verify().faults]


def _has_samples(clinic: Clinic, name: str) -> bool:
    (path,) = (path for station in clinic.stations for path in station.glob(f"*/{name}"))
    with open_library(clinic.stations[0], PASSPHRASE, OPERATORS[0]) as opened:
        try:
            records = list(JournalReader(path, opened.data_key).records())
        except JournalRefusedError:
            return True
    return any(isinstance(one, Record) and one.kind is RecordKind.SAMPLES for one in records)


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
