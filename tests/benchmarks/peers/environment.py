"""Environment for peers that cannot share ours. It is one of their own, made here when it is first asked for."""

import shutil
import subprocess
import venv
from pathlib import Path

REQUIREMENTS = Path(__file__).with_name("requirements.txt")
PLACE = Path(__file__).parents[3] / "build" / "peers"


def peers_python() -> Path:
    """The Python of the peers' environment."""
    python = PLACE / "bin" / "python"
    stamp = PLACE / "made-from"
    if stamp.is_file() and stamp.read_text() == REQUIREMENTS.read_text():
        return python
    shutil.rmtree(PLACE, ignore_errors=True)
    venv.create(PLACE, with_pip=True)
    install = [str(python), "-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--only-binary", ":all:"]
    done = subprocess.run([*install, "--requirement", str(REQUIREMENTS)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"the peers could not be installed: {done.stderr.strip()}")
    stamp.write_text(REQUIREMENTS.read_text())
    return python
