"""Programs of other authors that tests ask what our files hold. They need not be in the environment of the tests.

`GAITWRIGHT_OTHER_PYTHON` names a Python that has those of them that bring another Qt or other versions than ours:
`uv venv PLACE && uv pip install --python PLACE/bin/python kineticstoolkit pyomeca bids-validator-deno`.
`NODE_PATH` names the folder of Node's packages: `npm install --prefix PLACE fhir` and PLACE/node_modules.
"""

import json
import os
import shutil
import subprocess
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any

import pytest

OTHER_PYTHON = "GAITWRIGHT_OTHER_PYTHON"
VERSION = """
import sys
from importlib.metadata import PackageNotFoundError, version
try:
    print(version(sys.argv[1]))
except PackageNotFoundError:
    pass
"""


@lru_cache
def version_in_python(package: str) -> tuple[str, str]:
    """The version of a Python package and the Python that has it; empty where none has."""
    for python in (sys.executable, os.environ.get(OTHER_PYTHON, "")):
        if python:
            found = subprocess.run([python, "-c", VERSION, package], capture_output=True, text=True, check=True).stdout
            if found.strip():
                return found.strip(), python
    return "", ""


@lru_cache
def version_in_node(package: str) -> str:
    """The version of a package of Node; empty without."""
    folder = Path(os.environ.get("NODE_PATH", "")) / package / "package.json"
    if shutil.which("node") is None or not os.environ.get("NODE_PATH") or not folder.is_file():
        return ""
    return str(json.loads(folder.read_text(encoding="utf-8"))["version"])


def ask_python(package: str, script: str, *arguments: str | Path) -> Any:
    """What a script with a package prints as JSON; skips the test where no Python has the package."""
    _, python = version_in_python(package)
    if not python:
        pytest.skip(f"{package} is installed neither here nor in the Python that {OTHER_PYTHON} names")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return _answer([python, "-W", "ignore", "-c", script, *map(str, arguments)], environment)


def ask_node(package: str, script: str, *arguments: str | Path) -> Any:
    """What a script with a package of Node prints as JSON; skips the test without."""
    if not version_in_node(package):
        pytest.skip(f"npm's {package} is not in the folder that NODE_PATH names, or there is no node")
    return _answer(["node", "-e", script, "--", *map(str, arguments)], dict(os.environ))


def _answer(command: list[str], environment: dict[str, str]) -> Any:
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])
