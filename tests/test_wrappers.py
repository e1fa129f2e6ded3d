"""Objects of Qt that end off the screen's thread are seen, and none that end on it."""

import gc
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from threading import Thread

import pytest
from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QLabel
from pytestqt.qtbot import QtBot

from tests.wrappers import Wrappers

ROOT = Path(__file__).parents[1]

PLANTED = """
from threading import Thread
from PySide6.QtCore import QObject

def test_held_last_by_another_thread():
    held = [QObject()]
    thread = Thread(target=held.clear)
    thread.start()
    thread.join()

def test_held_last_by_the_screens_thread():
    held = [QObject()]
    thread = Thread(target=held.copy)
    thread.start()
    thread.join()
"""


class Page(QLabel):
    """A class of the application's, which holds itself as pages do."""

    def __init__(self) -> None:
        super().__init__()
        self.itself = self


def run_beside(call: Callable[[], object]) -> None:
    thread = Thread(target=call, name="beside")
    thread.start()
    thread.join()


@pytest.mark.parametrize("kind", [QObject, QTimer, QLabel])
def test_what_another_thread_lets_go_last_is_seen_with_its_class_and_thread(
    qtbot: QtBot, wrappers: Wrappers, kind: type[QObject]
) -> None:
    held = [kind()]
    run_beside(held.clear)
    (ended,) = wrappers.taken()
    assert f"{kind.__name__} ended on the thread 'beside'" in ended
    assert "run_beside" not in ended
    assert wrappers.taken() == []


def test_what_the_collector_ends_on_another_thread_is_seen(qtbot: QtBot, wrappers: Wrappers) -> None:
    Page()
    run_beside(gc.collect)
    (ended,) = wrappers.taken()
    assert "Page ended on the thread 'beside'" in ended


def test_what_ends_on_the_screens_thread_is_no_fault(qtbot: QtBot, wrappers: Wrappers) -> None:
    held: list[QObject] = [QObject(), QTimer(), QLabel()]
    run_beside(held.copy)
    held.clear()
    Page()
    gc.collect()
    assert wrappers.taken() == []


@pytest.mark.endurance
def test_a_test_that_lets_another_thread_hold_it_last_fails(tmp_path: Path) -> None:
    planted = tmp_path / "test_planted.py"
    planted.write_text(PLANTED)
    options = ["-q", "-p", "tests.conftest", "-p", "no:cacheprovider", "-c", str(ROOT / "pyproject.toml")]
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", *options, f"--rootdir={tmp_path}", str(planted)],
        cwd=ROOT,
        env={**os.environ, "PYTEST_ADDOPTS": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "test_planted.py::test_held_last_by_another_thread" in ended.stdout
    assert "2 passed, 1 error" in ended.stdout
