"""Tests that files find their sites, and recordings their session."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from core.findings import Finding, Severity
from core.samples import ImuBlock, RateKind, SensorInfo
from core.session import Recording, RecordingKind, Session
from devices.files.formats import read_trial
from devices.files.imports import add_recording, folder_for, free_name, parse_map, place_trial
from devices.files.refusal import FileRefusedError
from devices.files.session_folder import read_session, write_session
from devices.files.trial import ImportedSensor, ImportedTrial, UnreadFile
from tests.trials_of_files import refused


def block(sensor: str) -> ImuBlock:
    return ImuBlock(sensor, np.arange(2.0), np.ones((2, 3)), np.ones((2, 3)))


def walk(name: str, sensor: str = "A1") -> Recording:
    return Recording(name, RecordingKind.WALKING, folder_for(name), {Site.LEFT_THIGH: block(sensor)})


def test_a_map_names_sites() -> None:
    placement = parse_map("left_thigh=a/b.txt, left_shank = _00B421E6,right_foot=x,y z.txt")
    assert placement == {
        Site.LEFT_THIGH: "a/b.txt",
        Site.LEFT_SHANK: "_00B421E6",
        Site.RIGHT_FOOT: "x,y z.txt",
    }


def test_a_wrong_map_is_refused(snapshot: SnapshotAssertion) -> None:
    texts = ("", "left_thigh", "left_thigh=", "sternum=a", "left_thigh=a,left_thigh=b")
    assert {text: refused(parse_map, text) for text in texts} == snapshot


def sensor(path: Path, *ids: str, start_s: float = 0.0) -> ImportedSensor:
    worn = replace(block(path.stem), time_s=start_s + np.arange(2.0))
    return ImportedSensor(path.name, ids, str(path), worn, SensorInfo(), (Finding("x", Severity.INFO, ""),))


@pytest.fixture
def trial(tmp_path: Path) -> ImportedTrial:
    paths = [tmp_path / name for name in ("t_00B40001.txt", "t_00B40002.txt", "u_00B40002.txt")]
    broken = FileRefusedError("b_00B40003.txt", "there is no acceleration", "Export it again")
    unread = UnreadFile(str(tmp_path / "b_00B40003.txt"), ("00B40003",), broken)
    return ImportedTrial("xsens-mtmanager", tuple(sensor(path, path.stem[-8:]) for path in paths), (unread,))


@pytest.mark.parametrize("called", ["00B40001", "_00B40001", "00b40001", "t_00B40001.txt", "t_00B40001"])
def test_a_sensor_is_found_by_its_file_or_id(trial: ImportedTrial, called: str) -> None:
    found = place_trial(trial, {Site.LEFT_FOOT: called}, "walk 1")
    assert {site: one.sensor for site, one in found.imu.items()} == {Site.LEFT_FOOT: "t_00B40001"}
    assert [(one.key, one.where, dict(one.numbers)) for one in found.findings] == [
        *(("file_left_out", "walk 1", {"name": f"{name}.txt"}) for name in ("t_00B40002", "u_00B40002", "b_00B40003")),
        ("x", "walk 1, left_foot", {}),
    ]


def test_a_sensor_is_found_by_the_path_of_its_file(
    trial: ImportedTrial, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path.parent)
    for value in (str(tmp_path / "u_00B40002.txt"), f"{tmp_path.name}/u_00B40002.txt"):
        assert place_trial(trial, {Site.LEFT_FOOT: value}, "walk 1").imu[Site.LEFT_FOOT].sensor == "u_00B40002"


def test_a_map_that_fits_no_sensor_is_refused(trial: ImportedTrial, snapshot: SnapshotAssertion) -> None:
    foot = Site.LEFT_FOOT
    placements: dict[str, dict[Site, str]] = {
        "an unknown id": {foot: "00B49999"},
        "an id of two files": {foot: "00B40002"},
        "one sensor at two sites": {foot: "00B40001", Site.LEFT_SHANK: "t_00B40001.txt"},
        "the id of a file that cannot be read": {foot: "00B40003"},
        "the name of a file that cannot be read": {foot: "b_00B40003.txt"},
    }
    found = {case: refused(place_trial, trial, placement, "walk 1") for case, placement in placements.items()}
    assert found == snapshot


def test_time_starts_with_the_first_sample_that_is_placed(tmp_path: Path) -> None:
    starts = {"a": 0.0, "b": 5.5, "c": 5.0}
    sensors = tuple(sensor(tmp_path / f"{name}.txt", start_s=start_s) for name, start_s in starts.items())
    trial = ImportedTrial("xsens-mtmanager", sensors)
    found = place_trial(trial, {Site.LEFT_FOOT: "b", Site.LEFT_SHANK: "c"}, "walk 1")
    assert [found.imu[site].time_s[0] for site in (Site.LEFT_FOOT, Site.LEFT_SHANK)] == [0.5, 0.0]
    apart = refused(place_trial, trial, {Site.LEFT_FOOT: "a", Site.LEFT_SHANK: "b"}, "walk 1")
    assert "b.txt: one sensor's data start after the last sample of a.txt, so both do not belong to one trial" in apart


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    for name in ("", "xsens-mtmanager"):
        assert "this file does not exist" in refused(read_trial, name, [tmp_path / "none.txt"], None)


def test_a_second_import_adds_a_recording(tmp_path: Path) -> None:
    reported = Finding("file_left_out", Severity.INFO, "walk 1", {"name": "x"})
    info = {Site.LEFT_THIGH: SensorInfo("A1", rate_hz=100.0, rate_kind=RateKind.AVERAGED)}
    session = add_recording(Session(()), walk("walk 1"), info, [reported])
    assert session.findings == (reported,)
    write_session(session, tmp_path / "s")
    session = add_recording(read_session(tmp_path / "s"), walk("walk 2"), info)
    write_session(session, tmp_path / "s")
    session = read_session(tmp_path / "s")
    assert session.findings == (reported,)
    assert [recording.name for recording in session.recordings] == ["walk 1", "walk 2"]
    assert session.sensors == info


def test_a_sensor_that_changes_is_reported(tmp_path: Path) -> None:
    session = add_recording(Session(()), walk("walk 1"), {Site.LEFT_THIGH: SensorInfo("A1", rate_hz=100.0)})
    other = {Site.LEFT_THIGH: SensorInfo("B2", rate_hz=60.0)}
    session = add_recording(session, walk("walk 2", "B2"), other)
    assert [(f.key, f.where) for f in session.findings] == [("sensor_changed", "walk 2, left_thigh")]
    assert session.sensors[Site.LEFT_THIGH] == SensorInfo("A1")  # the rate is no longer the same for all
    session = add_recording(session, walk("walk 3", "B2"), other)
    assert len(session.findings) == 1
    write_session(session, tmp_path / "s")
    again = read_session(tmp_path / "s")
    assert [recording.imu[Site.LEFT_THIGH].sensor for recording in again.recordings] == ["A1", "B2", "B2"]
    assert [(f.key, f.where) for f in again.findings] == [("sensor_changed", "walk 2, left_thigh")]


def test_a_recording_that_is_there_already_is_refused(snapshot: SnapshotAssertion) -> None:
    session = add_recording(Session(()), walk("walk 1"))
    assert {name: refused(add_recording, session, walk(name)) for name in ("walk 1", "walk_1")} == snapshot


def test_recordings_are_named_by_their_kind() -> None:
    session = Session(())
    names = []
    for kind in (RecordingKind.STANDING, RecordingKind.FREE_MOTION, RecordingKind.WALKING) * 2:
        name = free_name(session, kind)
        session = add_recording(session, Recording(name, kind, folder_for(name), {}))
        names.append(name)
    assert names == ["standing", "free motion", "walk 1", "standing 2", "free motion 2", "walk 2"]


@pytest.mark.parametrize(
    ("name", "folder"),
    [
        ("walk 1", "walk_1"),
        ("../../etc", "etc"),
        ("a/b\\c: d", "a_b_c_d"),
        ("Übung 2.1", "Übung_2.1"),
        ("//", "recording"),
    ],
)
def test_a_folder_is_named_after_its_recording(name: str, folder: str) -> None:
    assert folder_for(name) == folder
