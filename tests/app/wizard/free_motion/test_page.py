"""The free motion on the page: what is stated aloud, what is painted again, and how it is laid out."""

import time
from dataclasses import replace

import pytest
from PySide6.QtCore import QEvent, QObject
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QAccessibleEvent
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.widgets.gauge import Gauge, GaugeFace, GaugeMeasure, GaugeState
from app.widgets.hint import Hint
from app.widgets.hip_gauge import hip_face
from app.wizard.free_motion.page import FreeMotionFace, FreeMotionPage
from core.body import LEG_JOINTS, Joint, Site
from tests.app.layout_items import item_of, items_held
from tests.app.room import words_cut


def measure(figure: str, unit: str = "°", share: float = 0.4) -> GaugeMeasure:
    return GaugeMeasure(figure, unit, f"1.5{unit}", share, is_met=False)


def face(figure: str = "11", share: float = 0.4, state: GaugeState = GaugeState.OPEN) -> GaugeFace:
    return GaugeFace(state, measure(figure, share=share), measure("34", "mm"))


def view(**faces: GaugeFace) -> FreeMotionFace:
    gauges = {joint: faces.get(joint.value, face()) for joint in LEG_JOINTS}
    return FreeMotionFace(gauges, Hint("Circle the left lower leg", "Change direction."), 7.3, Site.LEFT_SHANK)


@pytest.fixture
def page(qtbot: QtBot, qapp: QApplication) -> FreeMotionPage:
    page = FreeMotionPage()
    qtbot.addWidget(page)
    page.resize(1064, 600)
    with qtbot.waitExposed(page):
        page.show()
    page.show_state(view())
    QApplication.processEvents()
    return page


@pytest.fixture
def announced(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    stated: list[str] = []

    def note(event: QAccessibleEvent) -> None:
        if isinstance(event, QAccessibleAnnouncementEvent):
            stated.append(event.message())

    monkeypatch.setattr(QAccessible, "updateAccessibility", note)
    return stated


def test_gauges_lie_as_the_patient_faces_you(page: FreeMotionPage) -> None:
    at = {joint: gauge.geometry().center() for joint, gauge in page.gauges.items()}
    assert at[Joint.RIGHT_KNEE].x() < page.figure.geometry().center().x() < at[Joint.LEFT_KNEE].x()
    assert at[Joint.LEFT_KNEE].y() < at[Joint.LEFT_ANKLE].y()


def test_where_there_is_little_room_the_figure_goes(page: FreeMotionPage) -> None:
    page.set_compact(True)
    page.resize(736, 388)
    QApplication.processEvents()
    assert page.figure.isHidden()
    assert page.minimumSizeHint().height() <= 388
    assert all(gauge.width() > 300 for gauge in page.gauges.values())


def test_a_hint_is_stated_aloud_only_when_its_sentence_changes(page: FreeMotionPage, announced: list[str]) -> None:
    page.band.show_hint(Hint("Bend the left knee", "Moving it by hand is fine"))
    page.band.show_hint(Hint("Bend the left knee", "The therapist moves the limb."))
    page.band.show_hint(Hint("Bend the right knee", "Moving it by hand is fine"))
    assert announced == [
        "Bend the left knee. Moving it by hand is fine",
        "Bend the right knee. Moving it by hand is fine",
    ]


class Paints(QObject):
    """Notes which of the watched widgets are painted."""

    def __init__(self, page: FreeMotionPage) -> None:
        super().__init__()
        self.painted: list[Joint] = []
        self._joints = {gauge: joint for joint, gauge in page.gauges.items()}
        for gauge in self._joints:
            gauge.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() is QEvent.Type.Paint and isinstance(watched, Gauge):
            self.painted.append(self._joints[watched])
        return False


def test_only_the_gauge_that_reads_otherwise_is_painted(page: FreeMotionPage) -> None:
    paints = Paints(page)
    page.show_state(view(left_knee=face("9.4")))
    QApplication.processEvents()
    page.show_state(view(left_knee=face("9.4")))
    QApplication.processEvents()
    assert paints.painted == [Joint.LEFT_KNEE]


def test_what_the_motion_contradicts_is_asked_in_the_page(qtbot: QtBot, page: FreeMotionPage) -> None:
    page.question.ask(
        "Left thigh and shank seem swapped.", "Swap them, or keep the positions.", ("Swap them", "Keep positions")
    )
    assert page.question.isVisible()
    for number, button in enumerate(page.question.buttons):
        with qtbot.waitSignal(page.question.answered) as answered:
            button.click()
        assert answered.args == [number]
    page.question.ask("")
    assert page.question.isHidden()


def test_a_frame_in_which_all_four_gauges_move_is_painted_in_time(page: FreeMotionPage) -> None:
    taken_ms = []
    for count in range(20):
        page.show_state(view(**{joint.value: face(f"{count}", share=count / 30) for joint in LEG_JOINTS}))
        began = time.perf_counter()
        QApplication.processEvents()
        taken_ms.append(1000 * (time.perf_counter() - began))
    assert sorted(taken_ms)[5] < 30  # ten times a second leaves 100; a busy machine is no reason to fail


def test_turned_round_it_leaves_no_layout_item_behind(page: FreeMotionPage) -> None:
    page.set_from_behind(True)
    held = items_held()
    assert not held & {item_of(gauge, page._grid) for gauge in page.gauges.values()}


HIPS = {Joint.LEFT_HIP: hip_face(None), Joint.RIGHT_HIP: hip_face(None)}


def test_hips_stand_above_the_knees_only_where_the_pelvis_wears_a_sensor(page: FreeMotionPage) -> None:
    before = page.grab().toImage()
    page.show_state(replace(view(), hips=HIPS))
    QApplication.processEvents()
    at = {joint: hip.geometry() for joint, hip in page.hips.items()}
    assert at[Joint.RIGHT_HIP].right() < at[Joint.LEFT_HIP].left()
    assert at[Joint.RIGHT_HIP].bottom() < page.gauges[Joint.RIGHT_KNEE].y()
    page.set_from_behind(True)
    QApplication.processEvents()
    assert page.hips[Joint.LEFT_HIP].x() < page.hips[Joint.RIGHT_HIP].x()
    page.set_from_behind(False)
    page.show_state(view())
    QApplication.processEvents()
    assert page.grab().toImage() == before


@pytest.mark.parametrize(
    ("size", "is_compact"), [((1064, 600), False), ((1064, 520), False), ((896, 420), True), ((736, 388), True)]
)
def test_six_gauges_have_their_room(page: FreeMotionPage, size: tuple[int, int], is_compact: bool) -> None:
    page.show_state(replace(view(), hips=HIPS))
    page.set_compact(is_compact)
    page.resize(*size)
    QApplication.processEvents()
    assert page.minimumSizeHint().height() <= size[1]
    assert words_cut(page) == []
