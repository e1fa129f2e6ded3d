"""Parts that are spaced by the theme look the same whether they were made at a size or came to it later."""

from collections.abc import Callable

import pytest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.help.help_reader import HelpReader
from app.plots.joint_charts import JointCharts
from app.theme.current import set_scale
from app.theme.icons import Icon
from app.wizard.free_motion.page import FreeMotionPage
from app.wizard.patient.cards import LastVisitCard
from app.wizard.sensors.columns_form import ColumnsForm
from app.wizard.sensors.session_chooser import SessionChooser
from app.wizard.sensors.source_pages import NoSource
from app.wizard.standing.page import StandStillPage
from app.wizard.walking.label_chooser import LabelChooser
from app.wizard.walking.live_lanes import LiveLanes
from app.wizard.walking.live_strip import LiveStrip
from app.wizard.walking.walk_list import ActionRow


def a_topic() -> HelpReader:
    reader = HelpReader()
    reader.show_markdown("# Walking\n\nPress the space bar.\n\n- once\n- twice", "Walking")
    return reader


Make = Callable[[], QWidget]
PARTS: tuple[Make, ...] = (
    lambda: ActionRow(Icon.REPEAT, "Sensors strapped anew", "Stand still and move freely again"),
    lambda: LiveStrip((-20.0, 80.0), 20),
    ColumnsForm,
    FreeMotionPage,
    JointCharts,
    a_topic,
    LabelChooser,
    LastVisitCard,
    LiveLanes,
    NoSource,
    SessionChooser,
    StandStillPage,
)


@pytest.mark.parametrize("make", PARTS)
def test_a_part_that_another_size_reaches_later_looks_as_one_made_at_it(qtbot: QtBot, make: Make) -> None:
    reported = make()
    qtbot.addWidget(reported)
    reported.resize(900, 700)
    reported.show()
    before = reported.grab().toImage()
    set_scale(1.5)
    made = make()
    qtbot.addWidget(made)
    for part in (reported, made):
        part.resize(900, 700)
        part.show()
    qtbot.wait(20)
    for part in (reported, made):  # only one of two windows is in front, and has a ring
        if (focused := part.focusWidget()) is not None:
            focused.clearFocus()
    qtbot.waitUntil(lambda: reported.grab().toImage() == made.grab().toImage())  # layouts come later
    assert reported.grab().toImage() != before
