"""Limits of a process that reads foreign files.

What holds where:

- Linux: the memory, as address space; processor time by `limit_processor_time`; not a byte written to a file; by
  Landlock (kernel 5.13) nothing created, changed, renamed or deleted, no program started, and nothing read but what is
  asked for; by `system_calls` (x86_64 and aarch64) no socket, no other process, no modes and times.
- macOS: processor time and not a byte written. The system takes a limit of memory, but does not hold to it.
- Windows: none of these.

The deadline of `limited_reader` holds everywhere. The number of processes is not limited: threads count as such, and
Arrow needs some.
"""

import contextlib
import ctypes
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

if sys.platform != "win32":
    import resource

OPEN_FILES = 128

# the same numbers on every architecture
SYS_LANDLOCK_CREATE_RULESET, SYS_LANDLOCK_ADD_RULE, SYS_LANDLOCK_RESTRICT_SELF = 444, 445, 446
PATH_BENEATH = 1
LANDLOCK_VERSION = 1  # the flag that asks for the version
PR_SET_NO_NEW_PRIVS = 38
READ_FILE, READ_DIR = 1 << 2, 1 << 3
RIGHTS_OF_VERSION = {1: 13, 2: 14, 3: 15, 4: 15}  # how many rights of files each version knows; 16 since the fifth
LATEST_RIGHTS = 16
TCP_BIND_AND_CONNECT = 0b11
OTHERS_SOCKETS_AND_SIGNALS = 0b11


# what libraries read of the system when they are loaded
SYSTEMS = (
    *("/usr/lib", "/usr/lib64", "/lib", "/lib64", "/usr/share/zoneinfo", "/etc/ld.so.cache", "/etc/localtime"),
    *(
        "/dev/null",
        "/dev/urandom",
        "/sys/devices/system/cpu",
        "/proc/cpuinfo",
        "/proc/meminfo",
        "/proc/self",
        "/sys/fs/cgroup",
    ),
)


class _PathBeneath(ctypes.Structure):
    _pack_ = 1
    _fields_ = (("rights", ctypes.c_uint64), ("folder", ctypes.c_int32))


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


def limit_this_process(memory_bytes: int) -> None:
    """Give up for good what reading does not need, before a second thread exists; unknown limits are left out."""
    limit_resources(memory_bytes)
    if sys.platform == "linux":
        _forbid_writing()


def limit_resources(memory_bytes: int) -> None:
    """Limit the memory and the open files, and forbid every byte written to a file: but not on Windows."""
    if sys.platform == "win32":
        return
    for limit, most in (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),  # it would hold what a patient's file holds
        (resource.RLIMIT_NOFILE, OPEN_FILES),
    ):
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(limit, (most, most))


def limit_processor_time(more_s: float) -> None:
    """Let the system end this process once it has computed `more_s` more of processor time."""
    if sys.platform == "win32":
        return
    used = resource.getrusage(resource.RUSAGE_SELF)
    most_s = int(used.ru_utime + used.ru_stime + more_s) + 1
    _, highest_s = resource.getrlimit(resource.RLIMIT_CPU)
    if highest_s == resource.RLIM_INFINITY or most_s <= highest_s:
        resource.setrlimit(resource.RLIMIT_CPU, (most_s, highest_s))


def forbid_reading(files: Sequence[Path], listed: Sequence[Path] = ()) -> None:
    """Let Landlock refuse reads except of `files` (folders whole), Python, libraries, and names in `listed`."""
    _restrict(READ_FILE | READ_DIR, {**dict.fromkeys(listed, READ_DIR), **dict.fromkeys((*files, *_own()), 0)})


def _own() -> list[Path]:
    """Where Python, its packages and the system's libraries are."""
    packages = [Path(__file__).parents[2] / name for name in ("core", "devices")]
    ours = [Path(entry) for entry in sys.path if Path(entry).name in ("site-packages", "dist-packages", "lib-dynload")]
    # an installed bundle's modules are in its executable, which is opened for each that is not imported yet
    prefixes = [Path(prefix) for prefix in (sys.base_prefix, sys.prefix, getattr(sys, "_MEIPASS", sys.prefix))]
    prefixes.append(Path(sys.executable))
    cache = [Path(sys.pycache_prefix)] if sys.pycache_prefix else []
    return [*packages, *ours, *prefixes, *cache, *map(Path, SYSTEMS)]


def _forbid_writing() -> None:
    """Let Landlock refuse every change of any file, every start of a program and every TCP connection."""
    version = _landlock(SYS_LANDLOCK_CREATE_RULESET, None, 0, LANDLOCK_VERSION)
    every_right = (1 << RIGHTS_OF_VERSION.get(version, LATEST_RIGHTS)) - 1
    _restrict(every_right & ~(READ_FILE | READ_DIR), {})


def _restrict(rights: int, allowed: Mapping[Path, int]) -> None:
    """Give up `rights` but beneath `allowed`, each with those that it names; none: with all of them."""
    version = _landlock(SYS_LANDLOCK_CREATE_RULESET, None, 0, LANDLOCK_VERSION)
    if version < 1:
        return  # a kernel without it
    rules = _Ruleset(files=rights, network=TCP_BIND_AND_CONNECT, scoped=OTHERS_SOCKETS_AND_SIGNALS)
    size = 8 if version < 4 else 16 if version < 6 else 24
    ruleset = _landlock(SYS_LANDLOCK_CREATE_RULESET, ctypes.byref(rules), size, 0)
    if ruleset < 0 or ctypes.CDLL(None).prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0:
        return
    for path, some in allowed.items():
        with contextlib.suppress(OSError):  # what is not there needs no leave
            beneath = os.open(path, os.O_PATH | os.O_CLOEXEC)
            granted = (some or rights) if path.is_dir() else rights & READ_FILE
            _landlock(SYS_LANDLOCK_ADD_RULE, ruleset, PATH_BENEATH, ctypes.byref(_PathBeneath(granted, beneath)), 0)
            os.close(beneath)
    _landlock(SYS_LANDLOCK_RESTRICT_SELF, ruleset, 0)
    os.close(ruleset)


def _landlock(*call: object) -> int:
    return int(ctypes.CDLL(None).syscall(*call))
