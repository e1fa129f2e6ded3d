"""Tests that the command line lists what other packages bring, states what is wrong with it, and imports with it."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.cli import devices as devices_command
from app.cli.devices import list_devices
from app.cli.main import main
from app.importing import untrusted_files
from app.system import kept_json
from app.system.allowed_drivers import allow_drivers
from devices.files.limited_reader import LimitedReader
from devices.files.session_folder import read_session
from devices.other_drivers import BrokenDriverError
from devices.other_packages import IMPORTERS, SENSORS
from devices.search import SearchResult
from tests.other_authors import install_plugin, site_of_others, write_package


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    reader = LimitedReader()  # that of the program may run already, with other packages
    monkeypatch.setattr(untrusted_files, "the_reader", lambda: reader)
    monkeypatch.setattr(kept_json, "place_of", tmp_path.joinpath)
    monkeypatch.setattr(devices_command, "own_radio", lambda: None)
    monkeypatch.setattr(devices_command, "search", lambda **_: SearchResult(broken=(failure(),)))
    yield from site_of_others(tmp_path, monkeypatch)
    reader.close()


def failure() -> BrokenDriverError:
    return BrokenDriverError("The driver {driver} stopped", "Install another {driver}", driver="sum-sensor")


def test_without_other_packages_there_is_no_word_of_them(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(devices_command, "search", lambda **_: SearchResult())
    assert [line for line in list_devices() if "other packages" in line] == []


def test_what_other_packages_bring_is_listed_with_what_is_wrong_with_it(site: Path) -> None:
    write_package(site, "strange", SENSORS, {"one": "OFFER = 5", "two": "raise RuntimeError"}, "2.1")
    write_package(site, "another", SENSORS, {"three": "raise RuntimeError"})
    write_package(site, "reader", IMPORTERS, {"csv": "OFFER = 5", "card": "OFFER = 5"})
    allow_drivers("strange", "2.1", is_allowed=True)
    lines = list(list_devices())
    assert lines[lines.index("Drivers of other packages:") :][:6] == [
        "Drivers of other packages:",
        "- another 1.0, three: not allowed; this is set in the application.",
        "- strange 2.1, one, two: allowed.",
        "- one of strange was left out: it is no Driver.",
        "- two of strange was left out: it cannot be loaded (RuntimeError).",
        "- The driver sum-sensor stopped. Install another sum-sensor.",
    ]
    assert lines[lines.index("File formats of other packages:") :] == [
        "File formats of other packages:",
        "- card of reader 1.0: left out: it is no FileFormat.",
        "- csv of reader 1.0: left out: the name csv is already used by gaitwright.",
    ]


def test_a_format_that_no_package_offers_is_bad_usage(
    site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["import", "x", "--as", "sum-card", "--map", "left_shank=x", "--out", str(tmp_path / "out")])
    assert ended.value.code == 2
    assert "sum-card is none of xsens-mtmanager" in capsys.readouterr().err


@pytest.mark.endurance
def test_a_file_of_the_example_package_is_imported(site: Path, tmp_path: Path) -> None:
    install_plugin(site, tmp_path)
    kind = np.dtype([("counter", "<u4"), ("rate", "<i2", 3), ("force", "<i2", 3)])
    rows = np.zeros(300, kind)
    rows["counter"], rows["force"][:, 2] = np.arange(300), 981
    (tmp_path / "shank.bin").write_bytes(b"SUM1" + rows.tobytes())
    for number, more in enumerate(([], ["--as", "sum-card"])):
        out = tmp_path / f"session {number}"
        placed = ["--map", "left_shank=shank", "--kind", "standing"]
        assert main(["import", str(tmp_path / "shank.bin"), *more, *placed, "--out", str(out)]) == 0
        (recording,) = read_session(out).recordings
        assert [str(site) for site in recording.imu] == ["left_shank"]
    lines = list(list_devices())
    assert "- gaitwright-sum-sensor 1.0, sum-sensor: not allowed; this is set in the application." in lines
    assert "- sum-card of gaitwright-sum-sensor 1.0: can be read." in lines
