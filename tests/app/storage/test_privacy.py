"""No name that was typed into a library can be read from what it leaves on the disk, whenever it was killed."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from app.storage.layout import DATABASE
from app.storage.library import Library
from app.storage.root import ID_FILE

NAMES = 200
WRITE = """
import sys
from dataclasses import replace
from pathlib import Path
from app.storage.library import Library
from app.storage.stored import Operator, PlacedSensor, Role
from core.body import Site
from core.samples import SensorInfo
from core.session import Patient, Recording, RecordingKind, Session

folder, key, names = Path(sys.argv[1]), bytes.fromhex(sys.argv[2]) or None, sys.argv[3:]
with Library.create(folder, key, Operator("hk", names[0], Role.ADMINISTRATOR)) as library:
    library.settings.put("clinic", names[1])
    print("ready", flush=True)
    while True:
        for k, name in enumerate(names):
            patient = library.patients.find(name) or library.patients.create(Patient(code=name, device=name, aids=name))
            told = Session((), operator=name, notes=name, surface=name, unknown={name: name}, is_simulated=False)
            visit = library.sessions.create(patient.id, told)
            library.sessions.change(visit, replace(told, notes=name + " again"), comment=name)
            library.sessions.place(visit.id, {Site.LEFT_FOOT: PlacedSensor(name, SensorInfo(serial=name))})
            if key:
                walk = Recording(name, RecordingKind.WALKING, name, {}, condition=name, note=name)
                library.recordings.start(visit.id, walk, is_simulated=False)
            library.patients.search(name)
            library.sessions.list(text=name)
            patient = library.patients.get(patient.id)
            library.patients.change(patient, replace(patient.details, aids=name * 2))
            if k == 20:
                library.sessions.delete(library.sessions.get(visit.id))
        print("round", flush=True)
"""


def planted(rng: random.Random) -> list[str]:
    """Names of twelve letters, none of which is found in anything by chance."""
    letters = "abcdefghijklmnopqrstuvwxyz"
    return ["".join(rng.choice(letters) for _ in range(12)).capitalize() for _ in range(NAMES)]


def found(folder: Path, names: list[str]) -> set[str]:
    """Names in any file below `folder`, or in the name of one, in any usual encoding and case."""
    files = list(folder.rglob("*"))
    content = b" ".join([*(path.read_bytes() for path in files if path.is_file()), str(files).encode()]).lower()
    beginnings: set[int] = set()
    for start in range(8):  # all windows of eight bytes at once: to look for one name after the other takes long
        windows = np.frombuffer(content, np.uint64, (len(content) - start) // 8, start)
        beginnings.update(np.intersect1d(windows, np.array(list(beginning(names)), np.uint64)).tolist())
    return {name for head, name in beginning(names).items() if head in beginnings}


def beginning(names: list[str]) -> dict[int, str]:
    """The first eight bytes that a name has on the disk, as a number."""
    encodings = ("utf-8", "utf-16-le", "utf-16-be")
    return {
        int.from_bytes(name.lower().encode(encoding)[:8], sys.byteorder): name
        for name in names
        for encoding in encodings
    }


def written_and_killed(tmp_path: Path, key: str, names: list[str], rounds: int, after_s: float) -> None:
    """Let a process write names until it is killed amid a write; its temporary files are under `tmp_path` too."""
    environment = {**os.environ, "TMPDIR": str(tmp_path / "tmp"), "SQLITE_TMPDIR": str(tmp_path / "tmp")}
    (tmp_path / "tmp").mkdir()
    command = [sys.executable, "-c", WRITE, str(tmp_path / "library"), key, *names]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as writer:
        assert writer.stdout is not None
        assert writer.stderr is not None
        assert writer.stdout.readline() == b"ready\n", writer.stderr.read().decode()
        for _ in range(rounds):
            assert writer.stdout.readline() == b"round\n", writer.stderr.read().decode()
        time.sleep(after_s)
        assert writer.poll() is None, writer.stderr.read().decode()
        writer.send_signal(signal.SIGKILL)
        stated = writer.stdout.read() + writer.stderr.read()
    assert [name for name in names if name.encode() in stated] == []


@pytest.fixture
def names() -> list[str]:
    return planted(random.Random(1))


@pytest.mark.parametrize(("kills", "rounds"), [(1, 0), (2, 1)], ids=["quick", "full"])
@pytest.mark.endurance
def test_no_planted_name_is_found_after_a_kill_amid_a_write(
    tmp_path: Path, names: list[str], kills: int, rounds: int
) -> None:
    rng = random.Random(2)
    for kill in range(kills):
        folder = tmp_path / str(kill)
        folder.mkdir()
        written_and_killed(folder, "5a" * 32, names, rounds, rng.uniform(0.5, 1.5))
        left = {path.name for path in (folder / "library").iterdir()}
        assert left == {DATABASE, ID_FILE, f"{DATABASE}-wal", f"{DATABASE}-shm"}  # it was killed while open
        assert found(folder, names) == set()
        with Library.open(folder / "library", b"\x5a" * 32) as library:
            library.log_in("hk")
            assert len(library.patients.search()) >= (NAMES if rounds else 1)
            assert library.faults() == ()
            assert library.audit.verify().faults == ()
        assert found(folder, names) == set()


@pytest.mark.endurance
def test_the_same_names_are_found_where_nothing_is_encrypted(tmp_path: Path, names: list[str]) -> None:
    written_and_killed(tmp_path, "", names, 0, 1.0)
    assert len(found(tmp_path, names)) > 2


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16-le", "utf-16-be"])
def test_a_name_is_found_wherever_it_is(tmp_path: Path, names: list[str], encoding: str) -> None:
    for offset in range(9):
        (tmp_path / "file").write_bytes(bytes(offset) + names[7].upper().encode(encoding) + bytes(offset))
        assert found(tmp_path, names) == {names[7]}
