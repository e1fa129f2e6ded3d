"""Does the pinned PySide6 keep its hands off the reference count of None?

PySide6 6.12.0 on Python 3.11 gives away one reference to None, True or False at every call that returns one; a live
plot then aborts within seconds.
"""

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
