"""What is shared by the tests of drivers: a place for an emulated sensor's port."""

import sys
from pathlib import Path

import pytest


@pytest.fixture
def port(tmp_path: Path) -> Path:
    if sys.platform == "win32":
        pytest.skip("there are no pseudo-terminals here")
    return tmp_path / "port"
