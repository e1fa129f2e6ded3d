"""A file of another package's format is imported in the window, under the format's name."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.importing import untrusted_files
from devices.files.limited_reader import LimitedReader
from devices.other_packages import IMPORTERS
from tests.app.home.importing.test_importing import read, shown
from tests.devices.files.test_other_formats import source_of
from tests.other_authors import site_of_others, write_package

pytestmark = pytest.mark.endurance  # a process of its own


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    reader = LimitedReader()  # that of the program may run already, without the package
    monkeypatch.setattr(untrusted_files, "the_reader", lambda: reader)
    yield from site_of_others(tmp_path, monkeypatch)
    reader.close()


def test_a_recording_is_shown_with_the_name_of_its_format(qtbot: QtBot, home: Home, site: Path, tmp_path: Path) -> None:
    write_package(site, "strange", IMPORTERS, {"strange-card": source_of()})
    file = tmp_path / "left shank.bin"
    file.write_bytes(b"STRANGE\x00\x01")
    assert "1 recording of strange-card" in shown(read(qtbot, home, file))
