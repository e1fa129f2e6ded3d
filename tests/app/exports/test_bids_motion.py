"""Tests that a session leaves as BIDS-Motion has it, and comes back to the last digit."""

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.exports.bids_motion import write_bids
from app.exports.exports import Format, export_from_folder
from app.exports.result_folder import write_results
from core.body import Site
from core.results import Analysis, Method
from core.samples import FloatArray, ImuBlock, RateKind, SensorInfo
from core.session import Recording, RecordingKind, Session
from devices.files.bids_motion import bids_motion_trial
from devices.files.formats import recognised
from devices.files.imports import ImportedFiles
from devices.files.site_names import site_of_name
from tests.app.exports.conftest import Visit
from tests.app.exports.written_tables import csv_rows
from tests.other_programs import ask_python
from tests.swinging_sensor import swinging_sensor
from tests.trials_of_files import import_with

NOTHING = Analysis(Method.ROBUST, False, (), ())
PLACES = {Site.LEFT_THIGH: "LeftThigh", Site.LEFT_SHANK: "LeftShank", Site.RIGHT_FOOT: "RightFoot"}


def tables(folder: Path, ending: str) -> list[Path]:
    return sorted(folder.glob(f"sub-*/motion/*{ending}"))


def cells(path: Path) -> list[dict[str, str]]:
    names, *rows = (line.split("\t") for line in path.read_text(encoding="utf-8").splitlines())
    return [dict(zip(names, row, strict=True)) for row in rows]


def block(sensor: str, reach_rad: float = 0.7, **more: Any) -> ImuBlock:
    one = swinging_sensor(200, reach_rad=reach_rad)
    return replace(ImuBlock(sensor, one.time_s, one.gyr_rad_s, one.acc_m_s2), **more)


def session_of(imu: dict[Site, ImuBlock], **more: Any) -> Session:
    infos = {
        site: SensorInfo(serial=one.sensor, rate_hz=100.0, rate_kind=RateKind.AVERAGED) for site, one in imu.items()
    }
    recording = Recording("walk 1", RecordingKind.WALKING, "walk_1", imu, started="2026-11-21T10:00:00.25+01:00")
    return replace(Session((recording,), sensors=infos), **more)


def back(folder: Path, files: Sequence[Path], sites: Sequence[Site]) -> ImportedFiles:
    assert recognised(files) == "bids-motion"
    return import_with(bids_motion_trial, files, {site: PLACES[site] for site in sites}, "walk 1")


def same(one: FloatArray | None, other: FloatArray | None) -> None:
    assert (one is None) == (other is None)
    if one is not None and other is not None:
        np.testing.assert_array_equal(one, other)


def test_every_recording_of_a_visit_comes_back_to_the_last_digit(visit: Visit, tmp_path: Path) -> None:
    session = visit[0]
    write_bids(*visit, tmp_path / "bids")
    found = tables(tmp_path / "bids", "_motion.tsv")
    assert len(found) == len(session.recordings) == 3
    for recording, task in zip(session.recordings, ("standing", "freeMotion", "walking"), strict=True):
        (path,) = (one for one in found if f"_task-{task}_tracksys-imu_run-1_" in one.name)
        trial = bids_motion_trial([path])
        assert {site_of_name(sensor.name) for sensor in trial.sensors} == set(recording.imu)
        for sensor in trial.sensors:
            site = site_of_name(sensor.name)
            assert site is not None
            was = recording.imu[site]
            same(sensor.block.time_s, was.time_s)
            same(sensor.block.acc_m_s2, was.acc_m_s2)
            same(sensor.block.gyr_rad_s, was.gyr_rad_s)
            assert sensor.block.sensor == was.sensor
            assert sensor.info.rate_hz == session.sensors[site].rate_hz
            assert sensor.info.rate_kind == session.sensors[site].rate_kind


def test_gaps_orientation_field_and_derived_rates_come_back(tmp_path: Path) -> None:
    q = swinging_sensor(200).q_earth_from_sensor
    mag = np.random.default_rng(1).normal(size=(200, 3))
    rows = np.r_[0:80, 120:200]  # with a gap
    thigh = block("A", q_earth_from_sensor=q, mag=mag).select(rows)
    acc = np.array(thigh.acc_m_s2)
    acc[5, 1] = np.nan
    imu = {
        Site.LEFT_THIGH: replace(thigh, acc_m_s2=acc),
        Site.LEFT_SHANK: replace(block("B", 0.3, is_rate_derived=True).select(rows)),
    }
    write_bids(session_of(imu), NOTHING, tmp_path / "bids")
    (path,) = tables(tmp_path / "bids", "_motion.tsv")
    imported = back(tmp_path, [path], list(imu))
    for site, was in imu.items():
        found = imported.imu[site]
        for name in ("time_s", "gyr_rad_s", "acc_m_s2", "q_earth_from_sensor", "mag"):
            same(getattr(found, name), getattr(was, name))
        assert found.is_rate_derived == was.is_rate_derived
    assert imported.sensors[Site.LEFT_THIGH].rate_kind is RateKind.AVERAGED


def test_sensors_of_other_times_are_tracking_systems_of_their_own_that_come_back_together(tmp_path: Path) -> None:
    late = block("C", 0.5)
    imu = {
        Site.LEFT_THIGH: block("A"),
        Site.RIGHT_FOOT: replace(late, time_s=late.time_s * 1.0001 + 0.123),
        Site.LEFT_SHANK: block("B", 0.3),
    }
    write_bids(session_of(imu), NOTHING, tmp_path / "bids")
    found = tables(tmp_path / "bids", "_motion.tsv")
    assert ["_tracksys-imu1_" in one.name for one in found] == [True, False]
    assert ["_tracksys-imu2_" in one.name for one in found] == [False, True]
    imported = back(tmp_path, found, list(imu))
    for site, was in imu.items():
        same(imported.imu[site].time_s, was.time_s)
        same(imported.imu[site].gyr_rad_s, was.gyr_rad_s)
    assert imported.findings == ()


def test_tables_are_as_bids_has_them(tmp_path: Path) -> None:
    folder = tmp_path / "bids"
    write_bids(session_of({Site.LEFT_THIGH: block("A"), Site.LEFT_SHANK: block("B")}), NOTHING, folder)
    (motion,), (channels,), (settings,) = (
        tables(folder, ending) for ending in ("_motion.tsv", "_channels.tsv", "_motion.json")
    )
    rows = cells(channels)
    assert {"name", "component", "type", "tracked_point", "units"} <= set(rows[0])
    assert len({row["name"] for row in rows}) == len(rows)
    assert {len(line.split("\t")) for line in motion.read_text().splitlines()} == {len(rows)}
    assert (rows[0]["type"], rows[0]["units"]) == ("LATENCY", "s")
    reported = json.loads(settings.read_text())
    assert (reported["TaskName"], reported["SamplingFrequency"], reported["TrackedPointsCount"]) == (
        "walking",
        100.0,
        2,
    )
    assert reported["MotionChannelCount"] == len(rows) == 13
    assert reported["ACCELChannelCount"] == reported["GYROChannelCount"] == 6
    (scan,) = cells(next(folder.glob("sub-*/*_scans.tsv")))
    assert scan == {"filename": f"motion/{motion.name}", "acq_time": "2026-11-21T09:00:00.250000Z"}
    description = json.loads((folder / "dataset_description.json").read_text())
    assert {"Name", "BIDSVersion", "DatasetType"} <= set(description)
    labels = (
        r"sub-[A-Za-z0-9]+_task-[A-Za-z0-9]+_tracksys-[A-Za-z0-9]+_run-\d+_(motion\.(tsv|json)|channels\.(tsv|json))"
    )
    assert all(re.fullmatch(labels, path.name) for path in folder.glob("sub-*/motion/*"))


def test_a_start_that_is_not_known_is_stated_so(tmp_path: Path) -> None:
    session = session_of({Site.LEFT_THIGH: block("A"), Site.LEFT_SHANK: block("B")})
    session = replace(session, recordings=(replace(session.recordings[0], started=""),))
    write_bids(session, NOTHING, tmp_path / "bids")
    (scan,) = cells(next((tmp_path / "bids").glob("sub-*/*_scans.tsv")))
    assert scan["acq_time"] == "n/a"
    assert bids_motion_trial(tables(tmp_path / "bids", "_motion.tsv")).started == ""


def test_systems_without_a_known_start_come_back_together(tmp_path: Path) -> None:
    late = block("C", 0.5)
    imu = {Site.LEFT_THIGH: block("A"), Site.RIGHT_FOOT: replace(late, time_s=late.time_s * 1.0001 + 0.123)}
    session = session_of(imu)
    write_bids(replace(session, recordings=(replace(session.recordings[0], started=""),)), NOTHING, tmp_path / "bids")
    found = tables(tmp_path / "bids", "_motion.tsv")
    imported = back(tmp_path, found, list(imu))
    assert imported.findings == ()
    for site, was in imu.items():
        same(imported.imu[site].time_s, was.time_s)
    for settings in tables(tmp_path / "bids", "_motion.json"):  # of another program nothing ties them
        text = settings.read_text(encoding="utf-8")
        assert "LatenciesFromOneStart" in text
        settings.write_text(text.replace('"LatenciesFromOneStart": true', '"LatenciesFromOneStart": "?"'))
    assert {one.key for one in back(tmp_path, found, list(imu)).findings} == {"not_synchronised"}


def test_the_events_of_a_walk_are_on_the_clock_of_its_samples(visit: Visit, tmp_path: Path) -> None:
    session, analysis = visit
    (tmp_path / "results").mkdir()
    write_results(session, analysis, tmp_path / "results")
    write_bids(session, analysis, tmp_path / "bids")
    (events,) = tables(tmp_path / "bids", "_events.tsv")  # nobody steps while standing or in free motion
    assert "_task-walking_run-1_events.tsv" in events.name
    (written,) = (tmp_path / "results").glob("walk*/events.csv")
    expected = csv_rows(written)
    rows = cells(events)
    assert [(float(row["onset"]), row["trial_type"], row["side"]) for row in rows] == [
        (float(row["time_s"]), row["event"], row["side"]) for row in expected
    ]
    assert {row["duration"] for row in rows} == {"0"}
    about = json.loads(events.with_suffix(".json").read_text(encoding="utf-8"))
    assert set(about["trial_type"]["Levels"]) == {row["trial_type"] for row in rows}
    assert set(about) == set(rows[0])
    (motion,) = (one for one in tables(tmp_path / "bids", "_motion.tsv") if "_task-walking_" in one.name)
    latencies = [float(line.split("\t")[0]) for line in motion.read_text(encoding="utf-8").splitlines()]
    assert latencies[0] <= float(rows[0]["onset"]) <= float(rows[-1]["onset"]) <= latencies[-1]
    assert recognised([motion]) == "bids-motion"


@pytest.mark.parametrize(("operator", "author"), [("TM", "TM"), ("", "n/a")])
def test_the_author_is_who_measured_where_that_is_stated(tmp_path: Path, operator: str, author: str) -> None:
    write_bids(session_of({Site.LEFT_THIGH: block("A")}, operator=operator), NOTHING, tmp_path / "bids")
    description = json.loads((tmp_path / "bids" / "dataset_description.json").read_text(encoding="utf-8"))
    assert description["Authors"] == [author]


VALIDATOR = """
import json, subprocess, sys
from pathlib import Path
program = Path(sys.executable).with_name("bids-validator-deno")
done = subprocess.run([str(program), "--format", "json", sys.argv[1]], capture_output=True, text=True)
print(json.dumps(json.loads(done.stdout)["issues"]["issues"]))
"""


@pytest.mark.endurance
def test_the_validator_of_bids_finds_no_error(visit: Visit, tmp_path: Path) -> None:
    export_from_folder(*visit, [Format.BIDS], tmp_path)
    issues = ask_python("bids-validator-deno", VALIDATOR, tmp_path / "bids")
    assert [one for one in issues if one["severity"] == "error"] == []
    codes = {one["code"] for one in issues}
    assert "NO_AUTHORS" not in codes
    (channels,) = (one for one in tables(tmp_path / "bids", "_channels.tsv") if "_task-walking_" in one.name)
    channels.unlink()  # which it does find
    assert [
        one for one in ask_python("bids-validator-deno", VALIDATOR, tmp_path / "bids") if one["severity"] == "error"
    ]


def test_what_was_discarded_or_is_empty_does_not_leave(tmp_path: Path) -> None:
    session = session_of({Site.LEFT_THIGH: block("A")})
    (walk,) = session.recordings
    nothing = replace(walk, name="walk 3", imu={Site.LEFT_THIGH: walk.imu[Site.LEFT_THIGH].select(slice(0))})
    session = replace(session, recordings=(replace(walk, name="walk 2", is_kept=False), walk, nothing))
    write_bids(session, NOTHING, tmp_path / "bids")
    assert len(tables(tmp_path / "bids", "_motion.tsv")) == 1


@pytest.mark.endurance
@pytest.mark.parametrize(("born", "age"), [(1950, "76"), (1937, "89"), (1920, "89"), (None, "n/a")])
def test_the_participant_is_reported_without_a_name(visit: Visit, tmp_path: Path, born: int | None, age: str) -> None:
    session, analysis = visit
    session = replace(session, patient=replace(session.patient, birth_year=born))
    export_from_folder(session, analysis, [Format.BIDS], tmp_path)
    (row,) = cells(tmp_path / "bids" / "participants.tsv")
    assert row["participant_id"] == next((tmp_path / "bids").glob("sub-*")).name
    assert "Miller" not in row["participant_id"]
    assert (row["age"], row["sex"]) == (age, "F")
