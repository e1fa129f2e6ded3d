"""Tests that a test that fails beside others gets one more chance by itself, and that a broken one gets no more."""

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import pytest

PACKAGING = Path(__file__).parents[2] / "packaging"
LOAD = """
from pathlib import Path

def test_that_needs_a_quiet_computer():
    begun = Path(__file__).with_name("begun")
    if not begun.exists():
        begun.touch()
        raise AssertionError
"""


@pytest.fixture
def running(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")  # each takes its time in three processes of a test
    spec = spec_from_file_location("running", PACKAGING / "test.py")  # Python has a module `test` of its own
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _tested(running: ModuleType, tmp_path: Path, tests: str) -> int:
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    (tmp_path / "conftest.py").write_text("from tests.crashed import pytest_handlecrashitem\n")
    (tmp_path / "test_it.py").write_text(tests)
    call = [sys.executable, "-m", "pytest", "-q", "-p", "xdist", "--numprocesses=1", str(tmp_path)]
    code: int = running.tested(call, tmp_path / ".pytest_cache")
    return code


def test_what_fails_beside_others_alone_passes_and_is_named(
    running: ModuleType, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert _tested(running, tmp_path, LOAD) == 0
    stated = capfd.readouterr().err
    assert "Failed beside others and passed by itself: test_it.py::test_that_needs_a_quiet_computer" in stated


def test_what_is_broken_fails_and_only_what_failed_runs_again(
    running: ModuleType, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    broken = "\ndef test_broken():\n    assert False\n\ndef test_sound():\n    pass\n"
    assert _tested(running, tmp_path, LOAD + broken) == 1
    shown = capfd.readouterr()
    assert "2 failed, 1 passed" in shown.out
    assert "1 failed, 1 passed" in shown.out
    assert "test_broken" not in shown.err


def test_a_run_without_failure_runs_once(
    running: ModuleType, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert _tested(running, tmp_path, "def test_sound():\n    pass\n") == 0
    assert "once more" not in capfd.readouterr().err


def test_more_failures_than_a_busy_computer_makes_do_not_run_again(
    running: ModuleType, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    many = "import pytest\n@pytest.mark.parametrize('k', range(6))\ndef test_broken(k):\n    assert False\n"
    assert _tested(running, tmp_path, many) == 1
    assert "once more" not in capfd.readouterr().err


def test_a_crash_is_no_matter_of_a_busy_computer(
    running: ModuleType, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    crashing = LOAD.replace("raise AssertionError", "__import__('os').abort()").replace("quiet", "sound")
    assert _tested(running, tmp_path, crashing.replace("begun", "crashed") + LOAD) == 1
    assert "once more" not in capfd.readouterr().err


def test_a_run_in_one_process_is_pytests_alone(running: ModuleType) -> None:
    assert [running.is_beside_others([f"--numprocesses={count}"]) for count in range(3)] == [False, True, True]


def test_no_test_found_is_not_a_failure(running: ModuleType, tmp_path: Path) -> None:
    assert _tested(running, tmp_path, "") == 5
