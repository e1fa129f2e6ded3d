"""Tests that a file can do no more than end the process that reads it."""

import io
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.body import Site
from core.findings import Finding, Severity
from core.samples import ImuBlock, SensorInfo
from core.session import Session
from devices.files import limited_reader
from devices.files.answers import Array, BrokenAnswerError, details_of, receive, send, value_from
from devices.files.imports import place_trial
from devices.files.limited_reader import LimitedReader, LimitedReading, ReadingEndedError
from devices.files.refusal import FileRefusedError
from devices.files.session_folder import read_session, write_session
from devices.files.site_files import REQUIRED
from devices.files.xsens_mtmanager import mtmanager_trial
from tests.devices.files.conftest import MakeSession
from tests.trials_of_files import import_with

EXPORT = """// Update Rate: 100.0Hz
PacketCounter\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_Y\tGyr_Z
{}"""
SPARSE_BYTES = 8_000_000_000
on_linux = pytest.mark.skipif(sys.platform != "linux", reason="the limits of Linux")


@pytest.fixture
def reader() -> Iterator[LimitedReader]:
    reader = LimitedReader()
    yield reader
    reader.close()


def nothing() -> None: ...


def read(folder: Path, reader: LimitedReader, waiting: Callable[[], object] = nothing) -> Session:
    return read_session(folder, LimitedReading(reader, waiting))


def process_of(reader: LimitedReader) -> int:
    assert reader.process is not None
    return reader.process.pid


def same(one: object, other: object) -> bool:
    """Return whether two sessions, and all that is in them, hold the same."""
    if isinstance(one, np.ndarray):
        if not isinstance(other, np.ndarray) or one.dtype != other.dtype:
            return False
        return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    if is_dataclass(one):
        return type(one) is type(other) and all(same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    if isinstance(one, dict):
        return isinstance(other, dict) and [*one] == [*other] and all(same(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list):
        is_alike = type(one) is type(other) and len(one) == len(other)
        return is_alike and all(same(*pair) for pair in zip(one, other, strict=True))  # type: ignore[call-overload]  # of any kind
    return one == other


def exported(folder: Path, name: str = "a.txt", rows: int = 20) -> Path:
    lines = (f"{number:05d}\t0.0\t0.1\t9.81\t0.01\t0.02\t0.03\n" for number in range(rows))
    (folder / name).write_text(EXPORT.format("".join(lines)))
    return folder / name


def sparse(path: Path) -> Path:
    with path.open("wb") as file:
        file.truncate(SPARSE_BYTES)
    return path


# --- what comes back is what was read


def test_a_session_comes_back_as_if_it_had_been_read_here(
    make_session: MakeSession, shared_reader: LimitedReader
) -> None:
    columns = {name: np.linspace(0, 1, 4) for name in REQUIRED} | {
        **{f"quat_{axis}": [0.5, 0.5, np.nan, 0.5] for axis in "wxyz"},
        **{f"mag_{axis}": [1.0, 2.0, 3.0, 4.0] for axis in "xyz"},
        "steps": np.array([1, 2, 3, 255], dtype=np.uint8),
        "half": np.array([1, 2, 3, 4], dtype=np.float16),
        "words": ["", "ü\n", "=1", "\U0001f9b5"],
    }
    toml = """format = "gaitwright-session/1"
own = [1979-05-27T07:32:00Z, 1979-05-27, 07:32:00, [1, 2.5, nan, true, { deep = "ä" }]]
[session]
started = 2026-01-01T10:00:00
"" = ["list", []]
[zero]
left_knee = 2.0
[[recordings]]
name = "walk 1"
kind = "walking"
folder = "walk_1"
"""
    folder = make_session(toml=toml)
    pq.write_table(pa.table(columns), folder / "walk_1" / "left_shank.parquet")
    direct, limited = read_session(folder), read(folder, shared_reader)
    assert len(direct.recordings[0].imu[Site.LEFT_SHANK].unknown) == 3
    assert repr(limited) == repr(direct)  # NaN is not equal to itself
    assert same(direct.recordings[0].imu, limited.recordings[0].imu)
    assert not same(direct.recordings[0].imu, {})


def test_an_import_comes_back_as_if_it_had_been_read_here(tmp_path: Path, shared_reader: LimitedReader) -> None:
    files = [exported(tmp_path), exported(tmp_path, "b.txt")]
    placement = {Site.LEFT_THIGH: "a.txt"}
    direct = import_with(mtmanager_trial, files, placement, "walk 1")
    trial = LimitedReading(shared_reader, nothing).read_trial("xsens-mtmanager", files, None)
    limited = place_trial(trial, placement, "walk 1")
    assert [finding.key for finding in limited.findings] == ["file_left_out"]
    assert same(direct, limited)


@pytest.mark.parametrize(
    "spoilt",
    [
        {"toml": b"\xff"},
        {"toml": "format = 1"},
        {"files": {"left_thigh.csv": "time_s\n0"}},
        {"files": {"left_thigh.csv": b"time_s,\xff\n"}},
        {"files": {"left_thigh.parquet": b"PAR1"}},
        {"files": {"left_thigh.csv": ",".join(REQUIRED) + "\n1,2,3,4,5,6,{x}\n"}},
    ],
)
def test_a_refusal_comes_back_word_for_word(
    make_session: MakeSession, shared_reader: LimitedReader, spoilt: dict[str, object]
) -> None:
    folder = make_session(**spoilt)
    with pytest.raises(FileRefusedError) as direct:
        read_session(folder)
    with pytest.raises(FileRefusedError) as limited:
        read(folder, shared_reader)
    assert str(limited.value) == str(direct.value)
    assert limited.value.values == direct.value.values
    assert not isinstance(limited.value, ReadingEndedError)


def test_a_large_session_is_read_again_by_the_limited_process(
    make_session: MakeSession, shared_reader: LimitedReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("devices.files.session_folder.HELD_BYTES", 1)
    folder = make_session()
    session = read_session(folder, LimitedReading(shared_reader, nothing))
    assert len(session.recordings[0].imu[Site.LEFT_THIGH]) == 3  # kept: it was read last
    again = read_session(with_two_more(folder), LimitedReading(shared_reader, nothing)).recordings[0].imu
    assert len(again[Site.LEFT_THIGH]) == 3
    (folder / "walk_1" / "left_thigh.csv").write_text("changed")
    assert len(again[Site.RIGHT_THIGH]) == len(again[Site.RIGHT_SHANK]) == 3
    with pytest.raises(FileRefusedError, match="required columns are missing"):
        again[Site.LEFT_THIGH]


def with_two_more(folder: Path) -> Path:
    for site in ("right_thigh", "right_shank"):
        shutil.copy(folder / "walk_1" / "left_thigh.csv", folder / "walk_1" / f"{site}.csv")
    return folder


def test_what_a_folder_holds_is_looked_for_there_wherever_the_process_was_started(
    make_session: MakeSession, shared_reader: LimitedReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_session()
    read(folder, shared_reader)
    monkeypatch.chdir(folder.parent)
    assert repr(read(Path("session"), shared_reader)) == repr(read_session(folder))


# --- limits


def test_an_8_gb_file_is_refused_before_it_is_read(make_session: MakeSession, reader: LimitedReader) -> None:
    folder = make_session()
    sparse(folder / "walk_1" / "right_thigh.csv")
    began_s = time.monotonic()
    with pytest.raises(FileRefusedError, match=r"walk_1/right_thigh.csv: this file has 8000 MB.*up to 1000 MB\.$"):
        read(folder, reader)
    sparse(folder / "session.toml")
    with pytest.raises(FileRefusedError, match=r"session.toml: this file has 8000 MB.*up to 4 MB\.$"):
        read(folder, reader)
    with pytest.raises(FileRefusedError, match=r"session.toml: this file has 8000 MB"):
        write_session(read_session(make_session_beside(folder)), folder, LimitedReading(reader, nothing))
    reading = LimitedReading(reader, nothing)
    files = [exported(folder), folder / "session.toml"]
    with pytest.raises(FileRefusedError, match=r"session.toml: this file has 8000 MB.*up to 1000 MB\.$"):
        reading.read_trial("xsens-mtmanager", files, None)
    assert time.monotonic() - began_s < 10.0  # reading one of them takes longer


def make_session_beside(folder: Path) -> Path:
    beside = folder.parent / "beside"
    (beside / "walk_1").mkdir(parents=True)
    text = (folder / "walk_1" / "left_thigh.csv").read_text()
    (beside / "walk_1" / "left_thigh.csv").write_text(text)
    toml = 'format = "gaitwright-session/1"\n[[recordings]]\nname = "w"\nkind = "walking"\nfolder = "walk_1"\n'
    (beside / "session.toml").write_text(toml)
    return beside


@on_linux
def test_a_small_file_that_fills_the_memory_is_refused(make_session: MakeSession) -> None:
    reader = LimitedReader(memory_bytes=700_000_000)
    folder = make_session()
    note = pa.DictionaryArray.from_arrays(pa.array(np.zeros(500, dtype=np.int32)), [" " * 2_000_000])
    rows = pa.table({name: np.arange(500.0) for name in REQUIRED} | {"note": note})  # 1 GB
    pq.write_table(rows, folder / "walk_1" / "right_thigh.parquet", store_schema=False)
    assert (folder / "walk_1" / "right_thigh.parquet").stat().st_size < 1_000_000
    with pytest.raises(ReadingEndedError, match=r"^walk_1/right_thigh.parquet: reading the data takes more memory"):
        read(folder, reader)
    assert reader.process is None


def test_small_files_that_hold_too_much_together_are_refused(
    make_session: MakeSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_session()
    monkeypatch.setattr("devices.files.session_folder.MOST_HELD_BYTES", 100)
    with pytest.raises(
        FileRefusedError, match=r"^walk 1: the recording's files contain more samples than their size allows"
    ):
        read_session(folder)
    monkeypatch.setattr("devices.files.session_folder.MOST_HELD_BYTES", 1000)
    read_session(folder)


@pytest.mark.endurance
def test_a_file_that_takes_too_long_is_refused_and_the_next_one_is_read(
    make_session: MakeSession, reader: LimitedReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_session()
    monkeypatch.setattr(limited_reader, "DEADLINE_S", 0.0)
    with pytest.raises(ReadingEndedError, match=r"^session.toml: reading the data takes longer"):
        read(folder, reader)
    monkeypatch.undo()
    read(folder, reader)


@on_linux
@pytest.mark.parametrize(
    ("number", "cause"),
    [
        (signal.SIGSEGV, "crash"),
        (signal.SIGXCPU, "time"),
        pytest.param(signal.SIGKILL, "crash", marks=pytest.mark.endurance),
    ],
)
def test_a_file_that_ends_its_reader_is_refused_and_the_next_one_is_read(
    make_session: MakeSession, reader: LimitedReader, number: signal.Signals, cause: str
) -> None:
    folder = make_session()
    with pytest.raises(ReadingEndedError) as caught:
        read(folder, reader, lambda: os.kill(process_of(reader), number))
    assert caught.value.cause == cause
    assert str(caught.value).isprintable()
    read(folder, reader)


@pytest.mark.endurance
@on_linux
def test_a_reading_that_is_given_up_ends_its_process(make_session: MakeSession, reader: LimitedReader) -> None:
    folder = make_session()
    ended: list[int] = []

    def give_up() -> None:
        ended.append(process_of(reader))
        os.kill(ended[0], signal.SIGSTOP)  # it would read for ever
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        read(folder, reader, give_up)
    assert not Path(f"/proc/{ended[0]}").exists()
    read(folder, reader)


@pytest.mark.endurance
def test_the_process_is_renewed_after_many_files(
    make_session: MakeSession, reader: LimitedReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert limited_reader.FILES_EACH == 500
    monkeypatch.setattr(limited_reader, "FILES_EACH", 4)
    folder = make_session()
    read(folder, reader)
    first = process_of(reader)
    read(folder, reader)  # its four files are read
    assert reader.process is None
    read(folder, reader)
    assert process_of(reader) != first


@pytest.mark.endurance
def test_closing_ends_the_process_and_collecting_it_too(make_session: MakeSession) -> None:
    folder = make_session()
    reader = LimitedReader()
    read(folder, reader)
    process = reader.process
    assert process is not None
    reader.close()
    assert process.returncode is not None
    read(folder, reader)
    process = reader.process
    del reader
    assert process is not None
    assert process.poll() is not None


@on_linux
def test_the_process_loads_no_screen_and_nothing_from_where_it_is_started(
    make_session: MakeSession, reader: LimitedReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_session()
    for name in ("json", "numpy", "struct"):
        (folder / f"{name}.py").write_text("raise SystemExit('a file of the folder was run')")
    monkeypatch.chdir(folder)
    read(folder, reader)
    maps = Path(f"/proc/{process_of(reader)}/maps").read_text()
    assert "arrow" in maps
    assert not any(library in maps for library in ("PySide", "Qt6", "sqlcipher", "cryptography", "/scipy/"))


ATTEMPTS = """
import os, socket, subprocess, sys
from pathlib import Path
from devices.files.limits import limit_this_process
limit_this_process(2_000_000_000)
place = Path(sys.argv[1])
def attempt(name, act):
    try:
        act()
    except (OSError, MemoryError) as problem:
        print(name, type(problem).__name__)
    else:
        print(name, "done")
def write(flags):
    file = os.open(place / "old", flags)
    os.write(file, b"x")
attempt("read", lambda: (place / "old").read_bytes())
attempt("write", lambda: write(os.O_WRONLY))
attempt("truncate", lambda: os.truncate(place / "old", 0))
attempt("create", lambda: (place / "new").touch())
attempt("folder", lambda: (place / "new").mkdir())
attempt("delete", lambda: (place / "old").unlink())
attempt("rename", lambda: (place / "old").rename(place / "new"))
attempt("link", lambda: (place / "new").symlink_to("/"))
attempt("program", lambda: subprocess.run(["/bin/true"]))
attempt("connect", lambda: socket.create_connection(("127.0.0.1", int(sys.argv[2])), 2))
attempt("signal", lambda: os.kill(os.getppid(), 0))
attempt("memory", lambda: bytearray(2_000_000_000))
"""


@on_linux
def test_a_limited_process_reads_and_does_nothing_else(tmp_path: Path) -> None:
    import socket

    (tmp_path / "old").write_text("as it was")
    before = (tmp_path / "old").stat()
    with socket.create_server(("127.0.0.1", 0)) as server:
        arguments = [sys.executable, "-c", ATTEMPTS, str(tmp_path), str(server.getsockname()[1])]
        reported = subprocess.run(arguments, capture_output=True, text=True, check=True).stdout.splitlines()
    came = dict(line.split() for line in reported)
    assert came.pop("read") == "done"
    assert came.pop("memory") == "MemoryError"
    assert came.pop("write") in ("OSError", "PermissionError")  # the first without Landlock: the file is too large
    assert (tmp_path / "old").read_text() == "as it was"
    if came["create"] == "done":
        pytest.skip("this kernel has no Landlock")
    assert [path.name for path in tmp_path.iterdir()] == ["old"]
    assert (tmp_path / "old").stat().st_mtime_ns == before.st_mtime_ns
    connect, a_signal = came.pop("connect"), came.pop("signal")
    assert set(came.values()) == {"PermissionError"}
    version = subprocess.run([sys.executable, "-c", LANDLOCK_VERSION], capture_output=True, text=True, check=True)
    assert connect == ("PermissionError" if int(version.stdout) >= 4 else "done")
    assert a_signal == ("PermissionError" if int(version.stdout) >= 6 else "done")


@on_linux
def test_not_a_byte_is_written_on_a_kernel_without_landlock_either(tmp_path: Path) -> None:
    """Each of both walls is tried without the other: the limit of a file's size holds on macOS as well."""
    without = ATTEMPTS.replace("limit_this_process(", "limits._forbid_writing = lambda: None; limit_this_process(", 1)
    without = f"from devices.files import limits\n{without}"
    (tmp_path / "old").write_text("as it was")
    # the port is nobody's: what is asked here is only what becomes of files
    reported = subprocess.run(
        [sys.executable, "-c", without, str(tmp_path), "9"], capture_output=True, text=True, check=True
    ).stdout
    came = dict(line.split() for line in reported.splitlines())
    assert came["create"] == "done"  # so Landlock is off
    assert came["write"] == "OSError"
    assert all(path.stat().st_size in (0, len("as it was")) for path in tmp_path.iterdir() if path.is_file())


LANDLOCK_VERSION = "import ctypes; print(ctypes.CDLL(None).syscall(444, None, 0, 1))"


# --- answers that nobody of ours gives


def sent(reported: dict[str, object], *arrays: Array) -> bytes:
    stream = io.BytesIO()
    send(stream, reported, arrays)
    return stream.getvalue()


ANSWER = sent({"what": "read", "details": [1, "a"]}, np.arange(3.0), np.eye(2, dtype=np.int16))
END_OF_HEAD = 8 + int.from_bytes(ANSWER[:8], "little")  # what states how long each array is


@given(st.integers(0, len(ANSWER) - 1), st.integers(1, 255), st.integers(0, 60))
def test_a_damaged_answer_is_no_answer(place: int, change: int, cut: int) -> None:
    damaged = bytearray(ANSWER)
    damaged[place] ^= change
    try:
        reported, _ = receive(io.BytesIO(damaged[: len(damaged) - cut]))
    except (BrokenAnswerError, EOFError):
        return
    assert isinstance(reported, dict)
    assert cut == 0 or place < END_OF_HEAD  # an array that is stated to be shorter may miss its end


@pytest.mark.parametrize("kind", ["|O", "<O8", "|V8", "|S9", "<U4", "<M8", "f8", "<f16", 8])
def test_arrays_are_of_numbers_only(kind: object) -> None:
    stream = ANSWER.replace(b'"<f8"', f'"{kind}"'.encode() if isinstance(kind, str) else b"8")
    length = len(stream) - len(ANSWER) + int.from_bytes(ANSWER[:8], "little")
    with pytest.raises(BrokenAnswerError):
        receive(io.BytesIO(length.to_bytes(8, "little") + stream[8:]))


@pytest.mark.parametrize("shape", ["[3000000000]", "[-1]", "[1e3]", "[]", "[2,2,2]", '["3"]', "[true]"])
def test_arrays_are_no_larger_than_a_file_can_be(shape: str) -> None:
    stream = ANSWER.replace(b"[3]", shape.encode())
    length = len(stream) - len(ANSWER) + int.from_bytes(ANSWER[:8], "little")
    with pytest.raises(BrokenAnswerError):
        receive(io.BytesIO(length.to_bytes(8, "little") + stream[8:]))


@pytest.mark.parametrize("what", ["{a.__class__}", "{a:>999999999}", "{a!r}", "{b}", "{}", "{a[0]}", "{", "x" * 99_999])
def test_a_refusal_has_only_plain_names_in_its_braces(what: str) -> None:
    reported = {"where": "w", "what": what, "remedy": "Do", "values": {"a": "1"}}
    with pytest.raises(BrokenAnswerError):
        value_from(FileRefusedError, reported)
    assert str(value_from(FileRefusedError, {**reported, "what": "is {a}"})) == "w: is 1. Do."


@pytest.mark.parametrize(
    "change",
    [
        {"time_s": 9},
        {"time_s": 1},
        {"time_s": "0"},
        {"sensor": 3},
        {"unknown": {"a": [1, 2]}},
        {"unknown": {"a": ["\ud800"] * 3}},
        {"unknown": []},
        {"gyr_rad_s": None},
        {"is_rate_derived": 1},
        {"shape": [3]},
    ],
)
def test_a_block_of_another_shape_is_no_block(change: dict[str, object]) -> None:
    arrays: list[Array] = []
    reported = details_of(ImuBlock("a", np.arange(3.0), np.zeros((3, 3)), np.zeros((3, 3))), arrays)
    assert value_from(ImuBlock, reported, arrays).sensor == "a"
    with pytest.raises(BrokenAnswerError):
        value_from(ImuBlock, reported | change, arrays)


FINDINGS = tuple[Finding, ...]


def test_a_finding_of_another_shape_is_no_finding() -> None:
    findings = (Finding("key", Severity.INFO, "here", {"count": 1, "name": "x"}),)
    assert value_from(FINDINGS, details_of(findings, [])) == findings
    with pytest.raises(BrokenAnswerError):
        value_from(FINDINGS, [{"key": "a", "severity": "loud", "where": "", "numbers": {}}])
    with pytest.raises(BrokenAnswerError):
        value_from(FINDINGS, [{"key": "a", "severity": "info", "where": "", "numbers": 3}])
    with pytest.raises(BrokenAnswerError):
        value_from(FINDINGS, {"key": "a"})
    with pytest.raises(BrokenAnswerError):
        value_from(FINDINGS, [{"key": "a", "severity": "info", "where": ""}])  # a field is missing


def test_a_number_is_of_the_type_that_its_class_names() -> None:
    sound = details_of(SensorInfo(serial="1", rate_hz=100.0), [])
    assert value_from(SensorInfo, sound) == SensorInfo(serial="1", rate_hz=100.0)
    assert type(value_from(SensorInfo, sound | {"rate_hz": 100}).rate_hz) is float
    for rate_hz in (True, "100", 10**400):
        with pytest.raises(BrokenAnswerError):
            value_from(SensorInfo, sound | {"rate_hz": rate_hz})
