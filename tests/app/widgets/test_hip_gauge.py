"""A hip's gauge: what it reads off the heading, what would show it, and that nothing is cut."""

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.widgets.hip_gauge import HipFace, HipGauge, hip_face
from core.body import Joint
from core.live.hip_heading import HipHeadingState
from tests.app.room import words_cut


def heading(sd_deg: float, margin: float = 4.0, *, is_sure: bool = False, moved_s: float = 9.0) -> HipHeadingState:
    return HipHeadingState(1.0, 0.3, float(np.deg2rad(sd_deg)), margin, 0.05, moved_s, is_sure)


@pytest.fixture
def gauge(qtbot: QtBot) -> HipGauge:
    gauge = HipGauge(Joint.LEFT_HIP)
    qtbot.addWidget(gauge)
    gauge.resize(420, 64)
    gauge.show()
    return gauge


@pytest.mark.parametrize(
    ("found", "figure", "is_met"),
    [
        (None, "\N{EN DASH}", False),
        (heading(90.0), "\N{EN DASH}", False),
        (heading(11.2), "11", False),
        (heading(11.2, margin=1.2), "\N{EN DASH}", False),  # another heading fits as well
        (heading(6.04), "6.1", False),  # never reads as if it were enough
        (heading(4.2, is_sure=True), "4.2", True),
        (heading(7.1, is_sure=True), "7.1", True),  # it was sure, and is still sure enough
    ],
)
def test_a_hip_reads_how_sure_its_heading_is(found: HipHeadingState | None, figure: str, is_met: bool) -> None:
    face = hip_face(found)
    assert face.heading is not None
    assert (face.heading.figure, face.is_met) == (figure, is_met)
    assert (face.heading.share == 1.0) is is_met


def test_an_open_hip_names_the_motion_and_a_closed_one_does_not(gauge: HipGauge) -> None:
    gauge.show_face(hip_face(heading(11.0), is_now=True))
    assert gauge.stated == "Walk 15 s with a turn, or lunge"
    assert gauge.accessibleName() == "Left hip, heading 11°, under 6° required, Walk 15 s with a turn, or lunge"
    gauge.show_face(hip_face(heading(4.0, is_sure=True), is_now=True))
    assert not gauge.face.is_now
    assert gauge.stated == "Enough movement"


def test_a_hip_without_its_thigh_states_why(gauge: HipGauge) -> None:
    gauge.show_face(HipFace(note="No sensor on L thigh: no left hip angle."))
    assert gauge.accessibleName() == "Left hip, No sensor on L thigh: no left hip angle."


@pytest.mark.parametrize(("width", "is_compact"), [(420, False), (500, False), (330, True)])
def test_nothing_on_the_card_is_cut(gauge: HipGauge, width: int, is_compact: bool) -> None:
    gauge.set_compact(is_compact)
    gauge.resize(width, gauge.sizeHint().height())
    for face in (hip_face(None), hip_face(heading(11.0)), hip_face(heading(4.2, is_sure=True))):
        gauge.show_face(face)
        assert words_cut(gauge) == []
