"""Common set-up of the tests of files. A small session on disk, to be spoilt in one way at a time."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from devices.files.limited_reader import LimitedReader, LimitedReading

COLUMNS = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyr_x_rad_s,gyr_y_rad_s,gyr_z_rad_s"
ROWS = ["0.0,0.1,0.2,9.8,0.01,0.02,0.03", "0.01,0.1,0.2,9.8,0.01,0.02,0.03", "0.02,0.1,0.2,9.8,0.01,0.02,0.03"]
TOML = """\
format = "gaitwright-session/1"
[[recordings]]
name = "walk 1"
kind = "walking"
folder = "walk_1"
"""

MakeSession = Callable[..., Path]


@pytest.fixture(scope="session")
def shared_reader() -> Iterator[LimitedReader]:
    """One process that reads, for the tests that do not end it: to start one takes half a second."""
    reader = LimitedReader()
    yield reader
    reader.close()


@pytest.fixture(scope="session")
def shared_reading(shared_reader: LimitedReader) -> LimitedReading:
    return LimitedReading(shared_reader, lambda: None)


@pytest.fixture
def make_session(tmp_path: Path) -> MakeSession:
    """A session with one walk: `make_session({"left_thigh.csv": text}, toml=text)` states what differs."""

    def make(files: dict[str, str | bytes] | None = None, toml: str | bytes = TOML) -> Path:
        folder = tmp_path / "session"
        shutil.rmtree(folder, ignore_errors=True)  # of the case before
        (folder / "walk_1").mkdir(parents=True)
        (folder / "session.toml").write_bytes(toml if isinstance(toml, bytes) else toml.encode())
        contents = {"left_thigh.csv": "\n".join([COLUMNS, *ROWS, ""])} if files is None else files
        for name, content in contents.items():
            (folder / "walk_1" / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        return folder

    return make
