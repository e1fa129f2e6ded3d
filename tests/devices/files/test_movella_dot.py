"""Tests that files of Movella DOT sensors become samples in SI units. What would be read wrongly is refused."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from scipy.spatial.transform import Rotation
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from core.samples import FloatArray, ImuBlock, RateKind
from devices.files import spreadsheets
from devices.files.formats import recognised
from devices.files.gathering import gather
from devices.files.movella_dot import movella_dot_trial
from devices.files.trial import ImportedTrial
from tests.trials_of_files import import_with, refused

HZ, STEP = 60.0, 16667  # of its app: microseconds
AXIS = np.array([0.6, 0.0, 0.8])  # about which the sensor swings, in its own axes
TILT = Rotation.from_euler("x", 70, degrees=True)
UP = np.array([0.0, 0.0, 9.8127])
HEADS = {"DeviceTag": "left thigh", "FirmwareVersion": "2.0.0", "SyncStatus": "Synced", "OutputRate": "60Hz"}


def swing(rows: int = 240, hz: float = HZ) -> dict[str, FloatArray]:
    """Columns of a sensor that swings by 40 degrees at 0.9 Hz; it turns about one axis, so its rate is known."""
    t = np.arange(rows) / hz
    angle, rate = 0.7 * np.sin(5.65 * t), 0.7 * 5.65 * np.cos(5.65 * t)
    turn = TILT * Rotation.from_rotvec(angle[:, None] * AXIS)
    moved = np.column_stack([np.sin(7 * t), 0.5 * np.cos(3 * t), 0.3 * np.sin(5 * t)])  # in earth axes
    before = Rotation.from_rotvec((0.7 * np.sin(5.65 * (t - 1 / hz)))[:, None] * AXIS)
    step = before.inv() * Rotation.from_rotvec(angle[:, None] * AXIS)
    acc = turn.inv().apply(moved + UP)
    columns: dict[str, FloatArray] = {}
    for names, values in (
        ("Quat_W Quat_X Quat_Y Quat_Z", turn.as_quat(scalar_first=True)),
        ("Euler_X Euler_Y Euler_Z", turn.as_euler("ZYX", degrees=True)[:, ::-1]),
        ("FreeAcc_X FreeAcc_Y FreeAcc_Z", moved),
        ("Acc_X Acc_Y Acc_Z", acc),
        ("Gyr_X Gyr_Y Gyr_Z", np.degrees(rate[:, None] * AXIS)),
        ("Mag_X Mag_Y Mag_Z", np.tile([0.1, 0.2, 0.3], (rows, 1))),
        ("dq_W dq_X dq_Y dq_Z", step.as_quat(scalar_first=True)),
        ("dv[1] dv[2] dv[3]", acc / hz),
    ):
        columns |= dict(zip(names.split(), values.T, strict=True))
    return columns


def dot(
    path: Path,
    *parts: str,
    heads: dict[str, str] | None = None,
    ticks: Sequence[int] | None = None,
    columns: dict[str, FloatArray] | None = None,
    keep: slice = slice(None),
) -> Path:
    """A file as the app writes it, with the columns whose names begin with one of `parts`."""
    columns = swing() if columns is None else columns
    chosen = [name for part in parts for name in columns if name.startswith(part)]
    rows = len(next(iter(columns.values())))
    ticks = [3343444552 + STEP * k for k in range(rows)] if ticks is None else ticks
    lines = ["sep=,", *(f"{name}:,{value}" for name, value in (HEADS if heads is None else heads).items())]
    lines += ["© Movella Technologies B. V. 2005-2023", "", ",".join(["PacketCounter", "SampleTimeFine", *chosen])]
    body = [",".join([str(k + 1), str(ticks[k]), *(f"{columns[name][k]:.6f}" for name in chosen)]) for k in range(rows)]
    path.write_text("\n".join([*lines, *body[keep], ""]), encoding="utf-8")
    return path


def as_workbook(text: Path, path: Path) -> openpyxl.Workbook:
    """The same cells as a spreadsheet."""
    book = openpyxl.Workbook()
    assert book.active is not None
    for line in text.read_text(encoding="utf-8").splitlines():
        cells = line.split(",")
        book.active.append([float(cell) if cell.replace(".", "", 1).lstrip("-").isdigit() else cell for cell in cells])
    book.save(path)
    return book


def block_of(path: Path, rate_hz: float | None = None) -> ImuBlock:
    return import_with(movella_dot_trial, [path], {Site.LEFT_THIGH: path.name}, "walk 1", rate_hz).imu[Site.LEFT_THIGH]


def keys(trial: ImportedTrial) -> list[list[str]]:
    return [[finding.key for finding in sensor.findings] for sensor in trial.sensors]


def refusal(path: Path, rate_hz: float | None = None) -> str:
    return refused(movella_dot_trial, [path], rate_hz)


def truth() -> tuple[FloatArray, FloatArray]:
    """(n, 3) rad/s and m/s2 of the swing."""
    columns = swing()
    gyr = np.radians(np.column_stack([columns[f"Gyr_{axis}"] for axis in "XYZ"]))
    return gyr, np.column_stack([columns[f"Acc_{axis}"] for axis in "XYZ"])


def test_samples_are_those_of_the_file_in_si_units(tmp_path: Path) -> None:
    path = dot(tmp_path / "thigh_D422CD004D68_20230101_101112.csv", "Quat", "Acc", "Gyr", "Mag")
    (sensor,) = movella_dot_trial([path]).sensors
    gyr, acc = truth()
    np.testing.assert_allclose(sensor.block.gyr_rad_s, gyr, atol=1e-6)
    np.testing.assert_allclose(sensor.block.acc_m_s2, acc, atol=1e-6)
    np.testing.assert_allclose(sensor.block.time_s, np.arange(240) * 0.016667, atol=1e-9)
    assert sensor.block.mag is not None
    assert sensor.block.mag[0].tolist() == [0.1, 0.2, 0.3]
    assert not sensor.block.is_rate_derived
    assert (sensor.info.serial, sensor.info.firmware, sensor.info.rate_hz) == ("D422CD004D68", "2.0.0", 60.0)
    assert sensor.info.rate_kind is RateKind.INSTANTANEOUS  # as the orientation beside them reports
    assert sensor.ids == ("D422CD004D68", "left thigh")
    assert sensor.findings == ()


@pytest.mark.parametrize("orientation", ["Quat", "Euler"])
def test_free_acceleration_gets_its_gravity_and_rates_come_from_the_orientation(
    tmp_path: Path, orientation: str
) -> None:
    trial = movella_dot_trial([dot(tmp_path / "a.csv", orientation, "FreeAcc")])
    block = trial.sensors[0].block
    gyr, acc = truth()
    np.testing.assert_allclose(block.acc_m_s2, acc, atol=1e-4)
    np.testing.assert_allclose(block.gyr_rad_s[2:-2], gyr[2:-2], atol=0.02)
    assert block.is_rate_derived
    assert keys(trial) == [["rate_from_orientation", "gravity_from_orientation"]]


def test_delta_quantities_are_means_over_the_interval_before(tmp_path: Path) -> None:
    (sensor,) = movella_dot_trial([dot(tmp_path / "a.csv", "dq_", "dv[")]).sensors
    gyr, acc = truth()
    np.testing.assert_allclose(sensor.block.gyr_rad_s[1:], (gyr[1:] + gyr[:-1]) / 2, atol=0.01)
    np.testing.assert_allclose(sensor.block.acc_m_s2, acc, atol=1e-4)
    assert sensor.info.rate_kind is RateKind.AVERAGED


def test_the_columns_of_the_sdk_count_tenths_of_a_millisecond(tmp_path: Path) -> None:
    columns = swing(rows=60)
    names = [name for part in ("Euler", "FreeAcc") for name in columns if name.startswith(part)]
    lines = [",".join(["SampleTimeFine", *names])]
    for k in range(60):
        lines.append(",".join([str(2089876 + round(k * 1e4 / HZ)), *(f"{columns[name][k]:.4f}" for name in names)]))
    path = tmp_path / "logfile_D4-22-CD-00-4D-68.csv"
    path.write_text("\n".join(lines))
    assert recognised([path]) == "movella-dot"
    (sensor,) = movella_dot_trial([path]).sensors
    assert (sensor.info.serial, sensor.info.rate_hz) == ("D422CD004D68", 60.0)
    np.testing.assert_allclose(sensor.block.time_s, np.arange(60) / HZ, atol=1e-4)


def test_an_excel_file_holds_the_same(tmp_path: Path) -> None:
    text = dot(tmp_path / "a.csv", "Quat", "Acc", "Gyr")
    book = as_workbook(text, tmp_path / "a.xlsx")
    assert recognised([tmp_path / "a.xlsx"]) == "movella-dot"
    one, other = block_of(text), block_of(tmp_path / "a.xlsx")
    np.testing.assert_array_equal(one.gyr_rad_s, other.gyr_rad_s)
    np.testing.assert_array_equal(one.time_s, other.time_s)
    assert book.active is not None
    book.active.cell(20, 5).value = "moved"
    book.save(tmp_path / "b.xlsx")
    assert 'b.xlsx, row 20: "moved" is not a number' in refusal(tmp_path / "b.xlsx")


def test_an_excel_file_without_the_library_states_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    book = openpyxl.Workbook()
    assert book.active is not None
    book.active.append(["SampleTimeFine"])
    book.save(tmp_path / "a.xlsx")
    monkeypatch.setattr(spreadsheets, "find_spec", lambda name: None)
    assert "openpyxl, which is not installed. Install gaitwright[imports]" in refusal(tmp_path / "a.xlsx")


def test_lost_samples_are_gaps_and_a_turn_of_the_clock_is_none(tmp_path: Path) -> None:
    ticks = [(2**32 - 50 * STEP + STEP * k) % 2**32 for k in range(240)]
    whole = block_of(dot(tmp_path / "a.csv", "Quat", "FreeAcc", ticks=ticks))
    np.testing.assert_allclose(np.diff(whole.time_s), 0.016667, atol=1e-9)
    odd = block_of(dot(tmp_path / "b.csv", "Quat", "FreeAcc", keep=slice(0, None, 3)))
    np.testing.assert_allclose(np.diff(odd.time_s), 3 * 0.016667, atol=1e-9)
    assert np.isnan(odd.gyr_rad_s).all()  # no two that follow each other: nothing to derive a rate of


def test_a_repeated_time_is_reported(tmp_path: Path) -> None:
    ticks = [STEP * k for k in range(240)]
    ticks[100] = ticks[99]
    trial = movella_dot_trial([dot(tmp_path / "a.csv", "Acc", "Gyr", ticks=ticks)])
    assert (keys(trial), len(trial.sensors[0].block)) == ([["doubled_stamps"]], 239)


def test_synchronised_sensors_share_a_clock(tmp_path: Path) -> None:
    files = [
        dot(tmp_path / f"{name}.csv", "Acc", "Gyr", ticks=[(start + STEP * k) % 2**32 for k in range(240)])
        for name, start in (("one", 2**32 - 3 * STEP), ("two", 2**32 - STEP), ("three", 4 * STEP))
    ]
    trial = movella_dot_trial(files)
    starts = [float(sensor.block.time_s[0]) * 1e6 / STEP for sensor in trial.sensors]
    np.testing.assert_allclose(starts[:2], [0.0, 2.0], atol=1e-6)
    assert starts[2] == pytest.approx(7.0)  # its clock has turned meanwhile
    assert keys(trial) == [[], [], []]


def test_one_grid_of_stamps_proves_a_shared_clock_where_the_file_states_nothing(tmp_path: Path) -> None:
    nothing = {"DeviceTag": "a", "OutputRate": "60Hz"}
    started = (3343444552, 3343444552 + 7 * STEP, 3343444552 + 7 * STEP + 5000)
    files = [
        dot(tmp_path / f"{k}.csv", "Acc", "Gyr", heads=nothing, ticks=[start + STEP * i for i in range(240)])
        for k, start in enumerate(started)
    ]
    together = movella_dot_trial(files[:2])
    assert {sensor.info.clock for sensor in together.sensors} == {"Movella DOT"}
    assert together.sensors[1].block.time_s[0] == pytest.approx(7 * 0.016667)
    apart = movella_dot_trial(files[1:])
    assert keys(apart) == [["not_synchronised"]] * 2
    assert [float(sensor.block.time_s[0]) for sensor in apart.sensors] == [0.0, 0.0]


def test_sensors_that_were_not_synchronised_are_reported(tmp_path: Path) -> None:
    files = [
        dot(tmp_path / f"{k}_D422CD004D6{k}_x.csv", "Acc", "Gyr", heads=HEADS | {"SyncStatus": "Un-synced"})
        for k in range(2)
    ]
    trial = movella_dot_trial(files)
    assert keys(trial) == [["not_synchronised"], ["not_synchronised"]]
    assert [sensor.info.clock for sensor in trial.sensors] == ["D422CD004D60", "D422CD004D61"]
    assert keys(movella_dot_trial(files[:1])) == [[]]  # alone it needs no other's clock


def test_the_row_of_zeros_that_an_export_begins_with_is_no_measurement(tmp_path: Path) -> None:
    columns = swing()
    for name in columns:
        if name.startswith(("Acc", "Gyr")):
            columns[name][0] = 0.0
    block = block_of(dot(tmp_path / "a.csv", "Euler", "Acc", "Gyr", columns=columns))
    assert np.isnan(block.acc_m_s2[0]).all()
    assert np.isfinite(block.acc_m_s2[1:]).all()


@pytest.mark.parametrize("rows", [0, 1, 2])
def test_hardly_any_samples_are_a_short_recording(tmp_path: Path, rows: int) -> None:
    files = [dot(tmp_path / f"{name}.csv", "Quat", "Acc", "Gyr", keep=slice(rows)) for name in ("a", "b")]
    assert [len(sensor.block) for sensor in movella_dot_trial(files).sensors] == [rows, rows]


def test_what_the_mode_left_out_and_other_units_are_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    def of(*parts: str, columns: dict[str, FloatArray] | None = None, ticks: Sequence[int] | None = None) -> str:
        return refusal(dot(tmp_path / "a.csv", *parts, columns=columns, ticks=ticks))

    def scaled(part: str, by: float) -> dict[str, FloatArray]:
        return {name: values * by if name.startswith(part) else values for name, values in swing().items()}

    back = [STEP * k for k in range(240)]
    back[100:] = back[90:-10]
    assert {
        "free acceleration without orientation": of("FreeAcc", "Gyr"),
        "no acceleration": of("Quat", "Gyr"),
        "no rates and no orientation": of("Acc"),
        "force in g": of("Acc", "Gyr", columns=scaled("Acc", 1 / 9.81)),
        "force of no size": of("Acc", "Gyr", columns=scaled("Acc", 0.3)),
        "rates in rad/s": of("Quat", "Acc", "Gyr", columns=scaled("Gyr", np.pi / 180)),
        "quaternions of twice their length": of("Quat", "Acc", columns=scaled("Quat", 2.0)),
        "times that go back": of("Acc", "Gyr", ticks=back),
        "times of another rate than the file states": of("Acc", "Gyr", ticks=range(0, 7000 * 240, 7000)),
    } == snapshot


def test_times_that_fit_no_rate_are_asked_for(tmp_path: Path) -> None:
    path = dot(tmp_path / "a.csv", "Acc", "Gyr", ticks=range(0, 7000 * 240, 7000), heads={"DeviceTag": "a"})
    assert "the file's time step of 7000 matches no rate of these sensors" in refusal(path)
    assert block_of(path, 142.857).time_s[-1] == pytest.approx(239 * 0.007)


def test_the_files_of_one_trial_come_together(tmp_path: Path) -> None:
    for name in ("LFemur_20230101_101112_831", "LTibia_20230101_101112_811", "LFoot_20230101_101500_001"):
        dot(tmp_path / f"{name}.csv", "Acc", "Gyr")
    for tag, address in (("bei", "D4CA6EF17860"), ("yao", "D4CA6EF177E4")):
        dot(tmp_path / f"{tag}_{address}_20230830_170505.csv", "Acc", "Gyr")
    found = gather([tmp_path])
    assert sorted(len(one.files) for one in found.trials) == [1, 2, 2]
    placed = {Site.LEFT_THIGH: "LFemur_20230101_101112_831", Site.LEFT_SHANK: "LTibia_20230101_101112_811.csv"}
    files = sorted(tmp_path.glob("L*_811.csv")) + sorted(tmp_path.glob("L*_831.csv"))
    assert set(import_with(movella_dot_trial, files, placed, "walk 1").imu) == set(placed)
