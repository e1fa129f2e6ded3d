"""Limits of a process that reads foreign files.

What holds where:

- Linux: the memory, as address space; processor time by `limit_processor_time`; not a byte written to a file; by
  Landlock (kernel 5.13) nothing created, changed, renamed or deleted and no program started, since 6.7 no TCP either.
- macOS: processor time and not a byte written. The system takes a limit of memory, but does not hold to it.
- Windows: none of these.

The deadline of `limited_reader` holds everywhere. The number of processes is not limited: threads count as such, and
Arrow needs some.
"""

import contextlib
import ctypes
import sys

OPEN_FILES = 128

SYS_LANDLOCK_CREATE_RULESET, SYS_LANDLOCK_RESTRICT_SELF = 444, 446  # the same number on every architecture
LANDLOCK_VERSION = 1  # the flag that asks for the version
PR_SET_NO_NEW_PRIVS = 38
READ_FILE, READ_DIR = 1 << 2, 1 << 3
RIGHTS_OF_VERSION = {1: 13, 2: 14, 3: 15, 4: 15}  # how many rights of files each version knows; 16 since the fifth
LATEST_RIGHTS = 16
TCP_BIND_AND_CONNECT = 0b11
OTHERS_SOCKETS_AND_SIGNALS = 0b11


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


def limit_this_process(memory_bytes: int) -> None:
    """Give up for good what reading does not need. To be called before there is a second thread.

    A limit that this system does not know is left out: the deadline of whoever waits for this process remains.
    """
    if sys.platform == "win32":
        return
    import resource

    for limit, most in (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),  # it would hold what a patient's file holds
        (resource.RLIMIT_NOFILE, OPEN_FILES),
    ):
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(limit, (most, most))
    if sys.platform == "linux":
        _forbid_writing()


def limit_processor_time(more_s: float) -> None:
    """Let the system end this process once it has computed `more_s` longer than until now.

    Parameters
    ----------
    more_s
        Of processor time.
    """
    if sys.platform == "win32":
        return
    import resource

    used = resource.getrusage(resource.RUSAGE_SELF)
    most_s = int(used.ru_utime + used.ru_stime + more_s) + 1
    _, highest_s = resource.getrlimit(resource.RLIMIT_CPU)
    if highest_s == resource.RLIM_INFINITY or most_s <= highest_s:
        resource.setrlimit(resource.RLIMIT_CPU, (most_s, highest_s))


def _forbid_writing() -> None:
    """Let Landlock refuse every change of any file, every start of a program and every TCP connection."""
    system = ctypes.CDLL(None, use_errno=True)
    version = system.syscall(SYS_LANDLOCK_CREATE_RULESET, None, 0, LANDLOCK_VERSION)
    if version < 1:
        return  # a kernel without it
    every_right = (1 << RIGHTS_OF_VERSION.get(version, LATEST_RIGHTS)) - 1
    rules = _Ruleset(
        files=every_right & ~(READ_FILE | READ_DIR), network=TCP_BIND_AND_CONNECT, scoped=OTHERS_SOCKETS_AND_SIGNALS
    )
    size = 8 if version < 4 else 16 if version < 6 else 24
    ruleset = system.syscall(SYS_LANDLOCK_CREATE_RULESET, ctypes.byref(rules), size, 0)
    if ruleset >= 0 and system.prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0:
        system.syscall(SYS_LANDLOCK_RESTRICT_SELF, ruleset, 0)
