"""The notice: its icon is beside the first line, however much room there is."""

import numpy as np
import pytest
from PySide6.QtGui import QImage
from pytestqt.qtbot import QtBot

from app.theme.icons import Icon
from app.widgets.notice import ICON, PADDING, Notice
from core.samples import FloatArray

LINE = 20  # px, the height of a line of size 16


def ink(notice: Notice) -> FloatArray:
    """How dark each pixel is; 0: ground."""
    image = notice.grab().toImage().convertToFormat(QImage.Format.Format_Grayscale8)
    grey = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())[:, : image.width()]
    dark: FloatArray = np.abs(grey.astype(float) - float(grey[0, 0]))
    return dark


def middle_of(rows: FloatArray) -> float:
    inked = np.flatnonzero(rows.max(axis=1) > 60)
    return float(inked[0] + inked[-1]) / 2


@pytest.mark.parametrize("height", [44, 66, 120])
@pytest.mark.parametrize("then", ["", "Drop it here."])
def test_the_icon_is_beside_the_first_line(qtbot: QtBot, height: int, then: str) -> None:
    notice = Notice(size=16)
    qtbot.addWidget(notice)
    notice.show_message(Icon.CHECK, "All six sensors are assigned and connected.", then)
    notice.resize(500, max(height, notice.minimumSizeHint().height()))
    notice.show()
    dark = ink(notice)
    icon = middle_of(dark[:, : PADDING + ICON])
    words = dark[:, PADDING + ICON + 8 :]
    first = words[: int(np.flatnonzero(words.max(axis=1) > 60)[0]) + LINE]
    assert icon == pytest.approx(middle_of(first), abs=4.0)
