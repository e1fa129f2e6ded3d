"""Tests that the log is shown to this user alone, on this computer alone, and is gone afterwards."""

import os
import stat
import sys
import time
from pathlib import Path

import pytest

from app.review.viewer import Viewer, ViewerRefusedError, viewer_program, why_not
from core.results import Analysis, Method
from core.session import Session

EMPTY = Session(()), Analysis(Method.ROBUST, False, (), ())
STAND_IN = """#!{python}
import json, os, pathlib, sys, time
if sys.argv[1] == "analytics":
    pathlib.Path(os.environ["XDG_CONFIG_HOME"], "analytics").write_text(sys.argv[2])
elif {ends}:
    print("Listening", file=sys.stderr)
    print("\\x1b[31mError: no screen at /usr/jane/x.rs:78: Failed to open\\x1b[0m", file=sys.stderr)
    sys.exit(101)
else:
    told = {{"argv": sys.argv[1:], "bytes": len(pathlib.Path(sys.argv[-1]).read_bytes())}}
    pathlib.Path({seen!r}).write_text(json.dumps(told))
    time.sleep(60)
"""

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the stand-in for the viewer is a script")


def stand_in(folder: Path, *, ends: bool = False) -> tuple[Path, Path]:
    """Make a program that stays until it is ended, and the file into which it writes how it was called."""
    program, seen = folder / "rerun", folder / "seen.json"
    program.write_text(STAND_IN.format(python=sys.executable, seen=str(seen), ends=ends))
    program.chmod(0o700)
    return program, seen


def wait_for(path: Path) -> str:
    until = time.monotonic() + 20
    while not (path.exists() and path.read_text()):
        assert time.monotonic() < until, f"{path} never came"
        time.sleep(0.02)
    return path.read_text()


@pytest.fixture(autouse=True)
def _screen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DISPLAY", ":0")


def test_it_is_shown_on_this_computer_only_from_a_folder_of_this_user_only(tmp_path: Path) -> None:
    program, seen = stand_in(tmp_path)
    viewer, root = Viewer(tmp_path / "review", program), tmp_path / "review"
    viewer.open(*EMPTY)
    reported = wait_for(seen)
    for part in ('"--bind", "127.0.0.1"', '"--memory-limit", "2GB"'):
        assert part in reported
    (folder,) = [path for path in root.iterdir() if path.is_dir()]
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    (log,) = folder.glob("*.rrd")
    assert f'"{log}"' in reported
    assert f'"bytes": {log.stat().st_size}' in reported
    assert (folder / "settings" / "analytics").read_text() == "disable"
    viewer.close()
    assert list(root.iterdir()) == []


def test_closing_ends_the_viewer(tmp_path: Path) -> None:
    program, seen = stand_in(tmp_path)
    viewer = Viewer(tmp_path / "review", program)
    viewer.open(*EMPTY)
    wait_for(seen)
    (process,) = viewer._shown.values()
    viewer.close()
    assert process.poll() is not None


@pytest.mark.endurance
def test_what_an_ended_run_left_is_removed_and_what_another_window_shows_is_not(tmp_path: Path) -> None:
    root = tmp_path / "review"
    (root / "run-killed").mkdir(parents=True)
    (root / "run-killed" / "session.rrd").write_text("a patient's angles")
    program, seen = stand_in(tmp_path)
    one, other = Viewer(root, program), Viewer(root, program)
    one.open(*EMPTY)
    assert not (root / "run-killed").exists()
    wait_for(seen)
    other.open(*EMPTY)
    assert len([path for path in root.iterdir() if path.is_dir()]) == 2
    other.close()
    assert len(list(root.glob("run-*/session-*.rrd"))) == 1
    one.close()


def test_a_viewer_that_fails_is_reported_and_its_log_removed(tmp_path: Path) -> None:
    program, _ = stand_in(tmp_path, ends=True)
    viewer = Viewer(tmp_path / "review", program)
    viewer.open(*EMPTY)
    (process,) = viewer._shown.values()
    process.wait(20)
    assert viewer.failures() == ["no screen at \N{HORIZONTAL ELLIPSIS} Failed to open"]
    assert viewer.failures() == []
    assert list((tmp_path / "review").rglob("*.rrd*")) == []
    viewer.close()


def test_without_a_viewer_or_a_screen_a_sentence_states_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ViewerRefusedError, match="not installed"):
        Viewer(tmp_path, None).open(*EMPTY)
    monkeypatch.delenv("DISPLAY")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    assert why_not(tmp_path).startswith(
        "Rerun needs a display, and there is none here. Open session.rrd from the results"
    )
    with pytest.raises(ViewerRefusedError, match="rrd from the results on a computer with a display"):
        Viewer(tmp_path, tmp_path / "rerun").open(*EMPTY)
    assert list(tmp_path.iterdir()) == []


def test_a_viewer_that_does_not_start_is_reported(tmp_path: Path) -> None:
    viewer = Viewer(tmp_path / "review", tmp_path / "missing")
    with pytest.raises(ViewerRefusedError, match="could not be started"):
        viewer.open(*EMPTY)
    viewer.close()
    assert list((tmp_path / "review").iterdir()) == []


def test_the_viewer_that_comes_with_the_library_is_found() -> None:
    program = viewer_program()
    assert program is not None
    assert os.access(program, os.X_OK)
