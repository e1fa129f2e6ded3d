"""Tests that files that belong together come together and that nothing is lost on the way."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from devices.files import gathering
from devices.files.gathering import gather
from devices.files.limited_reader import LimitedReading
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


def refuse_to_open(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As the system does of what belongs to somebody else; whoever is root may read everything."""

    def refusing(of: str) -> Callable[..., Any]:
        open_it = getattr(Path, of)

        def attempt(path: Path, *args: Any, **kwargs: Any) -> Any:
            if path.name == name:
                raise PermissionError(13, "Permission denied", str(path))
            return open_it(path, *args, **kwargs)

        return attempt

    for of in ("open", "iterdir"):
        monkeypatch.setattr(Path, of, refusing(of))


@pytest.mark.parametrize("name", ["b.csv", "more"])
def test_what_cannot_be_read_is_refused_and_the_others_stay(
    name: str, mixed: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paths = sorted(mixed.iterdir())
    every = gather(paths)
    refuse_to_open(name, monkeypatch)
    found = gather(paths)
    is_lost = {"b.csv": "b", "more": "d"}[name]
    assert found.trials == tuple(one for one in every.trials if one.name != is_lost)
    assert {str(one) for one in found.refused} - {str(one) for one in every.refused} == {
        f"{name}: the file or folder cannot be read (Permission denied). Check the permissions."
    }


def test_what_is_damaged_is_refused_and_the_others_stay(mixed: Path) -> None:
    (mixed / "b2.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    found = gather(sorted(mixed.iterdir()))
    assert len(found.trials) == 7
    assert "b2.h5: the file cannot be read as HDF5" in "\n".join(map(str, found.refused))


@pytest.mark.skipif(sys.platform != "linux", reason="the limits of Linux")
def test_a_link_to_what_nobody_chose_is_refused_by_the_reading_process(
    mixed: Path, shared_reading: LimitedReading
) -> None:
    secret = mixed.parent / f"{mixed.name}-beside.csv"
    secret.write_text(APDM)
    folder = mixed / "more"
    (folder / "e.csv").symlink_to(secret)
    found = shared_reading.gather([folder])
    assert [one.name for one in found.trials if one.name != "e"] == ["d"]
    if "e" not in [one.name for one in found.trials]:  # without Landlock it is read
        assert [one.where for one in found.refused] == ["e.csv"]


def test_the_files_of_one_trial_are_those_of_its_name(test_data: FindData) -> None:
    found = gather([test_data("vendor_exports/xsens_mtmanager")])
    walk = next(one for one in found.trials if one.name.startswith("OpenSenseExample"))
    assert len(walk.files) == 9  # eight sensors and the mapping that names them
    assert len(next(one for one in found.trials if one.name.startswith("MT46")).files) == 2


@pytest.mark.endurance
def test_it_comes_back_the_same_from_the_limited_process(mixed: Path, shared_reading: LimitedReading) -> None:
    found = shared_reading.gather([mixed])
    here = gather([mixed])
    assert found.trials == here.trials
    assert list(map(str, found.refused)) == list(map(str, here.refused))
