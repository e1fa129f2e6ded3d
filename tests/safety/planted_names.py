"""T10 for a whole library. Find which of 200 planted names, and which secrets, a kill leaves on the disk.

    python -m tests.safety.planted_names --count 100

A child imports sessions with names wherever somebody may type one, exports them without names, backs the library up
and logs errors about them, until it is killed. Then everything that it wrote is searched: library, journals, backups,
exports, logs, temporary files and what it stated.
"""

import argparse
import logging
import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.storage.backup import back_up
from app.storage.exchange import import_session, session_with_samples
from app.storage.journal.disk import Room
from app.storage.opened import create_library, open_library
from app.storage.recovery import find_interrupted, recover
from app.storage.stored import Operator, Role
from app.system.logs import start_logging
from app.system.progress import nobody
from core.body import Site
from core.samples import ImuBlock, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from tests.app.storage.library.folder_export import write_folder
from tests.driver import HIDDEN, Found, drive

ROOT = Path(__file__).parents[2]
STEM = "Kowalczyk"  # of all names, so that one search finds any of them
NAMES = [f"{STEM}{number:03d}" for number in range(200)]
ENCODINGS = ("utf-8", "utf-16-le", "utf-16-be")
PASSPHRASE = "a passphrase planted too"
ANY_ROOM = Room(start_bytes=0, kept_bytes=0)
FORGOTTEN_S = 60  # after which a child whose parent is gone ends by itself


def named_session(name: str) -> Session:
    """A short walk with `name` wherever a person or a program may write one."""
    count, odd = 200, {name: name, "key": {"deep": name}}
    column = np.array([name] * count, dtype=np.dtypes.StringDType())
    block = ImuBlock(
        name, np.arange(count) / 100, np.ones((count, 3)), np.ones((count, 3)), unknown={f"of {name}": column}
    )
    walk = Recording(name, RecordingKind.WALKING, name, {Site.LEFT_FOOT: block}, started=name, note=name, unknown=odd)
    return Session(
        (walk,),
        patient=Patient(code=name, unknown=odd),
        sensors={Site.LEFT_FOOT: SensorInfo(model="walker", unknown=odd)},
        started=name,
        operator=name,
        notes=name,
        unknown={"session": odd, name: odd},
    )


def work(folder: Path) -> None:
    """Do all that writes, name after name, until the kill."""
    start_logging(folder / "logs")
    log = logging.getLogger("app.system.logs")
    opened, recovery_key = create_library(folder / "library", Operator("hk", NAMES[0], Role.ADMINISTRATOR), PASSPHRASE)
    assert opened.data_key is not None
    print(opened.data_key.hex(), recovery_key, flush=True)
    sys.stdout.close()
    until_s = time.monotonic() + FORGOTTEN_S
    number = 0
    while time.monotonic() < until_s:
        name = NAMES[number % len(NAMES)]
        session = replace(named_session(name), patient=Patient(code=f"{name}-{number}"))
        imported = import_session(opened, session, nobody, room=ANY_ROOM)
        write_folder(opened, imported.session_id, folder / "exports" / str(number), {})
        try:
            (folder / name).read_bytes()
        except OSError:
            log.exception("%s of %s is missing", folder / name, name)
        if number % 20 == 10:
            (folder / f"backups{number}").mkdir()
            back_up(opened, folder / f"backups{number}")
        number += 1


def kill_and_search(folder: Path, count: int, seed: int) -> Found:
    rng, search = random.Random(seed), Found()
    for kill in range(count):
        place = folder / str(kill)
        (place / "tmp").mkdir(parents=True)
        environment = {**os.environ, "TMPDIR": str(place / "tmp"), "SQLITE_TMPDIR": str(place / "tmp")}
        command = [sys.executable, "-m", "tests.safety.planted_names", "--work", str(place)]
        with (
            (place / "said").open("wb") as stated,
            subprocess.Popen(
                command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=stated, text=True
            ) as child,
        ):
            assert child.stdout is not None
            secrets = child.stdout.readline().split()
            time.sleep(rng.uniform(0.0, 2.0))
            if child.poll() is not None:
                search.faults.append(f"{kill}: the child ended by itself")
            child.send_signal(signal.SIGKILL)
        search.count["kills"] += 1
        search.count["names planted"] += 1 + len(list(place.glob("exports/*")))  # the operator's, and of each session
        search_files(place, secrets, search)
        _reopen(place, search)
    return search


def search_files(place: Path, secrets: list[str], search: Found) -> None:
    required = [STEM.lower().encode(encoding) for encoding in ENCODINGS] + [PASSPHRASE.lower().encode()]
    for secret in secrets:
        required += [secret.lower().encode(), secret.replace("-", "").lower().encode()]
    key = bytes.fromhex(secrets[0])
    for path in place.rglob("*"):
        content = path.read_bytes() if path.is_file() else b""
        lower = content.lower() + str(path.relative_to(place)).lower().encode()
        search.count["files searched"] += path.is_file()
        if key in content or any(one in lower for one in required):
            search.faults.append(f"found: {path}")


def _reopen(place: Path, search: Found) -> None:
    with open_library(place / "library", PASSPHRASE) as opened:
        for one in find_interrupted(opened):
            recover(opened, one, nobody)
            search.count["recordings recovered"] += 1
        faults = [*opened.library.faults(), *opened.library.audit.verify().faults]
        for line in opened.library.sessions.list():
            visit = opened.library.sessions.get(line.id)
            read = session_with_samples(opened, visit, {}, nobody)
            if read.recordings and STEM not in read.recordings[0].name:
                faults.append(f"session {line.id} lost its names")
        search.faults += [f"{place.name}: {fault}" for fault in faults]


def run(asked: argparse.Namespace, folder: Path) -> Found:
    if asked.work:
        work(Path(asked.work))
        return Found()
    return kill_and_search(folder, asked.count, asked.seed)


if __name__ == "__main__":
    drive(__doc__, run, count=100, seed=1, work=("", HIDDEN))
