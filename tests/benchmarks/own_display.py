"""A display that nobody else uses (Xvfb with openbox), and an environment in which the application is a new user's."""

import os
import subprocess
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

OWN_FOLDERS = ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME")


@contextmanager
def own_display(size: tuple[int, int] = (1920, 1200)) -> Iterator[str]:
    """Give the display's name."""
    quiet = subprocess.DEVNULL
    read, write = os.pipe()
    screen = f"{size[0]}x{size[1]}x24"
    with ExitStack() as stack:
        server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", screen, "-nolisten", "tcp"],
            pass_fds=[write],
            stderr=quiet,
        )
        stack.callback(_end, server)
        os.close(write)
        with os.fdopen(read) as number:
            display = f":{number.readline().strip()}"
        manager = subprocess.Popen(
            ["openbox", "--sm-disable"], env={**os.environ, "DISPLAY": display}, stdout=quiet, stderr=quiet
        )
        stack.callback(_end, manager)
        time.sleep(1.0)  # until it manages windows
        yield display


@contextmanager
def own_environment(display: str) -> Iterator[Mapping[str, str]]:
    """Give the environment of a process whose user has nothing yet; modules are compiled for it once."""
    with tempfile.TemporaryDirectory(prefix="gaitwright-") as folder:
        places = {name: str(Path(folder) / name.lower()) for name in OWN_FOLDERS}
        for place in places.values():
            Path(place).mkdir()
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        environment |= places | {
            "DISPLAY": display,
            "QT_QPA_PLATFORM": "xcb",
            "OPENBLAS_NUM_THREADS": "1",
            "PYTHONPYCACHEPREFIX": str(Path(folder) / "compiled"),
        }
        yield environment


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    process.wait()
