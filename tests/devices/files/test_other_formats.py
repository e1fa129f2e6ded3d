"""Tests that formats of other packages are read within limits, and that a faulty one harms no other file."""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from devices.files.limited_reader import LimitedReader, LimitedReading, ReadingEndedError
from devices.files.other_formats import offered_formats
from devices.files.refusal import FileRefusedError
from devices.other_packages import IMPORTERS
from tests.other_authors import install_plugin, site_of_others, write_package

IS_LINUX: bool = sys.platform == "linux"
READER = """
import numpy as np
from pathlib import Path
from gaitwright.core import ImuBlock, SensorInfo
from gaitwright.devices import FileFormat, FileRefusedError, ImportedSensor, ImportedTrial

TIME_S = np.arange(5) / 100.0

def is_it(path, head):
    {is_it}

def sensor(time_s=TIME_S, name="one", values=np.zeros((5, 3)), rate_hz=100.0):
    return ImportedSensor(name, (name,), "x", ImuBlock(name, time_s, values, values), SensorInfo(rate_hz=rate_hz))

def trial(files, rate_hz):
    {trial}

OFFER = FileFormat(is_it, trial)
"""
BY_MARK = 'return head.startswith(b"STRANGE")'
ONE = 'return ImportedTrial("strange", (sensor(),))'
OUR_CSV = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyr_x_rad_s,gyr_y_rad_s,gyr_z_rad_s\n" + "".join(
    f"{0.01 * k:.2f},0,0,9.8,0,0,{k}\n" for k in range(20)
)


def source_of(is_it: str = BY_MARK, trial: str = ONE, first: str = "") -> str:
    return f"{first}\n{READER.format(is_it=is_it, trial=trial)}"


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    yield from site_of_others(tmp_path, monkeypatch)


@pytest.fixture
def reading(site: Path) -> Iterator[LimitedReading]:
    """In a process that is started when it is first asked: after a test has written its packages."""
    reader = LimitedReader()
    yield LimitedReading(reader, lambda: None)
    reader.close()


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """One of a stranger's and one of ours."""
    folder = tmp_path / "files"
    folder.mkdir()
    (folder / "b.bin").write_bytes(b"STRANGE\x00\x01")
    (folder / "a.csv").write_text(OUR_CSV, encoding="utf-8")
    return folder / "b.bin", folder / "a.csv"


@pytest.mark.endurance
def test_a_file_of_the_example_package_is_gathered_and_read(
    site: Path, reading: LimitedReading, tmp_path: Path
) -> None:
    install_plugin(site, tmp_path)
    kind = np.dtype([("counter", "<u4"), ("rate", "<i2", 3), ("force", "<i2", 3)])
    rows = np.zeros(50, kind)
    rows["counter"], rows["rate"][:, 1], rows["force"][:, 2] = np.arange(50), np.arange(50), 981
    card = tmp_path / "shank.bin"
    card.write_bytes(b"SUM1" + rows.tobytes())
    (trial,) = reading.gather([card]).trials
    assert (trial.format, trial.name, trial.is_one_sensor) == ("sum-card", "shank", True)
    for asked in ("", "sum-card"):
        found = reading.read_trial(asked, [card], None)
        assert found.format == "sum-card"
        np.testing.assert_allclose(found.sensors[0].block.gyr_rad_s[:, 1], 0.01 * np.arange(50))
        np.testing.assert_allclose(found.sensors[0].block.time_s, 0.01 * np.arange(50))
    (offer,) = offered_formats()
    assert reading.why_unusable(offer) == ""
    card.write_bytes(b"SUM1" + rows.tobytes()[:-1])
    with pytest.raises(FileRefusedError, match=r"shank\.bin: the last row is cut off"):
        reading.read_trial("", [card], None)


def test_a_file_of_ours_is_shown_to_no_other_package(
    site: Path, reading: LimitedReading, files: tuple[Path, Path]
) -> None:
    write_package(site, "strange", IMPORTERS, {"greedy": source_of(is_it="return True")})
    stranger, ours = files
    for chosen in ([stranger, ours], [ours.parent]):
        found = reading.gather(chosen)
        assert [(trial.format, len(trial.files)) for trial in found.trials] == [("csv", 1), ("greedy", 1)]
    assert reading.read_trial("", [ours], None).format == "csv"
    assert reading.read_trial("", [stranger], None).format == "greedy"


@pytest.mark.endurance
@pytest.mark.parametrize(
    "source",
    [
        source_of(first="raise RuntimeError"),
        source_of(first="import os; os._exit(5)"),
        source_of(is_it="raise ZeroDivisionError"),
        source_of(is_it="import os; os._exit(5)"),
        source_of(is_it="return 'yes'"),
        "OFFER = 5",
    ],
    ids=["raises at import", "ends at import", "raises", "ends", "no answer", "no format"],
)
def test_a_faulty_reader_leaves_ours_as_they_were(
    source: str, site: Path, reading: LimitedReading, files: tuple[Path, Path]
) -> None:
    write_package(site, "strange", IMPORTERS, {"faulty": source})
    stranger, ours = files
    found = reading.gather([stranger, ours])
    assert [trial.format for trial in found.trials] == ["csv"]
    assert [refusal.where for refusal in found.refused] == ["b.bin"]
    assert reading.read_trial("", [ours], None).format == "csv"
    with pytest.raises(FileRefusedError):
        reading.read_trial("", [stranger], None)


WRONG = {
    "raises": "raise KeyError('x')",
    "nothing": "return None",
    "text": "return ImportedTrial('strange', 'sensors')",
    "no sensor": "return ImportedTrial('strange', ())",
    "integers": "return ImportedTrial('strange', (sensor(values=np.zeros((5, 3), int)),))",
    "number": "return ImportedTrial('strange', (sensor(rate_hz=np.float64(100.0)),))",
    "backwards": "return ImportedTrial('strange', (sensor(time_s=TIME_S[::-1]),))",
    "endless": "return ImportedTrial('strange', (sensor(time_s=np.full(5, np.inf)),))",
    "twins": "return ImportedTrial('strange', (sensor(), sensor()))",
}


@pytest.mark.endurance
@pytest.mark.parametrize("fault", list(WRONG))
def test_an_answer_of_another_shape_refuses_the_file_by_the_packages_name(
    fault: str, site: Path, reading: LimitedReading, files: tuple[Path, Path]
) -> None:
    write_package(site, "strange", IMPORTERS, {"strange": source_of(trial=WRONG[fault])})
    with pytest.raises(
        FileRefusedError, match=r"b\.bin: the importer strange of the package strange 1\.0 stopped with an error"
    ):
        reading.read_trial("", [files[0]], None)


@pytest.mark.endurance
def test_a_reader_keeps_its_own_words_for_a_file_that_it_refuses(
    site: Path, reading: LimitedReading, files: tuple[Path, Path]
) -> None:
    refuses = "raise FileRefusedError(files[0].name, 'it is empty', 'Record again')"
    write_package(site, "strange", IMPORTERS, {"strange": source_of(trial=refuses)})
    with pytest.raises(FileRefusedError, match=r"b\.bin: it is empty\. Record again"):
        reading.read_trial("", [files[0]], None)


@pytest.mark.endurance
def test_the_name_of_a_format_is_its_packages_whatever_it_states(
    site: Path, reading: LimitedReading, files: tuple[Path, Path]
) -> None:
    states_ours = ONE.replace('"strange"', '"csv"')
    write_package(site, "strange", IMPORTERS, {"strange": source_of(trial=states_ours)})
    assert reading.read_trial("", [files[0]], None).format == "strange"


def test_a_name_of_ours_stays_ours_and_each_fault_is_stated(site: Path, reading: LimitedReading) -> None:
    offered = {
        "csv": source_of(is_it="return True"),
        "raises": source_of(first="raise RuntimeError"),
        "ends": source_of(first="import os; os._exit(5)"),
        "kind": "OFFER = 5",
        "parts": "from gaitwright.devices import FileFormat\nOFFER = FileFormat(None, None)",
        "good": source_of(),
    }
    write_package(site, "strange", IMPORTERS, offered)
    assert {offer.name: reading.why_unusable(offer) for offer in offered_formats()} == {
        "csv": "the name csv is already used by gaitwright",
        "raises": "it cannot be loaded (RuntimeError)",
        "ends": "it ended the process that loaded it (crash)",
        "kind": "it is no FileFormat",
        "parts": "not as a FileFormat has it",
        "good": "",
    }


@pytest.mark.endurance
def test_a_format_that_is_asked_for_and_cannot_be_used_is_refused(
    site: Path, reading: LimitedReading, files: tuple[Path, Path]
) -> None:
    write_package(site, "strange", IMPORTERS, {"broken": "OFFER = 5"})
    with pytest.raises(FileRefusedError, match="broken: the package that reads this format cannot be used"):
        reading.read_trial("broken", [files[0]], None)


TRIES = """
    import os, socket
    from pathlib import Path
    done = []
    def attempt(name, act):
        try:
            act()
            done.append(name)
        except OSError:
            pass
    attempt("own", files[0].read_bytes)
    attempt("other", files[0].with_name("a.csv").read_bytes)
    attempt("write", lambda: files[0].write_bytes(b"x"))
    attempt("socket", lambda: socket.socket(socket.AF_INET))
    attempt("program", lambda: os.execv("/bin/true", ["true"]))
    attempt("fork", os.fork)
    return ImportedTrial("strange", (sensor(name=" ".join(done)),))
"""


@pytest.mark.skipif(not IS_LINUX, reason="the limits are Linux's")
def test_a_reader_of_another_package_opens_its_own_file_and_does_nothing_else(
    site: Path, reading: LimitedReading, files: tuple[Path, Path]
) -> None:
    write_package(site, "strange", IMPORTERS, {"strange": source_of(trial=TRIES.strip())})
    assert reading.read_trial("", [files[0]], None).sensors[0].name == "own"
    assert files[0].read_bytes() == b"STRANGE\x00\x01"


def test_what_a_package_changes_in_the_process_is_gone_with_its_answer(
    site: Path, reading: LimitedReading, files: tuple[Path, Path]
) -> None:
    spoils = "import devices.files.formats as f\nf.FORMATS = {}"
    write_package(site, "strange", IMPORTERS, {"strange": source_of(first=spoils)})
    stranger, ours = files
    assert reading.read_trial("", [stranger], None).format == "strange"
    assert reading.read_trial("", [ours], None).format == "csv"


@pytest.mark.endurance
def test_a_reader_without_end_of_memory_is_a_refusal(
    site: Path, reading: LimitedReading, files: tuple[Path, Path]
) -> None:
    write_package(site, "strange", IMPORTERS, {"strange": source_of(trial="np.ones(10**10)")})
    with pytest.raises(ReadingEndedError, match="takes more memory"):
        reading.read_trial("", [files[0]], None)
    assert reading.read_trial("", [files[1]], None).format == "csv"


@pytest.mark.endurance
def test_where_no_copy_of_the_process_is_made_the_next_file_has_a_new_one(
    site: Path, files: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    write_package(site, "strange", IMPORTERS, {"strange": source_of()})
    reader = LimitedReader()
    reading, processes = LimitedReading(reader, lambda: None), []
    for asked, file, is_linux in (
        ("csv", files[1], True),
        ("", files[0], True),
        ("", files[0], False),
        ("csv", files[1], False),
        ("csv", files[1], False),
    ):
        monkeypatch.setattr("devices.files.limited_reader.IS_LINUX", is_linux)
        reading.read_trial(asked, [file], None)
        processes.append(reader.process)
    reader.close()
    first, second, ended, fresh, last = processes
    assert first is second
    assert ended is None
    assert fresh is last
    assert fresh not in (None, first)
