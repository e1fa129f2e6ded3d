"""A viewer of Rerun's that closes at once is stated, with its reason; one that stays, or that is closed, is not."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QObject
from pytestqt.qtbot import QtBot

from app.wizard import reviewing
from app.wizard.reviewing import Reviewing
from tests.app.review.test_viewer import EMPTY, stand_in, wait_for

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the stand-in for the viewer is a script")


@pytest.fixture
def review(qapp: QObject, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Reviewing]:
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(reviewing, "default_root", lambda: tmp_path / "review")
    monkeypatch.setattr(reviewing, "LOOK_EVERY_MS", 20)
    parent = QObject()
    found = Reviewing(parent)
    yield found
    found.finish()
    parent.deleteLater()


def test_a_viewer_that_closes_at_once_is_stated_with_its_reason(
    qtbot: QtBot, review: Reviewing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reviewing, "viewer_program", lambda: stand_in(tmp_path, ends=True)[0])
    with qtbot.waitSignal(review.refused) as reported:
        review.show(*EMPTY)
    reason = "no screen at \N{HORIZONTAL ELLIPSIS} Failed to open"
    assert reported.args[0] == f"Rerun closed with an error: {reason}."


def test_of_a_viewer_that_stays_nothing_is_stated(
    qtbot: QtBot, review: Reviewing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program, seen = stand_in(tmp_path)
    monkeypatch.setattr(reviewing, "viewer_program", lambda: program)
    reported: list[str] = []
    review.refused.connect(lambda what, _then: reported.append(what))
    review.show(*EMPTY)
    wait_for(seen)
    qtbot.wait(100)
    review.finish()
    assert reported == []
