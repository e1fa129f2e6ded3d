"""Tests that MT Manager's texts, in all their dialects, become samples on one clock."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from syrupy.assertion import SnapshotAssertion

from core.body import LEG_SITES, Site
from core.samples import RateKind
from devices.files.imports import ImportedFiles
from devices.files.orientation_rates import derive_rates
from devices.files.refusal import FileRefusedError
from devices.files.xsens_mtmanager import MtFile, mtmanager_trial, read_mtmanager
from tests.trials_of_files import import_with, refused

FindData = Callable[[str], Path]
FOLDER = "vendor_exports/xsens_mtmanager"
IDENTITY = [1.0, 0, 0, 0, 1, 0, 0, 0, 1]
MATRIX = [f"Mat[{row}][{column}]" for column in (1, 2, 3) for row in (1, 2, 3)]
ACC_GYR = ["PacketCounter", "Acc_X", "Acc_Y", "Acc_Z", "Gyr_X", "Gyr_Y", "Gyr_Z"]


def export(
    path: Path, names: list[str], rows: list[list[float]], head: str = "// Update Rate: 100.0Hz", delimiter: str = "\t"
) -> Path:
    lines = [delimiter.join("" if np.isnan(cell) else f"{cell:.6f}" for cell in row[1:]) for row in rows]
    lines = [f"{row[0]:05.0f}{delimiter}{line}" for row, line in zip(rows, lines, strict=True)]
    path.write_text("\n".join([head, delimiter.join(names), *lines, ""]))
    return path


def still(counters: list[int]) -> list[list[float]]:
    return [[float(counter), 0, 0, 9.81, 0.01, 0.02, 0.03] for counter in counters]


def refusal(path: Path) -> str:
    return refused(read_mtmanager, path)


def import_two(one: Path, other: Path, rate_hz: float | None = None) -> ImportedFiles:
    return import_with(
        mtmanager_trial, [one, other], {Site.LEFT_THIGH: one.name, Site.LEFT_SHANK: other.name}, "walk 1", rate_hz
    )


# --- orientation and rates


def test_the_matrix_turns_gravity_up(test_data: FindData) -> None:
    for path in sorted(test_data(FOLDER).glob("OpenSenseExample_*.txt")):
        file = read_mtmanager(path)
        assert file.q_earth_from_sensor is not None
        turn = Rotation.from_quat(file.q_earth_from_sensor, scalar_first=True)
        np.testing.assert_allclose(turn.apply(file.acc_m_s2).mean(axis=0), [0, 0, 9.8], atol=0.12)
        assert np.linalg.norm(turn.inv().apply(file.acc_m_s2).mean(axis=0)[:2]) > 0.3


def test_matrix_quaternion_and_angles_are_one_orientation(test_data: FindData, tmp_path: Path) -> None:
    text = (test_data(FOLDER) / "MT2022_ACC_GYRO_ROT_ALL_TAB_NAN_00B42D4B.txt").read_text()
    turns = []
    for hidden in ([], ["Quat"], ["Quat", "Mat"]):
        path = tmp_path / f"{len(hidden)}.txt"
        path.write_text(re.sub("|".join(hidden) or "^$", "Hidden_", text))
        turns.append(read_mtmanager(path).q_earth_from_sensor)
    for turn in turns[1:]:
        assert turn is not None
        assert turns[0] is not None
        difference = Rotation.from_quat(turns[0], scalar_first=True).inv() * Rotation.from_quat(turn, scalar_first=True)
        assert np.degrees(difference.magnitude()).max() < 0.001


def test_derived_rates_belong_to_their_stamps() -> None:
    rate_hz, omega = 100.0, 2 * np.pi * 3.0
    time_s = np.arange(400) / rate_hz

    def turn_at(t: np.ndarray) -> Rotation:
        return Rotation.from_euler(
            "ZYX", np.column_stack([0.5 * t, 0.8 * np.sin(omega * t), 0.6 * np.cos(omega * t + 0.4)])
        )

    tiny = 1e-5
    true = (turn_at(time_s - tiny).inv() * turn_at(time_s + tiny)).as_rotvec() / (2 * tiny)
    q = turn_at(time_s).as_quat(scalar_first=True)
    derived = derive_rates(q, np.arange(400), rate_hz)
    assert np.isnan(derived[[0, -1]]).all()
    assert np.isfinite(derived[1:-1]).all()
    assert np.abs(derived - true)[2:-2].max() < 0.005 * np.abs(true).max()
    half_a_sample = (turn_at(time_s[:-1]).inv() * turn_at(time_s[1:])).as_rotvec() * rate_hz
    assert np.abs(half_a_sample - true[:-1]).max() > 0.05 * np.abs(true).max()  # what a one-sided difference would do


@given(steps=st.lists(st.integers(1, 4), min_size=2, max_size=30), sign=st.sampled_from([1, -1]))
def test_a_constant_rate_is_derived_exactly_and_never_across_a_gap(steps: list[int], sign: int) -> None:
    counter = np.cumsum(steps)
    rate = np.array([1.0, -2.0, 0.5])
    q = Rotation.from_rotvec(rate * (counter[:, None] / 100)).as_quat(scalar_first=True) * sign
    derived = derive_rates(q, counter, 100.0)
    has_both = np.zeros(len(counter), dtype=bool)
    has_both[1:-1] = (np.diff(counter)[:-1] == 1) & (np.diff(counter)[1:] == 1)
    np.testing.assert_array_equal(np.isfinite(derived).all(axis=1), has_both)
    np.testing.assert_allclose(derived[has_both], np.tile(rate, (has_both.sum(), 1)), atol=1e-9)


def test_derived_rates_agree_with_a_gyroscope(test_data: FindData) -> None:
    file = read_mtmanager(test_data(FOLDER) / "MT_012005D6_031-000_00B4227B.txt")
    assert file.gyr_rad_s is not None
    assert file.q_earth_from_sensor is not None
    derived = derive_rates(file.q_earth_from_sensor, file.counter, 100.0)
    averaged = 0.5 * (derived[1:] + derived[:-1])  # the gyroscope's are means over the interval before
    rms = np.sqrt(np.nanmean((file.gyr_rad_s[1:] - averaged) ** 2, axis=0))
    assert (rms < 0.02).all()


# --- real files


def test_every_variant_holds_the_same_samples(test_data: FindData) -> None:
    files = [read_mtmanager(path) for path in sorted(test_data(FOLDER).glob("MT2022_ACC_GYRO_ROT_MAT_*"))]
    assert len(files) == 3
    for file in files:
        np.testing.assert_array_equal(file.counter, np.arange(51400, 51405))
        np.testing.assert_array_equal(file.acc_m_s2[0], [0.074225, -0.040975, 9.922524])
        assert file.gyr_rad_s is not None
        np.testing.assert_array_equal(file.gyr_rad_s[-1], [0.002574, 0.006178, -0.001358])
        np.testing.assert_array_equal(file.q_earth_from_sensor, files[0].q_earth_from_sensor)
        assert (file.info.serial, file.info.model, file.info.firmware) == ("00B42D4B", "MTW2-3A7G6", "4.4.0")
        assert file.rate_hz is None


def test_a_real_walk_is_imported(test_data: FindData) -> None:
    folder = test_data(FOLDER)
    sites = {"femur": "thigh", "tibia": "shank", "calcn": "foot"}
    placement = {}
    for sensor in ET.parse(folder / "OpenSenseExample_myIMUMappings.xml").iter("ExperimentalSensor"):
        bone, side, *_ = (sensor.findtext("name_in_model") or "").split("_")
        if bone in sites:
            placement[Site(f"{'left' if side == 'l' else 'right'}_{sites[bone]}")] = sensor.attrib["name"]
    imported = import_with(mtmanager_trial, sorted(folder.glob("OpenSenseExample_*")), placement, "walk 1")
    assert set(imported.imu) == set(LEG_SITES)
    assert imported.imu[Site.LEFT_THIGH].sensor == "00B421EE"
    lengths = {len(block) for block in imported.imu.values()}
    assert min(lengths) == 2432
    assert max(lengths) == 2505
    for site, block in imported.imu.items():
        assert block.is_rate_derived
        np.testing.assert_allclose(block.time_s, np.arange(len(block)) / 100)
        assert np.isfinite(block.gyr_rad_s[1:-1]).all()
        assert imported.sensors[site].rate_kind is RateKind.INSTANTANEOUS
    reported = [(finding.key, finding.where) for finding in imported.findings]
    assert reported.count(("file_left_out", "walk 1")) == 3
    assert all(("rate_from_orientation", f"walk 1, {site}") in reported for site in LEG_SITES)


def test_the_kind_of_rate_is_read_from_the_orientation(test_data: FindData) -> None:
    files = sorted(test_data(FOLDER).glob("MT_012005D6_031-000_*"))
    imported = import_with(mtmanager_trial, files, {Site.LEFT_THIGH: "00B421AF", Site.LEFT_SHANK: "00B4227B"}, "walk 1")
    assert [info.rate_kind for info in imported.sensors.values()] == [RateKind.AVERAGED] * 2
    block = imported.imu[Site.LEFT_THIGH]
    assert block.mag is not None
    assert not block.is_rate_derived
    assert imported.findings == ()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("MT2022_ACC_00B42D4B.txt", "neither angular rates"),
        ("MT_012005D6-000_sit_to_stand-000_00B421ED.txt", "there is no acceleration"),
        ("OpenSenseExample_myIMUMappings.xml", "column PacketCounter is missing"),
    ],
)
def test_files_that_lack_what_is_needed_are_refused(test_data: FindData, name: str, words: str) -> None:
    assert words in refusal(test_data(FOLDER) / name)


def test_a_rate_that_no_file_shows_is_asked_for(test_data: FindData) -> None:
    path = test_data(FOLDER) / "MT_01200454_000-000_00B40DE4.txt"
    placement = {Site.LEFT_THIGH: "00B40DE4"}
    stated = refused(import_with, mtmanager_trial, [path], placement, "walk 1")
    assert "the sample rate is missing. Give the sample rate in Hz (--rate)" in stated
    block = import_with(mtmanager_trial, [path], placement, "walk 1", rate_hz=60.0).imu[Site.LEFT_THIGH]
    np.testing.assert_allclose(block.time_s, np.arange(4) / 60)
    assert block.mag is not None


# --- the counter


def test_files_are_aligned_by_the_counter_across_its_turn(tmp_path: Path) -> None:
    one = export(tmp_path / "t_00B40001.txt", ACC_GYR, still([65534, 65535, 0, 1, 5]))
    other = export(tmp_path / "t_00B40002.txt", ACC_GYR, still([0, 1, 2]))
    for first, second in ((one, other), (other, one)):
        imu = import_two(first, second).imu.values()
        stamps = {block.sensor: list(block.time_s) for block in imu}
        assert stamps["00B40001"] == pytest.approx([0, 0.01, 0.02, 0.03, 0.07])
        assert stamps["00B40002"] == pytest.approx([0.02, 0.03, 0.04])


def test_a_packet_twice_is_dropped_and_reported(tmp_path: Path) -> None:
    path = export(tmp_path / "a.txt", ACC_GYR, still([1, 2, 2, 3]))
    imported = import_with(mtmanager_trial, [path], {Site.LEFT_FOOT: "a"}, "walk 1")
    assert len(imported.imu[Site.LEFT_FOOT]) == 3
    assert [(f.key, f.where, f.numbers) for f in imported.findings] == [
        ("doubled_stamps", "walk 1, left_foot", {"count": 1})
    ]


def test_files_that_are_not_of_one_recording_are_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    one = export(tmp_path / "a.txt", ACC_GYR, still([1, 2, 3]))
    later = export(tmp_path / "b.txt", ACC_GYR, still([100, 101]))
    slower = export(tmp_path / "c.txt", ACC_GYR, still([1, 2, 3]), head="// Update Rate: 60.0Hz")
    assert {
        "they share no packet": refused(import_two, one, later),
        "they have two rates": refused(import_two, one, slower),
        "another rate is stated": refused(import_two, one, one, 50.0),
    } == snapshot


def test_a_rate_reported_once_holds_for_the_trial(tmp_path: Path) -> None:
    one = export(tmp_path / "a.txt", ACC_GYR, still([1, 2, 3]))
    other = export(tmp_path / "b.txt", ACC_GYR, still([1, 2, 3]), head="// Filter Profile: human")
    assert import_two(other, one).imu[Site.LEFT_THIGH].time_s[1] == pytest.approx(0.01)


def test_the_rate_comes_from_the_fine_clock_where_there_is_one(tmp_path: Path) -> None:
    rows = [[counter, (2**32 - 300 + 166.0 * i) % 2**32, *still([0])[0][1:]] for i, counter in enumerate([7, 8, 9, 10])]
    path = export(tmp_path / "a.txt", ["PacketCounter", "SampleTimeFine", *ACC_GYR[1:]], rows, head="// none")
    assert read_mtmanager(path).rate_hz == pytest.approx(10_000 / 166)


def test_header_only_files_hold_no_samples(tmp_path: Path) -> None:
    one = export(tmp_path / "a.txt", [*ACC_GYR, *MATRIX], [])
    other = export(tmp_path / "b.txt", [*ACC_GYR[:4], *MATRIX], [[5.0, 0, 0, 9.8, *IDENTITY]])
    assert [len(block) for block in import_two(one, other).imu.values()] == [0, 1]


# --- refusals


QUATERNION = [f"Quat_q{k}" for k in range(4)]
LEVEL = [1.0, 0, 0, 9.8, 0, 0, 0]
WRONG: dict[str, tuple[list[str], list[list[float]]]] = {
    "no counter": (ACC_GYR[1:], []),
    "a counter that goes back": (ACC_GYR, still([5, 4])),
    "a counter of 17 bits": (ACC_GYR, [[70000.0, *LEVEL[1:]]]),
    "force in g": (ACC_GYR, [[1.0, 0, 0, 1.0, 0, 0, 0]]),
    "force without gravity": (ACC_GYR, [[1.0, 0, 0, 0.1, 0, 0, 0]]),
    "rates in deg/s": (ACC_GYR, [[1.0, 0, 0, 9.8, 0, 0, 250.0]]),
    "a matrix that stretches": ([*ACC_GYR, *MATRIX], [[*LEVEL, *IDENTITY[:8], 0.9]]),
    "a matrix that mirrors": ([*ACC_GYR, *MATRIX], [[*LEVEL, *IDENTITY[:8], -1.0]]),
    "a quaternion of zeros": ([*ACC_GYR, *QUATERNION], [[*LEVEL, 0, 0, 0, 0]]),
}


def test_what_is_wrong_is_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    assert {case: refusal(export(tmp_path / "a.txt", *wrong)) for case, wrong in WRONG.items()} == snapshot


def test_slow_rates_in_degrees_are_seen_by_the_orientation(tmp_path: Path) -> None:
    rows = []
    for i in range(50):
        matrix = Rotation.from_rotvec([0, 0, 0.5 * i / 100]).as_matrix().T.ravel()
        rows.append([float(i), 0, 0, 9.81, 0, 0, float(np.degrees(0.5)), *matrix])
    assert "deg/s" in refusal(export(tmp_path / "a.txt", [*ACC_GYR, *MATRIX], rows))


def test_missing_orientations_are_nan(tmp_path: Path) -> None:
    rows = [[float(i), 0, 0, 9.8, *(IDENTITY if i != 3 else [np.nan] * 9)] for i in range(7)]
    file: MtFile = read_mtmanager(export(tmp_path / "a.txt", [*ACC_GYR[:4], *MATRIX], rows))
    assert file.q_earth_from_sensor is not None
    np.testing.assert_array_equal(np.isnan(file.q_earth_from_sensor).any(axis=1), np.arange(7) == 3)
    block = import_with(mtmanager_trial, [file.path], {Site.LEFT_FOOT: "a"}, "walk 1").imu[Site.LEFT_FOOT]
    np.testing.assert_array_equal(np.isnan(block.gyr_rad_s).any(axis=1), [1, 0, 1, 1, 1, 0, 1])


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), delimiter=st.sampled_from("\t;, "))
def test_spoilt_files_are_refused_or_read(
    data: st.DataObject, delimiter: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    rows = [[*row, *IDENTITY] for row in still([1, 2, 3, 5])]
    path = tmp_path_factory.mktemp("spoilt") / "a.txt"
    content = bytearray(export(path, [*ACC_GYR, *MATRIX], rows, delimiter=delimiter).read_bytes())
    for _ in range(data.draw(st.integers(0, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    try:
        imported = import_with(mtmanager_trial, [path], {Site.LEFT_FOOT: "a.txt"}, "walk 1")
    except FileRefusedError as refused:
        stated = str(refused)
        assert stated.isprintable()
        return
    assert len(imported.imu[Site.LEFT_FOOT]) <= 4
