"""Tests that the pinned PySide6 leaves the reference count of None alone and makes each class once.

PySide6 6.12.0 on Python 3.11 gives away one reference to None, True or False at every call that returns one; a live
plot then aborts within seconds. 6.11 makes a class when it is first asked for: two threads that ask at once get two of
it ("isn't a direct base class of"), or wait for each other for ever.
"""

import subprocess
import sys

import pytest
from pyqtgraph import PlotDataItem
from PySide6.QtWidgets import QLabel
from pytestqt.qtbot import QtBot

CALLS = 300


@pytest.mark.skipif(sys.version_info >= (3, 12), reason="None is immortal from Python 3.12 on, its count says nothing")
def test_calls_into_qt_do_not_use_up_none(qtbot: QtBot) -> None:
    label, curve = QLabel(), PlotDataItem()
    qtbot.addWidget(label)
    label.setText("first")  # whatever the first call keeps for good
    before = sys.getrefcount(None)
    for count in range(CALLS):
        label.setText(str(count))
        label.update()
        curve.setPen(None)
    assert sys.getrefcount(None) > before - CALLS // 10


def test_the_application_has_every_class_made_before_a_thread_asks() -> None:
    asked = "import app; from PySide6 import QtGui, QtWidgets; print({*dir(QtWidgets)} - {*vars(QtWidgets)} or 'all')"
    ended = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == "all"
