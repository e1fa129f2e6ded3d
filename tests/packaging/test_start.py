"""Tests that `start.py` hands over to the right command and that its set-up does only what is missing."""

import importlib
import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

pytestmark = pytest.mark.skipif(os.name == "nt", reason="a Python of two lines of shell stands in for the real one")

PACKAGING = Path(__file__).parents[2] / "packaging"


@pytest.fixture
def set_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Give `setup_environment` for an empty project in `tmp_path`, with the steps it runs noted in `steps`."""
    (tmp_path / "packaging").mkdir()
    for lock in ("requirements.lock", "runtime.lock"):
        (tmp_path / "packaging" / lock).write_text(lock)
    (tmp_path / "pyproject.toml").write_text("")
    module = importlib.import_module("setup_environment")
    steps: list[str] = []

    def note(command: list[str], advice: str, **environment: str) -> None:
        steps.append(" ".join(map(str, command)))
        if command[1:3] == ["-m", "venv"]:
            _fake_python(tmp_path, "exit 0")

    for name, value in {
        "ROOT": tmp_path,
        "VENV": tmp_path / ".venv",
        "STAMP": tmp_path / ".venv" / "made-from",
        "_run_quietly": note,
        "_is_sound": lambda: (tmp_path / ".venv" / "bin" / "python").exists(),
        "missing_libraries": list,
        "can_make_environments": lambda: True,
    }.items():
        monkeypatch.setattr(module, name, value)
    monkeypatch.setattr(module, "steps", steps, raising=False)
    return module


def _fake_python(root: Path, does: str) -> None:
    python = root / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True, exist_ok=True)
    python.write_text(f"#!/bin/sh\n{does}\n")
    python.chmod(0o755)


def test_a_first_start_makes_the_environment_from_the_lock_and_the_second_does_nothing(set_up: ModuleType) -> None:
    set_up.prepare(is_screen_needed=True)
    made, locked, ours = set_up.steps
    assert " -m venv " in made
    assert "--require-hashes" in locked
    assert ours.endswith(f"--no-build-isolation --editable {set_up.ROOT}")
    set_up.steps.clear()
    set_up.prepare(is_screen_needed=True)
    assert set_up.steps == []


@pytest.mark.parametrize("changed", ["pyproject.toml", "packaging/runtime.lock"])
def test_a_changed_lock_or_project_updates_the_environment_in_place(set_up: ModuleType, changed: str) -> None:
    set_up.prepare(is_screen_needed=True)
    set_up.steps.clear()
    (set_up.ROOT / changed).write_text("another")
    set_up.prepare(is_screen_needed=True)
    assert [" -m pip " in step for step in set_up.steps] == [True, True]


def test_what_the_tests_need_is_added_where_it_is_asked_for_and_does_for_the_application(set_up: ModuleType) -> None:
    set_up.prepare(is_screen_needed=True)
    assert any(step.endswith("runtime.lock") for step in set_up.steps)
    set_up.steps.clear()
    (set_up.ROOT / "packaging" / "requirements.lock").write_text("more")
    set_up.prepare(is_screen_needed=True, lock=set_up.TESTED)
    assert any(step.endswith("requirements.lock") for step in set_up.steps)
    set_up.steps.clear()
    set_up.prepare(is_screen_needed=True)
    assert set_up.steps == []


NO_WHEEL = """\
ERROR: Could not find a version that satisfies the requirement vqf==2.1.2 (from versions: none)
ERROR: No matching distribution found for vqf==2.1.2
"""
NOT_REACHED = "WARNING: Retrying after connection broken by 'NewConnectionError'\n"


@pytest.mark.parametrize(
    ("printed", "stated"),
    [(NO_WHEEL, "vqf has no wheel for Python"), (NOT_REACHED + NO_WHEEL, ""), ("ERROR: no space left", "")],
)
def test_a_part_without_a_wheel_is_named_and_the_connection_is_not_blamed(
    set_up: ModuleType, printed: str, stated: str
) -> None:
    reported = set_up.without_wheel(printed)
    assert reported.startswith(stated)
    assert bool(reported) == bool(stated)


def test_an_environment_whose_set_up_was_cut_short_is_made_again(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    note = set_up._run_quietly

    def stop_at_pip(command: list[str], advice: str, **environment: str) -> None:
        note(command, advice)
        if "pip" in command:
            raise KeyboardInterrupt

    monkeypatch.setattr(set_up, "_run_quietly", stop_at_pip)
    with pytest.raises(set_up.SetUpError, match="Start again"):
        set_up.prepare(is_screen_needed=True)
    monkeypatch.setattr(set_up, "_run_quietly", note)
    set_up.steps.clear()
    left = set_up.VENV / "half-a-file"
    left.touch()
    set_up.prepare(is_screen_needed=True)
    assert " -m venv " in set_up.steps[0]
    assert not left.exists()


def test_an_environment_without_its_python_is_made_again(set_up: ModuleType) -> None:
    set_up.prepare(is_screen_needed=True)
    set_up.python().unlink()
    set_up.steps.clear()
    set_up.prepare(is_screen_needed=True)
    assert " -m venv " in set_up.steps[0]


def test_libraries_that_may_not_be_installed_are_reported_in_one_line_and_stop_only_what_shows_a_window(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(set_up, "missing_libraries", lambda: ["libegl1", "libgl1"])
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    with pytest.raises(set_up.SetUpError) as reported:
        set_up.prepare(is_screen_needed=True)
    assert "\n    sudo apt-get update && sudo apt-get install -y libegl1 libgl1" in str(reported.value)
    assert set_up.steps == []
    set_up.prepare(is_screen_needed=False)
    assert set_up.is_current()


def test_the_superuser_gets_the_libraries_and_what_makes_environments_in_one_step(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(set_up, "missing_libraries", lambda: ["libegl1"])
    monkeypatch.setattr(set_up, "can_make_environments", lambda: False)
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    set_up.prepare(is_screen_needed=False)
    assert set_up.steps[0].endswith(f"libegl1 python3.{sys.version_info[1]}-venv")
    assert " -m venv " in set_up.steps[1]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the start script beside a finished environment, whose Python states how it was called."""
    shutil.copytree(PACKAGING, tmp_path / "packaging", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(PACKAGING.parent / "pyproject.toml", tmp_path)
    _fake_python(tmp_path, 'echo "called $*"; exit "${CODE:-0}"')
    program = "import setup_environment as s; s.STAMP.write_text(s.fingerprint())"
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path / "packaging", check=True)
    return tmp_path


def start(project: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, project / "packaging" / "start.py", *arguments],
        cwd=project,
        env={"PATH": "", **environment},  # no apt-get: a test installs nothing
        capture_output=True,
        text=True,
        check=False,
    )


def test_without_a_screen_the_demonstration_runs_and_its_place_is_reported(project: Path) -> None:
    done = start(project)
    assert done.stdout == "called -P -m app demo\n"
    assert str(project / "gaitwright-demo") in done.stderr
    assert done.returncode == 0


def test_a_subcommand_and_its_exit_code_are_passed_on(project: Path) -> None:
    done = start(project, "analyse", "my session", "--out", "x", CODE="3")
    assert done.stdout == "called -P -m app analyse my session --out x\n"
    assert done.returncode == 3


def test_with_a_screen_the_window_opens(set_up: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module("start")
    called: list[list[str]] = []

    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(module, "hand_over", called.append)
    module.main([])
    assert called == [[str(set_up.python()), "-P", "-m", "app"]]


def test_from_a_folder_that_may_not_be_written_a_copy_of_the_users_runs(
    set_up: ModuleType, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert set_up.copied_to_user() is None
    home = tmp_path_factory.mktemp("home")
    monkeypatch.setenv("XDG_DATA_HOME", str(home))
    monkeypatch.setattr(set_up.os, "access", lambda path, mode: (path, mode) != (set_up.ROOT, os.W_OK))
    (set_up.ROOT / "app").mkdir()
    for name in ("app/old.py", "app/new.py"):
        (set_up.ROOT / name).write_text("1")
        (set_up.ROOT / name).chmod(0o444)
    copy = set_up.copied_to_user()
    assert (copy / "app" / "new.py").stat().st_mode & 0o200
    (copy / ".venv").mkdir()
    (set_up.ROOT / "app" / "old.py").unlink()
    (set_up.ROOT / "app" / "new.py").chmod(0o644)
    (set_up.ROOT / "app" / "new.py").write_text("22")
    assert set_up.copied_to_user() == copy
    assert copy.is_relative_to(home)
    assert {one.relative_to(copy).as_posix() for one in copy.rglob("*") if one.is_file()} == {
        *("app/new.py", "packaging/requirements.lock", "packaging/runtime.lock", "pyproject.toml")
    }
    assert (copy / "app" / "new.py").read_text() == "22"
    assert (copy / ".venv").is_dir()
