"""Start this program again as a process of its own that does one thing, with little of the environment."""

import contextlib
import os
import subprocess
import sys
from pathlib import Path

Process = subprocess.Popen[bytes]

# of the environment: of Windows, of libraries that were put elsewhere, and of compiled modules
KEPT = frozenset({"SYSTEMROOT", "PATH", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "PYTHONPYCACHEPREFIX", "PYTHONUTF8"})


def start_process(module: str, word: str, *arguments: str) -> Process:
    """Start the module. It knows this program's modules, and takes none from the folder it is started in.

    `word` is the argument of a frozen program that is started as this process.
    """
    paths = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
    return subprocess.Popen(
        [*_this_program(module, word), *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**_environment(), "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"},
        creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
    )


def _this_program(module: str, word: str) -> list[str]:
    if getattr(sys, "frozen", False):  # it has no Python beside it: `app.__main__`
        return [sys.executable, word]
    return [sys.executable, "-P", "-m", module]


def _environment() -> dict[str, str]:
    """What starting Python needs: the rest may hold a server's address, or keys."""
    return {name: value for name, value in os.environ.items() if name in KEPT or name.startswith("OPENBLAS_")}


def end_process(process: Process) -> None:
    """Kill a process and wait until it is gone."""
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with contextlib.suppress(OSError):  # what could not be sent to it any more
                stream.close()
