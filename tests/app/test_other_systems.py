"""Tests that what differs between systems differs as it should. Run on this one, which is given to be another.

What each test represents is in the list of `packaging/installers/README.md`. Nothing was tried on Windows or macOS.
"""

import builtins
import ctypes
import errno
import logging
import multiprocessing
import os
import socket
import subprocess
import sys
from pathlib import Path
from queue import Queue
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from app.cli import main as cli
from app.cohort.batch import executors
from app.exports.proposed_names import DEVICES, session_name
from app.review import viewer
from app.storage import files
from app.storage.journal.disk import JournalFile
from app.system.sounds import Loudspeaker, Sound
from app.theme import motion
from app.theme.theme import Theme
from devices.emulators.transports import PseudoTerminal
from devices.files import limits
from devices.live import SourceRefusedError
from devices.transport import networks, ports


@pytest.fixture
def windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Say that this is Windows, and let none of what it lacks be imported."""
    monkeypatch.setattr(sys, "platform", "win32")
    lacking = {"fcntl", "resource", "grp", "pwd", "pty", "tty", "termios"}
    imported = builtins.__import__

    def like_there(name: str, *arguments: Any, **keywords: Any) -> ModuleType:
        if name in lacking:
            raise ModuleNotFoundError(f"No module named {name!r}")
        return imported(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, "__import__", like_there)


class Msvcrt(ModuleType):
    """Windows' locks of files: one program may hold a byte."""

    LK_NBLCK = 2

    def __init__(self) -> None:
        super().__init__("msvcrt")
        self.held_at: list[int] = []

    def locking(self, descriptor: int, mode: int, count: int) -> None:
        assert (mode, count) == (self.LK_NBLCK, 1)
        at = os.lseek(descriptor, 0, os.SEEK_CUR)
        if at in self.held_at:
            raise PermissionError(errno.EACCES, "locked")
        self.held_at.append(at)


# files


@pytest.mark.usefixtures("windows")
def test_one_program_holds_a_file_on_windows_and_others_still_read_all_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    locks = Msvcrt()
    monkeypatch.setattr(files, "msvcrt", locks, raising=False)
    (tmp_path / "lock").write_bytes(b"abc")
    with files.held(tmp_path / "lock"):
        assert locks.held_at[0] > (tmp_path / "lock").stat().st_size  # beyond all that is read
        with pytest.raises(BlockingIOError), files.held(tmp_path / "lock"):
            pytest.fail("two hold it")


def test_a_folder_is_synced_where_that_can_be(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[int] = []
    monkeypatch.setattr(os, "fsync", synced.append)
    files.sync_folder(tmp_path)
    assert len(synced) == 1
    monkeypatch.setattr(files, "os", SimpleNamespace(name="nt"))  # which opens no folder
    files.sync_folder(tmp_path)
    assert len(synced) == 1


def test_what_another_program_has_open_is_replaced_later_and_stays_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(self: Path, target: Path) -> Path:
        raise PermissionError(errno.EACCES, "used by another process", str(target))

    (tmp_path / "kept").write_bytes(b"old")
    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(PermissionError):
        files.replace_file(tmp_path / "kept", b"new")
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == {"kept": b"old"}


def test_a_journal_is_synced_without_fdatasync_and_asks_its_folder_for_room_on_windows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    journal = JournalFile(tmp_path / "journal", b"header")
    try:
        synced: list[int] = []
        monkeypatch.delattr(os, "fdatasync", raising=False)
        monkeypatch.setattr(os, "fsync", synced.append)
        journal.append(b"\r\n\n")
        journal.sync()
        assert len(synced) == 1
        asked: list[object] = []

        def usage(place: object) -> SimpleNamespace:
            asked.append(place)
            return SimpleNamespace(free=5)

        monkeypatch.setattr("shutil.disk_usage", usage)
        monkeypatch.setattr(os, "name", "nt")
        assert journal.free_bytes() == 5
        assert asked == [tmp_path]
    finally:
        monkeypatch.undo()
        journal.close()
    assert (tmp_path / "journal").read_bytes() == b"header\r\n\n"


@pytest.mark.parametrize("code", ["CON", "nul", "Com1", "LPT9"])
def test_no_proposed_name_is_a_device_of_windows(code: str) -> None:
    assert session_name(code, "") == f"session_{code}"
    assert session_name(code, "2026-11-20T10:00:00+00:00") == f"{code}_2026-11-20"
    assert session_name("CONNY", "") == "CONNY"


def test_no_two_files_of_the_project_differ_in_capitals_only_or_have_names_that_windows_refuses() -> None:
    root = Path(__file__).parents[2]
    folders = ("app", "core", "devices", "packaging", "resources", "tests")
    places = [place for folder in folders for place in (root / folder).rglob("*") if "__pycache__" not in place.parts]
    names = [str(place.relative_to(root)) for place in places]
    assert len({name.casefold() for name in names}) == len(names)
    parts = {part for name in names for part in Path(name).parts}
    assert [part for part in parts if set(part) & set('<>:"|?*\\') or part.endswith((" ", "."))] == []
    assert [part for part in parts if part.partition(".")[0].lower() in DEVICES] == []
    assert max(map(len, names)) < 160  # and a home before it stays under 260


# processes


@pytest.mark.parametrize(("there", "used"), [(["fork", "spawn", "forkserver"], "forkserver"), (["spawn"], "spawn")])
def test_workers_are_started_afresh_where_there_is_no_server_that_makes_them(
    there: list[str], used: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    give = multiprocessing.get_context
    monkeypatch.setattr(multiprocessing, "get_all_start_methods", lambda: there)

    def noted(kind: str) -> object:
        asked.append(kind)
        return give(kind)

    monkeypatch.setattr(multiprocessing, "get_context", noted)
    executors.ProcessExecutor(1).shutdown()
    assert asked == [used]


def test_processors_are_counted_where_nobody_shows_which_may_be_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 6)
    assert executors.processors() == 6


@pytest.mark.usefixtures("windows")
def test_the_reader_of_files_and_the_program_begin_without_limits_of_resources() -> None:
    with pytest.raises(ModuleNotFoundError, match="resource"):  # as the two would, did they reach for it
        __import__("resource")
    limits.limit_this_process(1000)
    limits.limit_processor_time(1.0)


@pytest.mark.usefixtures("windows")
def test_the_program_begins_on_windows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before, level = list(logging.getLogger().handlers), logging.getLogger().level
    for hook in (sys, "excepthook"), (sys, "unraisablehook"):
        monkeypatch.setattr(*hook, getattr(*hook))
    monkeypatch.setattr("threading.excepthook", None)
    monkeypatch.setattr(cli, "log_folder", lambda: tmp_path)
    monkeypatch.setattr(sys, "warnoptions", ["error"])
    monkeypatch.setattr(sys, "argv", ["gaitwright"])
    monkeypatch.setattr(cli, "_open_window", lambda *_: 7)
    try:
        assert cli.main() == 7
    finally:
        for handler in set(logging.getLogger().handlers) - set(before):
            logging.getLogger().removeHandler(handler)
            handler.close()
        logging.getLogger().setLevel(level)


def test_the_programs_own_output_may_be_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    # a program with a window has none on Windows
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", None)
    monkeypatch.setattr(cli, "_open_window", lambda arguments, _language: 7 + len(arguments))
    assert cli.main([]) == 7


# the viewer, sounds, motion


@pytest.mark.parametrize(
    ("platform", "inside"),
    [("linux", "rerun"), ("win32", "rerun.exe"), ("darwin", "Rerun.app/Contents/MacOS/Rerun"), ("darwin", "rerun")],
)
def test_the_viewer_is_found_where_each_system_has_it(
    platform: str, inside: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / inside).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / inside).touch()
    found = SimpleNamespace(origin=str(tmp_path / "__init__.py"))
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: found)
    monkeypatch.setattr(sys, "platform", platform)
    assert viewer.viewer_program() == tmp_path / inside


class Started:
    """A viewer that was started, and is there until it is ended."""

    def __init__(self, command: list[str], env: dict[str, str], **_: object) -> None:
        self.command, self.environment = command, env

    def wait(self, _most_s: float | None = None) -> int:
        return 0

    def poll(self) -> int | None:
        return None

    def terminate(self) -> None: ...


@pytest.mark.parametrize(("platform", "is_home_ours"), [("linux", False), ("win32", False), ("darwin", True)])
def test_the_viewer_keeps_its_settings_with_us_on_each_system(
    platform: str, is_home_ours: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[Started] = []

    def start(command: list[str], **keywords: Any) -> Started:
        started.append(Started(command, **keywords))
        return started[-1]

    writing = ModuleType("app.review.rerun_log")
    vars(writing)["write_log"] = lambda *_: None
    monkeypatch.setitem(sys.modules, "app.review.rerun_log", writing)
    monkeypatch.setattr(files, "msvcrt", Msvcrt(), raising=False)
    monkeypatch.setattr(subprocess, "Popen", start)
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(sys, "platform", platform)
    shown = viewer.Viewer(tmp_path, tmp_path / "rerun")
    shown.open(SimpleNamespace(), SimpleNamespace())  # type: ignore[arg-type]  # a session that nobody reads
    shown.close()
    assert [one.command[1] for one in started] == ["analytics", "--bind"]
    for one in started:
        for name in ("XDG_CONFIG_HOME", "APPDATA", "LOCALAPPDATA"):
            assert Path(one.environment[name]).is_relative_to(tmp_path)
        assert one.environment["HTTPS_PROXY"].startswith("http://127.0.0.1:")  # else it asks for a newer one of itself
        assert (one.environment.get("HOME") == one.environment["APPDATA"]) == is_home_ours


def test_only_linux_needs_a_display_for_the_viewer(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    assert "rrd from the results on a computer with a display" in viewer.why_not(tmp_path)
    for platform in ("win32", "darwin"):
        monkeypatch.setattr(sys, "platform", platform)
        assert viewer.why_not(tmp_path) == ""


@pytest.mark.usefixtures("windows")
def test_windows_plays_sounds_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    played: Queue[tuple[str, int]] = Queue()
    winsound = ModuleType("winsound")
    vars(winsound).update(SND_FILENAME=1, SND_NODEFAULT=2, PlaySound=lambda file, flags: played.put((file, flags)))
    monkeypatch.setattr("app.system.sounds.winsound", winsound, raising=False)
    Loudspeaker(()).play(Sound.START)
    file, flags = played.get(timeout=20)
    assert file.endswith("start.wav")
    assert flags == 3


@pytest.mark.parametrize(("required", "took_ms"), [(1, 200), (0, 0)])
@pytest.mark.usefixtures("windows")
def test_windows_is_asked_whether_things_may_move(required: int, took_ms: int, monkeypatch: pytest.MonkeyPatch) -> None:
    def asked(_what: int, _zero: int, answer: Any, _flags: int) -> None:
        ctypes.cast(answer, ctypes.POINTER(ctypes.c_int))[0] = required

    user32 = SimpleNamespace(SystemParametersInfoW=asked)
    monkeypatch.setattr(ctypes, "windll", SimpleNamespace(user32=user32), raising=False)
    assert motion.duration_ms(200, Theme()) == took_ms


# ports and networks


@pytest.mark.usefixtures("windows")
def test_own_addresses_are_asked_by_name_on_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    reported: tuple[str, list[str], list[str]] = ("here", [], ["192.0.2.9", "127.0.0.1", "192.0.2.9"])
    monkeypatch.setattr(socket, "gethostbyname_ex", lambda _name: reported)
    assert networks.own_addresses() == ("192.0.2.9",)


@pytest.mark.usefixtures("windows")
def test_there_are_no_pseudo_terminals_on_windows(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="no pseudo-terminals"):
        PseudoTerminal(tmp_path / "port")


@pytest.mark.parametrize(("system", "found"), [("posix", ()), ("nt", ("COM7",))])
def test_a_port_that_somebody_named_is_there_where_it_is_no_file(
    system: str, found: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(ports.MORE_PORTS, "COM7")
    monkeypatch.setattr("serial.tools.list_ports.comports", list)
    monkeypatch.setattr(ports, "os", SimpleNamespace(name=system, environ=os.environ, pathsep=os.pathsep))
    assert tuple(port.device for port in ports.list_ports()) == found


@pytest.mark.parametrize(("system", "is_asked"), [("posix", True), ("nt", None)])
def test_a_port_is_exclusive_where_it_would_not_be_so_by_itself(
    system: str, is_asked: bool | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[object] = []
    monkeypatch.setattr(ports, "Serial", lambda *_, exclusive, **__: asked.append(exclusive))
    monkeypatch.setattr(ports, "os", SimpleNamespace(name=system))
    ports.SerialPort(ports.PortInfo("COM7"), 115200).open()
    assert asked == [is_asked]


@pytest.mark.parametrize(
    ("platform", "device", "problem", "stated"),
    [
        ("win32", "COM7", "could not open port 'COM7': PermissionError(13, 'Access is denied.')", "in use by another"),
        ("win32", "COM7", "could not open port 'COM7': FileNotFoundError(2, 'not found')", "was not found"),
        ("darwin", "/dev/cu.usbserial-7", OSError(errno.EACCES, "Permission denied"), "in use by another"),
        ("darwin", "/dev/cu.usbserial-7", OSError(errno.ENOENT, "No such file"), "was not found"),
    ],
)
def test_a_port_that_does_not_open_states_why_on_each_system(
    platform: str, device: str, problem: str | OSError, stated: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "platform", platform)

    def fail(*_: object, **__: object) -> None:
        raise problem if isinstance(problem, OSError) else OSError(problem)

    monkeypatch.setattr(ports, "Serial", fail)
    with pytest.raises(SourceRefusedError, match=stated) as refused:
        ports.SerialPort(ports.PortInfo(device), 115200).open()
    assert device in str(refused.value)


@pytest.mark.parametrize(
    ("device", "is_likely"),
    [("COM3", False), ("/dev/cu.Shimmer3-5F2A", True), ("/dev/rfcomm0", True), ("/dev/ttyS0", False)],
)
def test_a_port_that_is_no_usb_device_is_likely_by_its_name_only(device: str, is_likely: bool) -> None:
    assert ports.PortInfo(device).is_likely == is_likely
    assert ports.PortInfo(device, usb=(0x0403, 0x6001)).is_likely
