"""Tests that files that belong together come together and that nothing is lost on the way."""

from collections.abc import Callable
from pathlib import Path

import pytest

from devices.files import gathering
from devices.files.gathering import gather
from devices.files.limited_reader import LimitedReader, LimitedReading
from devices.files.refusal import FileRefusedError
from devices.files.trial import SESSION

FindData = Callable[[str], Path]
MT = "// Update Rate: 100.0Hz\nPacketCounter\tAcc_X\tAcc_Y\tAcc_Z\n"
APDM = "Format=7,17,,,Left Thigh\nTime,Accelerometer\n"


@pytest.fixture
def mixed(tmp_path: Path) -> Path:
    """Twenty files and folders of what somebody drags at once."""
    for walk in (1, 2):
        for number in range(6):
            (tmp_path / f"walk-{walk:03d}_00B4000{number}.txt").write_text(MT)
    for trial in ("a", "b", "c"):
        (tmp_path / f"{trial}.csv").write_text(APDM)
    for name, text in (("readme.md", "# ours\n"), ("picture.png", "\x89PNG"), ("empty.csv", "")):
        (tmp_path / name).write_text(text)
    (tmp_path / "visit").mkdir()
    (tmp_path / "visit" / "session.toml").write_text("")
    (tmp_path / "more").mkdir()
    (tmp_path / "more" / "d.csv").write_text(APDM)
    return tmp_path


def test_twenty_mixed_files_come_together(mixed: Path) -> None:
    paths = sorted(mixed.iterdir())
    assert len(paths) == 20
    found = gather(paths)
    assert [(one.format, one.name, len(one.files)) for one in found.trials] == [
        ("apdm", "a", 1),
        ("apdm", "b", 1),
        ("apdm", "c", 1),
        ("apdm", "d", 1),
        (SESSION, "visit", 1),
        ("xsens-mtmanager", "walk_001", 6),
        ("xsens-mtmanager", "walk_002", 6),
    ]
    assert [str(refusal).partition(":")[0] for refusal in found.refused] == ["empty.csv", "picture.png", "readme.md"]
    assert {str(path) for one in found.trials for path in map(Path, one.files)} | {
        str(mixed / refusal.where) for refusal in found.refused
    } == {str(path) for path in (*paths, mixed / "more" / "d.csv")} - {str(mixed / "more")}


def test_a_folder_is_for_what_is_in_it(mixed: Path) -> None:
    assert len(gather([mixed]).trials) == 6  # a folder in a folder is one too many
    many = mixed / "many"
    many.mkdir()
    for number in range(gathering.MOST_FILES + 1):
        (many / f"{number}.txt").touch()
    with pytest.raises(FileRefusedError, match=r"more than 500 files. Choose the files of a few sessions"):
        gather([many])


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        FileRefusedError, match=r"the folder contains neither session\.toml nor a file that can be imported"
    ):
        gather([tmp_path])


def test_the_files_of_one_trial_are_those_of_its_name(test_data: FindData) -> None:
    found = gather([test_data("vendor_exports/xsens_mtmanager")])
    walk = next(one for one in found.trials if one.name.startswith("OpenSenseExample"))
    assert len(walk.files) == 9  # eight sensors and the mapping that names them
    assert len(next(one for one in found.trials if one.name.startswith("MT46")).files) == 2


@pytest.mark.endurance
def test_it_comes_back_the_same_from_the_limited_process(mixed: Path) -> None:
    reader = LimitedReader()
    try:
        found = LimitedReading(reader, lambda: None).gather([mixed])
    finally:
        reader.close()
    here = gather([mixed])
    assert found.trials == here.trials
    assert list(map(str, found.refused)) == list(map(str, here.refused))
