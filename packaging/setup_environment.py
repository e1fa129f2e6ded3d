"""Requirements before Gaitwright can run: the locked parts in `.venv`, and the system libraries Qt is linked to.

Standard library only: this is what a machine with nothing but Python runs first. A finished environment carries a stamp
of what it was made from, so that the next start has only to compare it.
"""

import sys

if sys.version_info < (3, 11):  # noqa: UP036 - an older Python has to be told in words, not by a syntax error
    sys.exit(f"Gaitwright needs Python 3.11 or newer; this is {sys.version.split()[0]}. Start it with a newer one.")

import ctypes
import hashlib
import importlib.util
import os
import platform
import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NoReturn

ROOT = Path(__file__).resolve().parents[1]
VENV = ROOT / ".venv"
STAMP = VENV / "made-from"
RUNS = ("app", "core", "devices", "packaging", "resources", "LICENSE", "README.md", "pyproject.toml")
UNFINISHED = "unfinished"
RUNTIME, TESTED = "runtime.lock", "requirements.lock"  # the second holds the first, and what the tests need

# All that decides which wheels fit; a system update may change the rest of the version under a running set-up.
PYTHON_VERSION = f"{sys.version_info[0]}.{sys.version_info[1]}"

# Debian and Ubuntu keep the part of Python that makes environments in a package of its own.
VENV_PACKAGE = f"python{PYTHON_VERSION}-venv"

# What the wheels of PySide6 link to or load at run time and do not bring along: library, and Debian's name for it.
QT_LIBRARIES = {
    "libGL.so.1": "libgl1",
    "libEGL.so.1": "libegl1",
    "libxkbcommon.so.0": "libxkbcommon0",
    "libdbus-1.so.3": "libdbus-1-3",
    "libfontconfig.so.1": "libfontconfig1",
    "libglib-2.0.so.0": "libglib2.0-0",
    "libxcb-cursor.so.0": "libxcb-cursor0",
    "libxkbcommon-x11.so.0": "libxkbcommon-x11-0",
    "libxcb-icccm.so.4": "libxcb-icccm4",
    "libxcb-keysyms.so.1": "libxcb-keysyms1",
    "libxcb-shape.so.0": "libxcb-shape0",
}


class SetUpError(Exception):
    """Something is missing that only the user can bring. The message states what to do."""


def prepare(*, is_screen_needed: bool, lock: str = RUNTIME) -> Path:
    """Prepare all and give the environment's Python; raises SetUpError in sentences for the user.

    `lock` names what is installed: what the application needs, or that and what its tests need.
    """
    try:
        missing = missing_libraries()
        if not is_current(lock) and not can_make_environments():
            missing.append(VENV_PACKAGE)
        if missing and not install(missing) and (is_screen_needed or VENV_PACKAGE in missing):
            raise SetUpError(how_to_install(missing))
        if not is_current(lock):
            make_environment(lock)
    except KeyboardInterrupt:
        raise SetUpError("Stopped before everything was ready. Start again to go on.") from None
    return python()


def copied_to_user() -> Path | None:
    """Copy what runs to a folder of the user's, where `ROOT` is read-only, and give it; None where it is not.

    What was changed or removed since the last start is so in the copy too; its environment stays.
    """
    if os.access(ROOT, os.W_OK):
        return None
    place = _user_folder() / "gaitwright-copies" / hashlib.sha256(str(ROOT).encode()).hexdigest()[:16]
    try:
        kept = set()
        for source in _sources():
            name = source.relative_to(ROOT)
            kept.add(place / name)
            if not _is_same(source, place / name):
                (place / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, place / name)
                there = source.stat()  # its times alone: a copy may be written again
                os.utime(place / name, ns=(there.st_atime_ns, there.st_mtime_ns))
        for folder in RUNS:
            for old in [one for one in (place / folder).rglob("*") if one.is_file() and one not in kept]:
                old.unlink()
    except OSError as error:
        raise SetUpError(f"{ROOT} is read-only, and {place} cannot be written: {error.strerror}.") from error
    return place


def _sources() -> Iterator[Path]:
    for name in RUNS:
        found = [ROOT / name] if (ROOT / name).is_file() else sorted((ROOT / name).rglob("*"))
        yield from (one for one in found if one.is_file() and "__pycache__" not in one.parts)


def _is_same(source: Path, copy: Path) -> bool:
    try:
        there, here = source.stat(), copy.stat()
    except OSError:
        return False
    return (there.st_size, there.st_mtime_ns) == (here.st_size, here.st_mtime_ns)


def _user_folder() -> Path:
    if os.name == "nt":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support"
    return Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share")


def python() -> Path:
    return VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def fingerprint(lock: str = RUNTIME) -> str:
    """Hash what the environment is made from. Folder and packages count, because what is inside points at them."""
    packages = sorted(file.parent.name for file in ROOT.glob("*/__init__.py"))
    made_from = hashlib.sha256(f"{PYTHON_VERSION}\n{ROOT}\n{packages}\n".encode())
    for name in ("pyproject.toml", f"packaging/{lock}"):
        made_from.update((ROOT / name).read_bytes())
    return made_from.hexdigest()


def is_current(lock: str = RUNTIME) -> bool:
    """Whether nothing is to be installed: the tests' parts hold the application's."""
    return _stamp() in {fingerprint(lock), fingerprint(TESTED)} and python().exists()


def make_environment(lock: str) -> None:
    """Bring `.venv` to what the lock contains: a sound one is updated, a half-made or foreign one is made again."""
    if _stamp() == UNFINISHED or not _is_sound():
        say(f"Making a place for Gaitwright's parts in {VENV}.")
        shutil.rmtree(VENV, ignore_errors=True)
        # started by the environment that has just been removed, the Python behind it is still there
        base = getattr(sys, "_base_executable", sys.executable)
        _run_quietly(
            [base, "-m", "venv", str(VENV)],
            f"The folder {VENV} could not be made. Check that you may write there and that the disk has 2 GB free.",
        )
    STAMP.write_text(UNFINISHED, encoding="utf-8")
    say("Installing the parts Gaitwright is made of. This happens once and takes a minute or two.")
    # nothing is compiled in advance: most of it is never imported
    pip = [str(python()), "-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--no-deps", "--no-compile"]
    advice = "The parts could not be installed. Check the connection to the internet, then start again."
    parts = str(ROOT / "packaging" / lock)
    _run_quietly([*pip, "--only-binary", ":all:", "--require-hashes", "--requirement", parts], advice)
    _run_quietly([*pip, "--no-build-isolation", "--editable", str(ROOT)], advice)
    STAMP.write_text(fingerprint(lock), encoding="utf-8")


def can_make_environments() -> bool:
    return importlib.util.find_spec("ensurepip") is not None


def missing_libraries() -> list[str]:
    """Name what Qt lacks as Debian names it; elsewhere the names at least say what to look for."""
    if not sys.platform.startswith("linux"):
        return []
    return [package for library, package in QT_LIBRARIES.items() if not _loads(library)]


def install(packages: Sequence[str]) -> bool:
    """Install system packages where this user may; return whether they are there now."""
    if shutil.which("apt-get") is None or os.geteuid() != 0:
        return False
    names = " ".join(packages)
    say(f"Installing system libraries: {names}.")
    # a source that cannot be refreshed must not stop an installation from the others
    steps = f"apt-get update; apt-get install -y --no-install-recommends {names}"
    try:
        _run_quietly(
            ["sh", "-c", steps], "The system libraries could not be installed.", DEBIAN_FRONTEND="noninteractive"
        )
    except SetUpError as failure:
        say(str(failure))
        return False
    return True


def how_to_install(packages: Sequence[str]) -> str:
    names = " ".join(packages)
    if shutil.which("apt-get") is None:
        return f"System libraries are missing. Install what your system calls these, then start again: {names}"
    return (
        "System libraries are missing. Run this line, then start again:\n"
        f"    sudo apt-get update && sudo apt-get install -y {names}"
    )


def hand_over(command: list[str]) -> NoReturn:
    """Become `command`: signals reach it and its exit code is ours. Windows knows no such thing and waits for it."""
    if os.name == "nt":
        sys.exit(subprocess.call(command))
    os.execv(command[0], command)


def say(sentence: str) -> None:
    # standard output belongs to the command that is started
    print(sentence, file=sys.stderr, flush=True)


def _stamp() -> str:
    try:
        return STAMP.read_text(encoding="utf-8")
    except OSError:
        return ""


def _is_sound() -> bool:
    """Return whether `.venv` runs, has pip, and is of this Python."""
    question = "import pip, sys; print(*sys.version_info[:2], sep='.')"
    try:
        answer = subprocess.run([python(), "-c", question], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return False
    return answer.stdout.strip() == PYTHON_VERSION


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def _run_quietly(command: Sequence[str], advice: str, **environment: str) -> None:
    """Run one step of the set-up; what it prints is shown only when it fails."""
    answer = subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, **environment},
        check=False,
    )
    if answer.returncode != 0:
        raise SetUpError(f"{answer.stdout.strip()}\n\n{without_wheel(answer.stdout) or advice}")


def without_wheel(printed: str) -> str:
    """Name the part that exists, but not for this Python or computer; empty where pip failed at something else."""
    refused = re.search(r"No matching distribution found for ([\w.-]+)", printed)
    # a registry that was not reached says so first, and then that it found none
    if refused is None or "Could not find a version that satisfies" not in printed or "connection" in printed.lower():
        return ""
    return (
        f"{refused[1]} has no wheel for Python {PYTHON_VERSION} on this computer ({platform.system()}, "
        f"{platform.machine()}). Start Gaitwright with another Python from 3.11 on."
    )
