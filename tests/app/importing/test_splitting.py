"""Tests that a recording is split where its clocks show it, and that nothing is known of clocks that was not."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.importing.import_drafts import drafts_of, session_of, split_draft
from app.importing.splitting import clock_view_of, split_all, split_trial
from core.body import Site
from core.session import Recording, RecordingKind, Session
from devices.files.formats import read_trial
from devices.files.imports import add_recording, place_trial
from devices.files.refusal import FileRefusedError
from devices.files.trial import ImportedTrial
from tests.clock_files import ALL, TIME_S, jumped, pair, restarted, without

PLACED = {Site.LEFT_THIGH: "left_thigh", Site.LEFT_SHANK: "left_shank"}
WALKING = RecordingKind.WALKING
PAUSED = TIME_S, without((6.0, 11.0))


def read(paths: list[Path]) -> ImportedTrial:
    return read_trial("", paths, None, splits=True)


def keys(trial: ImportedTrial) -> set[str]:
    return {one.key for sensor in trial.sensors for one in sensor.findings}


def clocks(trial: ImportedTrial) -> set[str]:
    return {sensor.info.clock for sensor in trial.sensors}


def test_a_restart_of_all_clocks_is_split_to_the_sample_and_keeps_them_together(tmp_path: Path) -> None:
    trial = read(pair(tmp_path, (restarted(9.0), ALL), (restarted(9.0), ALL)))
    first, second = split_trial(trial, 9.2)  # as somebody types it who read a rounded time
    assert [len(sensor.block) for sensor in (*first.sensors, *second.sensors)] == [900, 900, 1100, 1100]
    for part in (first, second):
        assert clock_view_of(part).events == ()
        assert clocks(part) == clocks(trial)
        assert "split_clocks" not in keys(part)
        placed = place_trial(part, PLACED, "walk")
        assert all(block.time_s[0] == 0.0 for block in placed.imu.values())


def test_a_restart_of_one_clock_leaves_the_sensors_without_a_common_one(tmp_path: Path) -> None:
    trial = read(pair(tmp_path, (restarted(9.0), ALL)))
    first, second = split_trial(trial, 9.0)
    assert clocks(first) == clocks(second) == {"left_shank", "left_thigh"}
    assert "split_clocks" in keys(second)
    assert "split_clocks" not in keys(first)


def test_a_session_states_no_common_clock_once_one_of_its_recordings_has_none(tmp_path: Path) -> None:
    (tmp_path / "whole").mkdir()
    whole = place_trial(read(pair(tmp_path / "whole")), PLACED, "walk 1", is_one_receiver=True)
    session = add_recording(Session(()), Recording("walk 1", WALKING, "walk_1", whole.imu), whole.sensors)
    assert len({info.clock for info in session.sensors.values()}) == 1
    _, second = split_trial(read(pair(tmp_path, (restarted(9.0), ALL))), 9.0)
    broken = place_trial(second, PLACED, "walk 2")
    session = add_recording(session, Recording("walk 2", WALKING, "walk_2", broken.imu), broken.sensors)
    assert {info.clock for info in session.sensors.values()} == {""}


def test_a_jump_is_closed_and_its_recording_can_be_placed(tmp_path: Path) -> None:
    trial = read(pair(tmp_path, shank=(jumped(9.0, 3600.0), ALL)))
    with pytest.raises(FileRefusedError, match=r"jumps forward by 3600.* \(--split-at 9.0\)"):
        place_trial(trial, PLACED, "walk 1")
    first, second = split_trial(trial, 9.0)
    lengths_s = [float(np.ptp(block.time_s)) for block in place_trial(second, PLACED, "walk 2").imu.values()]
    assert lengths_s == pytest.approx([10.99, 10.99], abs=0.02)
    assert len(place_trial(first, PLACED, "walk 1").imu) == 2
    assert "split_clocks" in keys(second)


def test_a_pause_is_split_in_its_middle_and_keeps_clocks_and_day(tmp_path: Path) -> None:
    trial = replace(read(pair(tmp_path, PAUSED, PAUSED)), started="2026-03-09T10:00:00")
    for at_s in (5.99, 8.0, 11.2):
        first, second = split_trial(trial, at_s)
        assert [len(sensor.block) for sensor in (*first.sensors, *second.sensors)] == [600, 600, 899, 899]
        assert clocks(second) == clocks(trial)
        assert second.started.startswith("2026-03-09T10:00:08")
        assert "split_clocks" not in keys(second)


def test_nobody_knows_when_what_follows_a_restart_began(tmp_path: Path) -> None:
    trial = read(pair(tmp_path, (restarted(9.0), ALL), (restarted(9.0), ALL)))
    _, second = split_trial(replace(trial, started="2026-03-09T10:00:00"), 9.0)
    assert second.started == ""


def test_a_clean_recording_can_be_split_anywhere_inside_of_it(tmp_path: Path) -> None:
    trial = read(pair(tmp_path))
    first, second = split_trial(trial, 7.005)
    assert [len(sensor.block) for sensor in (*first.sensors, *second.sensors)] == [701, 701, 1299, 1299]
    assert (clocks(second), keys(second)) == (clocks(trial), keys(trial))
    for at_s in (-1.0, 25.0):
        with pytest.raises(FileRefusedError, match="no samples on one side of"):
            split_trial(trial, at_s)


def test_several_splits_leave_every_sample_in_one_part(tmp_path: Path) -> None:
    both = restarted(9.0)
    trial = read(pair(tmp_path, (both, ALL), (np.where(TIME_S >= 14.0 - 1e-9, both + 700.0, both), ALL)))
    assert [str(one.kind) for one in clock_view_of(trial).events] == ["restart", "jump"]
    parts = split_all(trial, [14.0, 9.0])
    assert [[len(sensor.block) for sensor in part.sensors] for part in parts] == [[900, 900], [500, 500], [600, 600]]
    assert [clock_view_of(part).events for part in parts] == [(), (), ()]


def test_a_split_draft_becomes_two_recordings_of_a_session(tmp_path: Path) -> None:
    trial = read(pair(tmp_path, PAUSED, PAUSED))
    (draft,) = drafts_of([("morning", trial)])
    split = split_draft(draft, 0, 8.0)
    assert [one.title for one in split.recordings] == ["morning (a)", "morning (b)"]
    sites = {one.key: one.site for one in split.sensors}
    session = session_of(split, [RecordingKind.WALKING, RecordingKind.STANDING], sites)
    assert [(one.name, one.note) for one in session.recordings] == [
        ("walk 1", "morning (a)"),
        ("standing", "morning (b)"),
    ]
    assert [len(one.imu[Site.LEFT_THIGH]) for one in session.recordings] == [600, 899]


def test_what_is_not_split_is_not_imported(tmp_path: Path) -> None:
    (draft,) = drafts_of([("morning", read(pair(tmp_path, (restarted(9.0), ALL))))])
    sites = {one.key: one.site for one in draft.sensors}
    with pytest.raises(FileRefusedError, match="goes back from"):
        session_of(draft, [RecordingKind.WALKING], sites)
