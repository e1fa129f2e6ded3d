"""No name gets into the logs, whichever way it comes; what went wrong can still be seen in them."""

import ast
import errno
import importlib.util
import logging
import os
import stat
import subprocess
import sys
import threading
from collections.abc import Iterator
from enum import StrEnum
from logging.handlers import RotatingFileHandler
from pathlib import Path
from typing import Any
from uuid import UUID

import pytest

from app.storage.journal.disk import Trouble
from app.system import logs
from app.system.logs import FILE_NAME, NamelessFormatter, error_report, pseudonymised, start_logging

ROOT = Path(__file__).parents[3]
NAMES = [f"Kowalczyk-{number:03d}" for number in range(200)]
ID = UUID(int=7)


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    """Logging as the program starts it, and as it was before."""
    root = logging.getLogger()
    before = root.level, sys.excepthook, threading.excepthook, sys.unraisablehook
    start_logging(tmp_path / "logs")
    yield tmp_path / "logs"
    for handler in [handler for handler in root.handlers if isinstance(handler, RotatingFileHandler)]:
        root.removeHandler(handler)
        handler.close()
    root.setLevel(before[0])
    for package in logs.OWN_PACKAGES:
        logging.getLogger(package).setLevel(logging.NOTSET)
    sys.excepthook, threading.excepthook, sys.unraisablehook = before[1:]


def written(folder: Path) -> str:
    return "".join(path.read_text(encoding="utf-8") for path in sorted(folder.iterdir()))


class Unraisable:
    """What the interpreter hands to `sys.unraisablehook`, and lets nobody make."""

    def __init__(self, error: BaseException, name: str) -> None:
        self.exc_type: type[BaseException] = type(error)
        self.exc_value: BaseException | None = error
        self.exc_traceback = error.__traceback__
        self.err_msg: str | None = name
        self.object: Any = name


class Odd(StrEnum):
    """Words of somebody else: `Trouble` is one of ours."""

    NAME = NAMES[0]


def raise_with(name: str, folder: Path) -> None:
    """Fail as storage, files and libraries fail: with the name in the message, the path and the cause."""
    try:
        (folder / name / "session.toml").read_bytes()
    except OSError as error:
        invented = type(name, (Exception,), {"__module__": "app.system.logs"})
        raise ExceptionGroup(name, [ValueError(f"{name} is not a number"), invented(name)]) from error


def plant(name: str, folder: Path) -> None:
    """Let `name` try every way into the logs."""
    own, other = logging.getLogger("app.system.logs"), logging.getLogger("sqlalchemy.engine")
    own.warning("%s was not found in %s", name, folder / name)
    own.warning("%(patient)s has %(count)d walks", {"patient": name, "count": 3})
    own.warning("%d walks", name)  # a call that is wrong
    own.warning("notes: %r", [name, {name: name}])
    own.info("state %s of %s", Odd.NAME, type(name, (Exception,), {"__module__": "app.system.logs"}))
    other.error(f"INSERT INTO patients VALUES ({name!r})")
    logging.getLogger(name).error("something")
    logging.getLogger(f"app.{name}").error("something")
    try:
        raise_with(name, folder)
    except ExceptionGroup as error:
        error.add_note(name)
        own.exception("reading %s failed", name)
        sys.excepthook(type(error), error, error.__traceback__)
        sys.unraisablehook(Unraisable(error, name))
    thread = threading.Thread(target=raise_with, args=(name, folder), name=name)
    thread.start()
    thread.join()


def test_of_200_planted_names_none_is_in_the_logs_and_none_in_a_report(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    root = logging.getLogger()
    ours = [handler for handler in root.handlers if isinstance(handler, RotatingFileHandler)]
    monkeypatch.setattr(root, "handlers", ours)  # pytest's own stumbles over a call that is wrong
    for name in NAMES:
        plant(name, tmp_path)
    text = written(folder) + error_report(folder) + capsys.readouterr().err
    assert [name for name in NAMES if name in text] == []
    assert tmp_path.name not in written(folder)
    assert written(folder).count("the program ended early") == len(NAMES)  # nothing was rotated away yet
    assert "a thread ended early" in text


def test_a_line_keeps_our_own_words_numbers_and_ids(folder: Path) -> None:
    logging.getLogger("app.system.logs").warning(
        "%s of %s: %d, %.1f, %s, %s", Trouble.DISK_FULL, ID, 3, 2.5, KeyError, "Anna"
    )
    line = _line_of('getLogger("app.system.logs").warning(')
    assert written(folder).endswith(
        f"WARNING app.system.logs line {line}: DISK_FULL of {ID}: 3, 2.5, KeyError, (str)\n"
    )


def _line_of(text: str) -> int:
    lines = Path(__file__).read_text(encoding="utf-8").splitlines()
    return next(number for number, line in enumerate(lines, 1) if text in line)


def test_an_exception_keeps_its_kind_and_where_in_our_source_it_was_raised() -> None:
    from app.storage.journal.header import read_header

    with pytest.raises(FileNotFoundError) as caught:
        read_header(Path("Anna.journal"))
    reported = list(pseudonymised(caught.value))
    assert reported[0] == f"builtins.FileNotFoundError {errno.errorcode[errno.ENOENT]}"
    assert any("at app.storage.journal.header line" in line and line.endswith("read_header") for line in reported)


def test_files_are_the_owners_and_never_more_than_five(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (ours,) = [handler for handler in logging.getLogger().handlers if isinstance(handler, RotatingFileHandler)]
    monkeypatch.setattr(ours, "maxBytes", 5000)
    for number in range(500):
        logging.getLogger("app.system.logs").info("%d of many", number)
    files = sorted(folder.iterdir())
    assert [path.name for path in files] == [FILE_NAME, *(f"{FILE_NAME}.{k}" for k in range(1, 5))]
    assert all(path.stat().st_size <= 5000 for path in files)
    if os.name != "nt":
        assert {stat.S_IMODE(path.stat().st_mode) for path in files} == {0o600}
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700


def test_a_log_that_cannot_be_written_troubles_nobody(
    tmp_path: Path, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "logs").write_text("a file where the folder should be")
    logging.getLogger("app.system.logs").error("%s", "Anna")
    assert capsys.readouterr().err == ""
    (tmp_path / "logs").unlink()
    (tmp_path / "logs").mkdir()


def test_every_message_of_ours_is_a_fixed_text() -> None:
    # an f-string would carry its values past the filter
    calls = {"debug", "info", "warning", "error", "exception", "critical"}
    found = []
    for file in [file for package in logs.OWN_PACKAGES for file in (ROOT / package).rglob("*.py")]:
        text = file.read_text(encoding="utf-8")
        if "log" not in text:  # looked for first: taking a file apart takes long
            continue
        for node in ast.walk(ast.parse(text)):
            match node:
                case ast.Call(func=ast.Attribute(value=ast.Name(id="_log" | "log" | "logging"), attr=name)):
                    is_fixed = bool(node.args) and isinstance(node.args[0], ast.Constant)
                    if name in calls and not is_fixed:
                        found.append(f"{file.relative_to(ROOT)}:{node.lineno}")
    assert found == []


def test_the_program_itself_ends_without_a_traceback_and_without_a_core_dump(tmp_path: Path) -> None:
    ends = """
import sys
from app.cli import main as cli
cli.parser = lambda: 1 / 0
sys.argv = ["gaitwright", "analyse", "Anna"]
cli.main()
"""
    environment = {**os.environ, "XDG_DATA_HOME": str(tmp_path), "HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path)}
    ended = subprocess.run(
        [sys.executable, "-c", ends], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 1
    assert ended.stderr.startswith("Gaitwright ended early.")
    assert "Traceback" not in ended.stderr
    (log,) = tmp_path.rglob(FILE_NAME)
    assert "builtins.ZeroDivisionError" in log.read_text(encoding="utf-8")
    assert "Anna" not in log.read_text(encoding="utf-8")


@pytest.mark.skipif(importlib.util.find_spec("resource") is None, reason="this system has no limits on core dumps")
def test_a_running_program_leaves_no_core_dump() -> None:
    asks = """
import resource, sys
from app.cli import main as cli
sys.argv = ["gaitwright", "--help"]
try:
    cli.main()
except SystemExit:
    print(max(resource.getrlimit(resource.RLIMIT_CORE)))
"""
    asked = subprocess.run([sys.executable, "-c", asks], cwd=ROOT, capture_output=True, text=True, check=True)
    assert int(asked.stdout.splitlines()[-1]) <= 1


def test_the_formatter_needs_no_arguments_to_be_right() -> None:
    record = logging.LogRecord("app.system.logs", logging.INFO, "", 1, "%s and %s", ("only one",), None)
    assert NamelessFormatter().format(record).endswith(": %s and %s")
