"""Tests that the program that wrote a file is found from the file's content."""

from collections.abc import Callable
from pathlib import Path

import pytest

from devices.files.formats import FORMATS, recognised
from devices.files.refusal import FileRefusedError
from devices.files.trial import PROGRAMS, PROOFS

FindData = Callable[[str], Path]
MT = "// Update Rate: 100.0Hz\nPacketCounter\tAcc_X\tAcc_Y\tAcc_Z\n"
APDM = "Format=7,17,,,Left Thigh\nTime,Accelerometer\n"


def put(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def test_every_export_there_is(test_data: FindData) -> None:
    for folder, name in (("xsens_mtmanager", "xsens-mtmanager"), ("apdm", "apdm")):
        texts = sorted(test_data(f"vendor_exports/{folder}").glob("*.[ct][sx][vt]"))
        files = [path for path in texts if not path.name.startswith("LICENSE")]
        assert files
        assert {recognised([path]) for path in files} == {name}


def test_every_format_states_what_writes_it_and_what_it_was_held_against() -> None:
    assert set(PROGRAMS) == set(FORMATS)
    assert set(PROOFS) == set(FORMATS)
    assert all(proof.endswith(".") for proof in PROOFS.values())


def test_the_name_of_a_file_states_nothing(tmp_path: Path) -> None:
    assert recognised([put(tmp_path / "apdm.csv", MT)]) == "xsens-mtmanager"
    assert recognised([put(tmp_path / "PacketCounter.txt", APDM)]) == "apdm"


def test_movella_dot_is_reported_from_mt_manager_by_more_than_its_columns(tmp_path: Path) -> None:
    columns = "PacketCounter,SampleTimeFine,Acc_X,Acc_Y,Acc_Z,Gyr_X,Gyr_Y,Gyr_Z\n"
    assert recognised([put(tmp_path / "a.csv", f"sep=,\nDeviceTag:,D4\n\n{columns}")]) == "movella-dot"
    assert recognised([put(tmp_path / "b.csv", "SampleTimeFine,Euler_X,FreeAcc_X\n1,2,3\n")]) == "movella-dot"
    assert recognised([put(tmp_path / "c.csv", f"// Update Rate: 100.0Hz\n{columns}")]) == "xsens-mtmanager"


def test_what_is_not_known_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        FileRefusedError, match=r"a.csv: the file format is not recognised, and the file is no table of numbers"
    ):
        recognised([put(tmp_path / "a.csv", "time,left,right\n")])
    bare = "PacketCounter,SampleTimeFine,Acc_X,Acc_Y,Acc_Z,Gyr_X,Gyr_Y,Gyr_Z\n1,16667,0,0,9.8,0,0,0\n"
    with pytest.raises(
        FileRefusedError, match="the file format is not recognised"
    ):  # of MT Manager in rad/s, or of Movella DOT in deg/s
        recognised([put(tmp_path / "bare.csv", bare)])
    with pytest.raises(FileRefusedError, match="the file format is not recognised"):
        recognised([put(tmp_path / "b.csv", "")])
    with pytest.raises(FileRefusedError, match=r"b.txt: this file comes from apdm, but a.txt from xsens-mtmanager"):
        recognised([put(tmp_path / "a.txt", MT), put(tmp_path / "b.txt", APDM)])
    with pytest.raises(FileRefusedError, match="this file does not exist"):
        recognised([tmp_path / "none.csv"])
