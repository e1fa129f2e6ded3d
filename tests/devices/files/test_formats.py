"""Tests that the program that wrote a file is found from the file's content."""

from collections.abc import Callable
from pathlib import Path

from syrupy.assertion import SnapshotAssertion

from devices.files.formats import FORMATS, recognised
from devices.files.trial import PROGRAMS, PROOFS
from tests.trials_of_files import refused

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


def test_what_is_not_known_is_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    def of(*texts: str) -> str:
        return refused(recognised, [put(tmp_path / f"{number}.csv", text) for number, text in enumerate(texts)])

    bare = "PacketCounter,SampleTimeFine,Acc_X,Acc_Y,Acc_Z,Gyr_X,Gyr_Y,Gyr_Z\n1,16667,0,0,9.8,0,0,0\n"
    assert {
        "other columns": of("time,left,right\n"),
        "of MT Manager in rad/s, or of Movella DOT in deg/s": of(bare),
        "nothing": of(""),
        "of two programs": of(MT, APDM),
    } == snapshot
    assert "this file does not exist" in refused(recognised, [tmp_path / "none.csv"])
