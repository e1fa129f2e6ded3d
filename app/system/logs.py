"""Log of what went wrong, written down without a word about anybody.

Codes, notes, operators and paths come into messages as arguments and with exceptions, so neither is written: of a
message the text that is in our own source, with numbers, ids and our own fixed words in it; of an exception its
kind and where in our own source it was raised. Of what other libraries say, only which one it was and where.
"""

import errno
import logging
import os
import platform
import sys
import threading
import time
import traceback
from collections.abc import Iterator, Mapping
from contextlib import suppress
from enum import Enum
from functools import cache
from io import TextIOWrapper
from logging.handlers import RotatingFileHandler
from pathlib import Path
from types import TracebackType
from uuid import UUID

import platformdirs

HOME = __name__.removesuffix("app.system.logs")  # "gaitwright." where a wheel was installed
OWN_PACKAGES = tuple(HOME + name for name in ("app", "core", "devices"))
FILE_NAME = "gaitwright.log"
FILE_BYTES, OLD_FILES = 1_000_000, 4
LONGEST_CHAIN = 5  # exceptions of exceptions
REPORTED_LINES = 200
NAMED_LIBRARIES = (
    "PySide6-Essentials",
    "numpy",
    "scipy",
    "vqf",
    "SQLAlchemy",
    "sqlcipher3",
    "cryptography",
    "rerun-sdk",
)

_log = logging.getLogger(__name__)


def log_folder() -> Path:
    """The folder of the logs, in the user's data folder. It may not be there yet."""
    return platformdirs.user_data_path("gaitwright", appauthor=False) / "logs"


def start_logging(folder: Path) -> None:
    """Write what all loggers say into `folder`, and what ends a thread or the program. For the program's beginning."""
    handler = _PrivateFile(folder / FILE_NAME)
    handler.setFormatter(NamelessFormatter())
    root = logging.getLogger()
    root.addHandler(handler)
    root.setLevel(logging.WARNING)  # others are logged when something is wrong
    for package in OWN_PACKAGES:
        logging.getLogger(package).setLevel(logging.INFO)
    sys.excepthook = _show_end_of_program
    threading.excepthook = _show_end_of_thread
    sys.unraisablehook = _show_unraisable


def error_report(folder: Path) -> str:
    """What may be sent to whoever mends this: versions, the kind of machine, the log's last lines. No names in it."""
    libraries = [f"{name} {version_of(name)}" for name in ("gaitwright", *NAMED_LIBRARIES)]
    machine = f"Python {platform.python_version()}, {platform.system()} {platform.release()}, {platform.machine()}"
    try:
        lines = (folder / FILE_NAME).read_text(encoding="utf-8").splitlines()[-REPORTED_LINES:]
    except OSError:
        lines = ["No log was written."]
    return "\n".join([*libraries, machine, "", *lines, ""])


class NamelessFormatter(logging.Formatter):
    """One record as the text that our source holds, and one line for each exception and each place it came through."""

    def format(self, record: logging.LogRecord) -> str:
        at = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created))
        head = f"{at}.{int(record.msecs):03d}Z {version_of('gaitwright')} {record.process} {record.levelname}"
        logger = _module(record.name)
        text = _text(record) if _is_own(logger) else "wrote something"
        lines = [f"{head} {logger} line {record.lineno}: {text}"]
        error = record.exc_info[1] if isinstance(record.exc_info, tuple) else None
        if error is not None:
            lines += [f"    {line}" for line in pseudonymised(error)]
        return "\n".join(lines)


def pseudonymised(error: BaseException) -> Iterator[str]:
    """An exception, and what it came from, as kinds and places, without what they say."""
    reported: BaseException | None = error
    for _ in range(LONGEST_CHAIN):
        if reported is None:
            return
        yield _kind(reported)
        yield from _places(reported)
        if isinstance(reported, BaseExceptionGroup):
            for part in reported.exceptions[:LONGEST_CHAIN]:
                yield f"  of which: {_kind(part)}"
                yield from _places(part)
        reported = reported.__cause__ or (None if reported.__suppress_context__ else reported.__context__)


def _kind(error: BaseException) -> str:
    kind = type(error)
    name = f"{_module(kind.__module__)}.{kind.__name__}" if _has_known_name(kind) else "an exception"
    number = error.errno if isinstance(error, OSError) else None
    return f"{name} {errno.errorcode[number]}" if number is not None and number in errno.errorcode else name


def _has_known_name(kind: type) -> bool:
    """Whether the class is found in its module by its name: one made at run time may be called anything."""
    return getattr(sys.modules.get(kind.__module__), kind.__name__, None) is kind


def _places(error: BaseException) -> Iterator[str]:
    elsewhere = 0
    for frame, line in traceback.walk_tb(error.__traceback__):
        module = frame.f_globals.get("__name__")
        if isinstance(module, str) and _is_own(_module(module)):
            yield f"  at {module} line {line}, {frame.f_code.co_name}"
        else:
            elsewhere += 1
    if elsewhere:
        yield f"  and {elsewhere} more elsewhere"


def _text(record: logging.LogRecord) -> str:
    template = str(record.msg)
    if not record.args:
        return template
    arguments = record.args
    try:
        if isinstance(arguments, Mapping):
            return template % {name: _harmless(value) for name, value in arguments.items()}
        return template % tuple(_harmless(value) for value in arguments)
    except (TypeError, ValueError, KeyError):
        return template  # a text where the message wants a number


def _harmless(argument: object) -> object:
    """The argument where it is a number, an id, a class or a fixed word of ours; else only what kind of thing it is."""
    if isinstance(argument, Enum):
        return argument.name if _is_own(_module(type(argument).__module__)) else "(word)"
    if isinstance(argument, int):
        return int(argument)
    if isinstance(argument, float):
        return float(argument)
    if isinstance(argument, UUID):
        return UUID(int=argument.int)  # plain ones: a kind derived from them may say anything
    if isinstance(argument, type):
        return argument.__name__ if _has_known_name(argument) else "(type)"
    return f"({type(argument).__name__})" if _has_known_name(type(argument)) else "(thing)"


def _module(name: str) -> str:
    """The name of a module; a logger may be called anything, a patient's code included."""
    return name if name in sys.modules else "somebody"


def _is_own(module: str) -> bool:
    return any(module == package or module.startswith(f"{package}.") for package in OWN_PACKAGES)


@cache
def version_of(distribution: str) -> str:
    """What is installed of a library, or of this program."""
    import importlib.metadata  # it takes a twentieth of the time that the window may

    try:
        return importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


class _PrivateFile(RotatingFileHandler):
    """Made when there is something to write, readable by its owner only. Trouble with it never troubles the program."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, maxBytes=FILE_BYTES, backupCount=OLD_FILES, encoding="utf-8", delay=True)

    def _open(self) -> TextIOWrapper:
        path = Path(self.baseFilename)
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
        return open(descriptor, "a", encoding="utf-8", errors="backslashreplace")  # noqa: PTH123 - of a descriptor

    def rotate(self, source: str, dest: str) -> None:
        with suppress(OSError):  # where another program holds it, this one goes on in the same file
            super().rotate(source, dest)

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 - the name is the library's
        """Say nothing: the library would print the arguments."""


def _show_end_of_program(kind: type[BaseException], error: BaseException, _traceback: TracebackType | None) -> None:
    if issubclass(kind, KeyboardInterrupt):
        return
    _log.critical("the program ended early", exc_info=error)
    print(f"Gaitwright ended early. What is known of it, without names, is in {log_folder()}.", file=sys.stderr)


def _show_end_of_thread(ended: threading.ExceptHookArgs) -> None:
    if ended.exc_value is not None:
        _log.critical("a thread ended early", exc_info=ended.exc_value)


def _show_unraisable(met: "sys.UnraisableHookArgs") -> None:
    if met.exc_value is not None:
        _log.error("an error where nobody could catch it", exc_info=met.exc_value)
