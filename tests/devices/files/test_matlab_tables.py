"""Tests that MATLAB files become samples. What only MATLAB can open is refused, with what to do there.

The layout of version 7.3 and of an object are written here by hand; files that MATLAB itself wrote come with SciPy.
"""

import math
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
from numpy.typing import NDArray
from scipy.io import savemat
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from devices.files import hdf5
from devices.files.formats import recognised
from devices.files.matlab_tables import matlab_trial
from devices.files.matlab_variables import ClosedObject, read_matlab
from tests.trials_of_files import import_with, refused

ROWS = 300
TIME_S = np.arange(ROWS) / 100.0
ACC = np.random.default_rng(1).normal(size=(ROWS, 3)) + np.array([0.0, 9.81, 0.0])
GYR = np.random.default_rng(2).normal(size=(ROWS, 3))
OF_MATLAB = Path(scipy.io.__file__).parent / "matlab" / "tests" / "data"
Numbers = NDArray[np.float64]


def sensor(offset: float = 0.0) -> dict[str, Any]:
    return {"acc_m_s2": ACC + offset, "gyr_rad_s": GYR}


def written(path: Path, variables: Mapping[str, Any], *, packed: bool = False) -> Path:
    savemat(path, variables, appendmat=False, do_compression=packed, long_field_names=True)
    return path


def put_7_3(holder: Any, name: str, value: Any, references: Any) -> None:
    """One variable as MATLAB lays it out in HDF5: axes reversed, texts as numbers, cells as references."""
    if isinstance(value, dict):
        group = holder.create_group(name)
        group.attrs["MATLAB_class"] = np.bytes_("struct")
        for inner, one in value.items():
            put_7_3(group, inner, one, references)
    elif isinstance(value, str):
        dataset = holder.create_dataset(name, data=np.array([[ord(letter)] for letter in value], dtype=np.uint16))
        dataset.attrs["MATLAB_class"] = np.bytes_("char")
        dataset.attrs["MATLAB_int_decode"] = 2
    elif isinstance(value, list):
        is_array = isinstance(value[0], dict)
        for column in value[0] if is_array else [name]:
            places = []
            for one in value:
                place = f"r{len(references)}"
                put_7_3(references, place, one[column] if is_array else one, references)
                places.append(references[place].ref)
            target = holder.require_group(name) if is_array else holder
            dataset = target.create_dataset(column, data=np.array([places], dtype=h5py.ref_dtype).T)
            if not is_array:
                dataset.attrs["MATLAB_class"] = np.bytes_("cell")
    else:
        dataset = holder.create_dataset(name, data=np.atleast_2d(np.asarray(value, dtype=float).T))
        dataset.attrs["MATLAB_class"] = np.bytes_("double")


def written_7_3(path: Path, variables: Mapping[str, Any]) -> Path:
    with h5py.File(path, "w", userblock_size=512) as file:
        references = file.create_group("#refs#")
        for name, value in variables.items():
            put_7_3(file, name, value, references)
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return path


def table_object(name: str = "T") -> bytes:
    """A variable of the class "table", as the elements of version 5 that hold such objects."""

    def element(kind: int, content: bytes) -> bytes:
        return struct.pack("<II", kind, len(content)) + content.ljust(-(-len(content) // 8) * 8, b"\0")

    numbers = element(6, struct.pack("<II", 13, 0)) + element(5, struct.pack("<ii", 6, 1)) + element(1, b"")
    numbers += element(6, struct.pack("<6I", 0xDD000000, 2, 1, 1, 1, 1))
    texts = b"".join(element(1, text) for text in (name.encode(), b"MCOS", b"table"))
    return element(14, element(6, struct.pack("<II", 17, 0)) + texts + element(14, numbers))


def left_shank(path: Path, name: str, rate_hz: float | None = None) -> Any:
    return import_with(matlab_trial, [path], {Site.LEFT_SHANK: name}, "walk 1", rate_hz)


@pytest.mark.parametrize("write", [written, written_7_3])
def test_structures_are_sensors_and_what_is_around_them_counts_for_all(tmp_path: Path, write: Any) -> None:
    trial = {"time": TIME_S[:, None], "units": {"time": "s"}, "left_shank": sensor(), "right_shank": sensor(0.1)}
    path = write(tmp_path / "a.txt", {"trial": trial, "comment": "a walk"})
    assert recognised([path]) == "matlab"
    placement = {Site.LEFT_SHANK: "left_shank", Site.RIGHT_SHANK: "Right Shank".replace(" ", "_")}
    imported = import_with(matlab_trial, [path], placement, "walk 1")
    np.testing.assert_allclose(imported.imu[Site.LEFT_SHANK].acc_m_s2, ACC)
    np.testing.assert_allclose(imported.imu[Site.RIGHT_SHANK].acc_m_s2, ACC + 0.1)
    np.testing.assert_allclose(imported.imu[Site.RIGHT_SHANK].gyr_rad_s, GYR)
    np.testing.assert_allclose(imported.imu[Site.LEFT_SHANK].time_s, TIME_S)
    assert imported.sensors[Site.LEFT_SHANK].rate_hz == 100.0
    assert imported.sensors[Site.LEFT_SHANK].rate_kind is None  # which no name reports
    understood = next(one.numbers for one in imported.findings if one.key == "columns_understood")
    assert understood["acc"] == "acc_m_s2_x, acc_m_s2_y, acc_m_s2_z"
    assert understood["time"] == "time [s]"


@pytest.mark.parametrize("write", [written, written_7_3])
def test_an_array_of_structures_is_called_by_its_names(tmp_path: Path, write: Any) -> None:
    sensors = [{"name": name, **sensor(0.1 * k)} for k, name in enumerate(("left shank", "right shank"))]
    value: Any = sensors
    if write is written:
        value = np.array([tuple(one.values()) for one in sensors], dtype=[(name, "O") for name in sensors[0]])
    path = write(tmp_path / "a.mat", {"fs": 50.0, "s": value})
    found = matlab_trial([path])
    assert [one.name for one in found.sensors] == ["left shank", "right shank"]
    np.testing.assert_allclose(found.sensors[1].block.acc_m_s2, ACC + 0.1)
    assert found.sensors[0].block.time_s[-1] == pytest.approx((ROWS - 1) / 50.0)
    assert "time_from_rate" in [one.key for one in found.sensors[0].findings]


@pytest.mark.parametrize("write", [written, written_7_3])
def test_a_matrix_whose_columns_a_cell_names(tmp_path: Path, write: Any) -> None:
    names = ["time", *(f"acc_{axis}" for axis in "xyz"), *(f"gyr_{axis}" for axis in "xyz")]
    units = ["ms", *["g"] * 3, *["deg/s"] * 3]
    matrix = np.column_stack([TIME_S * 1e3, ACC / 9.80665, np.rad2deg(GYR)])
    cells: list[Any] = [names, units]
    if write is written:
        cells = [np.array(one, dtype=object) for one in cells]
    path = write(tmp_path / "walk.mat", {"data": matrix, "colheaders": cells[0], "unit_of": cells[1]})
    imported = left_shank(path, "walk")
    np.testing.assert_allclose(imported.imu[Site.LEFT_SHANK].acc_m_s2, ACC)
    np.testing.assert_allclose(imported.imu[Site.LEFT_SHANK].gyr_rad_s, GYR)
    np.testing.assert_allclose(imported.imu[Site.LEFT_SHANK].time_s, TIME_S, atol=1e-9)
    assert "unit_by_size" not in [one.key for one in imported.findings]


def test_vectors_rows_and_axes_in_structures_are_the_same_samples(tmp_path: Path) -> None:
    vectors = {f"{name}_{axis}": values[:, k] for name, values in sensor().items() for k, axis in enumerate("xyz")}
    rows = {name: values.T for name, values in sensor().items()}
    inner = {name: {axis: values[:, k] for k, axis in enumerate("xyz")} for name, values in sensor().items()}
    for variables in (vectors, rows, inner):
        path = written(tmp_path / "a.mat", {"time_s": TIME_S, **variables}, packed=True)
        np.testing.assert_allclose(left_shank(path, "a").imu[Site.LEFT_SHANK].acc_m_s2, ACC)
        np.testing.assert_allclose(left_shank(path, "a").imu[Site.LEFT_SHANK].gyr_rad_s, GYR)


def test_two_walks_in_one_file_stay_apart(tmp_path: Path) -> None:
    walks = {f"walk{k}": {"time_s": TIME_S, "left": sensor(k), "right": sensor(k)} for k in (0.0, 0.5)}
    path = written(tmp_path / "a.mat", {name.replace(".", "_"): walk for name, walk in walks.items()})
    assert [one.name for one in matlab_trial([path]).sensors] == [
        f"{walk}_{side}" for walk in ("walk0_0", "walk0_5") for side in ("left", "right")
    ]


def test_units_are_held_to_their_size_and_other_files_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    def refusal(variables: Mapping[str, Any]) -> str:
        return refused(matlab_trial, [written(tmp_path / "a.mat", variables)])

    back = TIME_S - 0.5 * (np.arange(ROWS) >= 50)
    other = written(tmp_path / "b.mat", {"speed": np.arange(4.0), "picture": np.eye(4)})
    assert recognised([other]) == "matlab"
    assert {
        "called m/s2, and g": refusal({"time_s": TIME_S, "acc": ACC / 9.8, "acc_unit": "m/s^2", "gyr": GYR}),
        "no units": refusal({"time_s": TIME_S, "acc": ACC, "gyr": GYR}),
        "no times": refusal(sensor()),
        "times that go back": refusal({"time_s": back, **sensor()}),
        "other variables": refused(matlab_trial, [other]),
    } == snapshot
    other.write_bytes(other.read_bytes()[:-40])
    assert "b.mat: the file cannot be read as a MATLAB file" in refused(matlab_trial, [other])
    version_4 = refused(matlab_trial, [OF_MATLAB / "testdouble_4.2c_SOL2.mat"])
    assert "the file is not a MATLAB file of version 5 or later. Save the file again in MATLAB" in version_4


def test_an_orientation_whose_order_nothing_reports_is_left_out(tmp_path: Path) -> None:
    quat = {"time_s": TIME_S, **sensor(), "quat": np.tile((1.0, 0.0, 0.0, 0.0), (ROWS, 1))}
    (found,) = matlab_trial([written(tmp_path / "b.mat", quat)]).sensors
    assert found.block.q_earth_from_sensor is None
    assert [one.numbers for one in found.findings if one.key == "columns_left_out"] == [{"names": "quat"}]


def test_a_table_is_refused_with_what_to_do_in_matlab(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    path = written(tmp_path / "a.mat", {"fs": 100.0})
    path.write_bytes(path.read_bytes() + table_object())
    assert ClosedObject("table") in read_matlab(path).values()
    new = written_7_3(tmp_path / "b.mat", {"fs": 100.0, "T": np.zeros((1, 6))})
    with h5py.File(new, "r+") as file:
        file["T"].attrs["MATLAB_class"] = np.bytes_("timetable")
        file["T"].attrs["MATLAB_object_decode"] = 3
    assert [refused(matlab_trial, [one]) for one in (path, new)] == snapshot


def test_types_that_there_are_not_are_refused_before_scipy_reads_them(tmp_path: Path) -> None:
    """SciPy 1.17 ends the process for some of these."""
    path = written(tmp_path / "a.mat", {"time_s": TIME_S, **sensor()})
    content = path.read_bytes()
    of_numbers = content.index(struct.pack("<II", 9, 8 * ROWS))  # 9 are numbers of eight bytes
    kinds = [(of_numbers, struct.pack("<I", kind)) for kind in (0, 8, 10, 14, 41, 32777)]
    for at, changed in [*kinds, *((128 + 16, bytes([of_class])) for of_class in (0, 18, 255))]:
        path.write_bytes(content[:at] + changed + content[at + len(changed) :])
        assert "the file cannot be read as a MATLAB file and may be damaged" in refused(matlab_trial, [path])


def test_references_in_a_circle_end(tmp_path: Path) -> None:
    path = written_7_3(tmp_path / "a.mat", {"s": [np.ones(3), np.ones(3)]})
    with h5py.File(path, "r+") as file:
        file["s"][...] = np.array([[file["s"].ref, file["s"].ref]], dtype=h5py.ref_dtype).T
    assert "the data in the file are nested too deeply or are too large for a recording" in refused(
        matlab_trial, [path]
    )


def test_without_the_library_of_hdf5_only_version_7_3_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    new = written_7_3(tmp_path / "a.mat", {"time_s": TIME_S, **sensor()})
    old = written(tmp_path / "b.mat", {"time_s": TIME_S, **sensor()})
    monkeypatch.setattr(hdf5, "find_spec", lambda _: None)
    assert matlab_trial([old]).sensors
    assert "which is not installed. Install gaitwright[imports]" in refused(matlab_trial, [new])


@pytest.mark.skipif(not OF_MATLAB.is_dir(), reason="SciPy was installed without its tests")
def test_files_that_matlab_wrote() -> None:
    """Their values are those that SciPy's own tests expect of them."""
    ramp = np.linspace(0.0, 2.0 * np.pi, 9)
    for version in ("testdouble_6.1_SOL2", "testdouble_7.1_GLNX86", "testhdf5_7.4_GLNX86"):
        read = read_matlab(OF_MATLAB / f"{version}.mat")
        np.testing.assert_allclose(np.ravel(np.asarray(read["testdouble"], dtype=float)), ramp, atol=1e-12)
        assert recognised([OF_MATLAB / f"{version}.mat"]) == "matlab"
    structure: Any = read_matlab(OF_MATLAB / "teststruct_7.4_GLNX86.mat")["teststruct"]
    assert structure["stringfield"].startswith("Rats live on no evil star")
    assert structure["doublefield"][0, 1] == pytest.approx(math.e)
    assert structure["complexfield"] is None
    array: Any = read_matlab(OF_MATLAB / "teststructarr_7.4_GLNX86.mat")["teststructarr"]
    assert [sorted(one) for one in array] == [["one", "two"]] * 2
    assert array[1]["two"] == "number 2"
    assert read_matlab(OF_MATLAB / "teststringarray_7.4_GLNX86.mat")["teststringarray"] == ["one", "two", "three"]
    nested: Any = read_matlab(OF_MATLAB / "testcellnest_7.4_GLNX86.mat")["testcellnest"]
    assert float(nested[1][2][0][0, 0]) == 4.0
    for other in ("miuint32_for_miint32", "miutf8_array_name", "testfunc_7.4_GLNX86", "testobject_7.4_GLNX86"):
        assert read_matlab(OF_MATLAB / f"{other}.mat")
    for path in sorted(OF_MATLAB.glob("*.mat")):  # some of them damaged on purpose
        refused(matlab_trial, [path])
