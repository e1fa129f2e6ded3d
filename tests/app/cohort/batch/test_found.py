"""Session folders are found however deep they are, and each has a name of its own."""

from pathlib import Path

import pytest

from app.cohort.batch.found import find_sessions
from devices.files.refusal import FileRefusedError


def make(folder: Path, *places: str) -> None:
    for place in places:
        (folder / place).mkdir(parents=True)
        (folder / place / "session.toml").touch()


def names(folder: Path) -> dict[str, str]:
    return {one.folder.relative_to(folder).as_posix(): one.name for one in find_sessions(folder, folder / "out")}


def test_a_session_is_called_as_its_folder_however_deep_it_is(tmp_path: Path) -> None:
    make(tmp_path, "b", "a/deep/down", "a/walk one")
    assert names(tmp_path) == {"b": "b", "a/deep/down": "down", "a/walk one": "walk one"}


def test_a_folder_that_is_a_session_itself_is_one(tmp_path: Path) -> None:
    make(tmp_path, "visit")
    assert [one.name for one in find_sessions(tmp_path / "visit", tmp_path / "out")] == ["visit"]


def test_recordings_inside_their_results_are_called_as_these(tmp_path: Path) -> None:
    make(tmp_path, "demo/session", "plain/session")
    (tmp_path / "demo" / "summary.json").touch()
    assert names(tmp_path) == {"demo/session": "demo", "plain/session": "session"}


def test_sessions_of_one_name_are_reported_by_their_paths(tmp_path: Path) -> None:
    make(tmp_path, "a/visit", "b/Visit", "other")
    assert names(tmp_path) == {"a/visit": "a-visit", "b/Visit": "b-Visit", "other": "other"}
    assert [one.shares_name for one in find_sessions(tmp_path, tmp_path / "out")] == [True, True, False]


def test_names_stay_apart_where_the_path_as_a_name_is_taken_too(tmp_path: Path) -> None:
    make(tmp_path, "a/visit", "b/visit", "a-visit", "failures.csv", "x/y-visit", "x-y/visit")
    found = names(tmp_path)
    assert len({name.casefold() for name in found.values()}) == len(found) == 6
    assert found["b/visit"] == "b-visit"
    assert found["failures.csv"].startswith("failures.csv-")


def test_the_batch_itself_and_what_is_hidden_is_not_looked_into(tmp_path: Path) -> None:
    make(tmp_path, "visit", "out/old/session", ".trash/gone", "visit/nested")
    assert names(tmp_path) == {"visit": "visit"}


def test_a_folder_without_a_session_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileRefusedError, match="there is no session folder in it"):
        find_sessions(tmp_path, tmp_path / "out")
