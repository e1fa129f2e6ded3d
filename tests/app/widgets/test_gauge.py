"""A gauge as it reads the excitation of a joint: figures without floors, rings that close, and words beside them."""

import math
from dataclasses import replace
from itertools import combinations, pairwise
from typing import ClassVar

import pytest
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.widgets import gauge as gauge_module
from app.widgets.gauge import Gauge, GaugeFace, GaugeState, gauge_face, two_digits
from app.wording.translation import use_language
from core.body import Joint
from core.live.excitation import HUMAN, PROSTHESIS, ExcitationState


def state(axis_deg: float, centre_mm: float, floor_deg: float = 4.0, **reported: bool) -> ExcitationState:
    return ExcitationState(
        axis_sd_rad=math.radians(axis_deg),
        centre_sd_m=centre_mm / 1000,
        axis_sd_with_floor_rad=math.radians(math.hypot(axis_deg, floor_deg)),
        centre_sd_with_floor_m=centre_mm / 1000,
        sign_margin=2.0,
        wanting=1.0,
        is_closed=reported.get("is_closed", False),
        is_plateau=reported.get("is_plateau", False),
        trend=0.5,
        missing=None,
        moved_s=5.0,
    )


@pytest.mark.parametrize(("value", "written"), [(0.84, "0.8"), (9.94, "9.9"), (9.96, "10"), (11.4, "11"), (2.0, "2.0")])
def test_figures_have_two_digits(value: float, written: str) -> None:
    assert two_digits(value) == written


@pytest.mark.parametrize(
    ("value", "required", "written"), [(1.52, 1.5, "1.6"), (1.5, 1.5, "1.5"), (1.7, 1.5, "1.7"), (10.3, 10.0, "11")]
)
def test_what_is_not_yet_as_required_does_not_read_as_if_it_were(value: float, required: float, written: str) -> None:
    assert two_digits(value, required) == written


def test_in_german_a_figure_and_what_is_required_have_a_comma() -> None:
    use_language("de")
    try:
        face = gauge_face(Joint.LEFT_KNEE, state(3.84, 6.2), HUMAN, is_now=True)
        assert face.axis is not None
        assert (face.axis.figure, face.axis.required) == ("3,8", "1,5°")
        assert (two_digits(1.52, 1.5), two_digits(10.3, 10.0)) == ("1,6", "11")
    finally:
        use_language("en")


def test_a_ring_closes_by_as_much_with_each_halving() -> None:
    shares = []
    for axis_deg in (24.0, 12.0, 6.0, 3.0):
        axis = gauge_face(Joint.LEFT_KNEE, state(axis_deg, 50), HUMAN, is_now=True).axis
        assert axis is not None
        shares.append(axis.share)
    steps = [b - a for a, b in pairwise(shares)]
    assert steps == pytest.approx([math.log(2) / math.log(20)] * 3, abs=1 / 180)
    assert 0 < shares[0] < shares[-1] < 1


def test_an_open_ring_never_looks_closed() -> None:
    axis = gauge_face(Joint.LEFT_KNEE, state(1.5001, 50), HUMAN, is_now=False).axis
    assert axis is not None
    assert axis.share < 1.0
    assert not axis.is_met


def test_a_face_has_the_figures_rings_and_state_of_its_joint(snapshot: SnapshotAssertion) -> None:
    """The axis of an ankle is found while walking: nothing here has judged it."""
    knee, ankle = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
    loose, firm = (state(0.4, 4, floor_deg=floor_deg, is_closed=True) for floor_deg in (6.0, 0.6))
    uncertain = state(11, 4, floor_deg=0.6, is_plateau=True)
    plateau = state(3.8, 8, is_plateau=True)
    assert {
        "a knee has both rings, figures without floors": gauge_face(
            knee, state(0.8, 6.2, is_closed=True), HUMAN, is_now=False
        ),
        "an ankle has its centre only": gauge_face(ankle, state(20, 18), HUMAN, is_now=False),
        "of an ankle it is enough for the centre": gauge_face(ankle, state(20, 6, is_closed=True), HUMAN, is_now=False),
        "of a knee for both": gauge_face(knee, state(20, 6, is_closed=True), HUMAN, is_now=False),
        "a human knee": gauge_face(knee, state(1.0, 6), HUMAN, is_now=False),
        "more is required of a prosthesis": gauge_face(knee, state(1.0, 6, floor_deg=0.15), PROSTHESIS, is_now=False),
        "not known": gauge_face(knee, None, HUMAN, is_now=False),
        "hardly known": gauge_face(knee, state(57, 250), HUMAN, is_now=False),
        "a plateau keeps its figure and its open ring": gauge_face(knee, plateau, HUMAN, is_now=False),
        "a plateau, once more": gauge_face(knee, plateau, HUMAN, is_now=True),
        "a prosthesis that turns like no hinge": gauge_face(knee, loose, PROSTHESIS, is_now=False),
        "a human knee may": gauge_face(knee, loose, HUMAN, is_now=False),
        "a prosthesis that is a hinge": gauge_face(knee, firm, PROSTHESIS, is_now=False),
        "an uncertain axis is no loose hinge": gauge_face(knee, uncertain, PROSTHESIS, is_now=False),
        "nor one of an ankle": gauge_face(ankle, uncertain, PROSTHESIS, is_now=False),
        "of an ankle's hinge nothing before its axis is known": gauge_face(
            ankle, state(20, 4, floor_deg=6.0, is_closed=True), PROSTHESIS, is_now=False
        ),
    } == snapshot


def test_a_gauge_is_reported_to_readers_of_screens(qtbot: QtBot, snapshot: SnapshotAssertion) -> None:
    def received(joint: Joint, face: GaugeFace) -> str:
        gauge = Gauge(joint)
        qtbot.addWidget(gauge)
        gauge.show_face(face)
        return gauge.accessibleName()

    enough = state(1, 6, is_closed=True)
    knee, ankle = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
    nothing = gauge_face(knee, None, HUMAN, is_now=False)
    assert {
        "now": received(knee, gauge_face(knee, state(11, 34), HUMAN, is_now=True)),
        "absent": received(knee, GaugeFace(GaugeState.ABSENT, note="No foot sensor: no left ankle angle.")),
        "an ankle states what is judged of it": received(ankle, gauge_face(ankle, enough, HUMAN, is_now=False)),
        "a knee": received(knee, gauge_face(knee, enough, HUMAN, is_now=False)),
        "its sensor is elsewhere": received(
            knee, replace(nothing, state=GaugeState.NEEDS, note="Needs the left shank sensor")
        ),
    } == snapshot


class Recorder(QPainter):
    """A painter that notes what is written where, in the place that the words themselves take."""

    written: ClassVar[list[tuple[str, QRectF]]] = []
    round: ClassVar[list[QRectF]] = []

    def drawEllipse(self, place: QRectF) -> None:  # type: ignore[override]  # noqa: N802  the form that rings use
        self.round.append(QRectF(place))
        super().drawEllipse(place)

    def drawText(self, place: QRectF, flags: Qt.AlignmentFlag | Qt.TextFlag | int, text: str) -> None:  # type: ignore[override]  # noqa: N802  the only form that a gauge uses
        box = self.boundingRect(place, int(flags), text)
        leading = 0.2 * self.fontMetrics().height()  # of a line, above and below its letters
        self.written.append((text, box.adjusted(0, leading, 0, -leading)))
        super().drawText(place, int(flags), text)


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("joint", [Joint.LEFT_KNEE, Joint.RIGHT_ANKLE])
def test_no_words_of_a_card_lie_on_others_however_low_it_is(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, language: str, joint: Joint
) -> None:
    monkeypatch.setattr(gauge_module, "QPainter", Recorder)
    use_language(language)
    gauge = Gauge(joint)
    qtbot.addWidget(gauge)
    states = [one for one in GaugeState if one is not GaugeState.ABSENT]
    face = gauge_face(joint, state(1.4, 23.0), HUMAN, is_now=False)
    forms = set()
    try:
        for height in (112, 130, 150, 160, 172, 190, 210):
            for shown in states:
                gauge.resize(392, height)
                gauge.show_face(replace(face, state=shown))
                Recorder.written = []
                gauge.grab()
                forms.add(gauge.is_brief)
                pairs = combinations([one for one in Recorder.written if one[0]], 2)
                assert [(a, b) for (a, one), (b, other) in pairs if one.intersects(other)] == [], (height, shown)
    finally:
        use_language("en")
    assert forms == {False, True}


@pytest.mark.parametrize("size", [(400, 210), (400, 186), (640, 340)])
@pytest.mark.parametrize("joint", [Joint.LEFT_KNEE, Joint.RIGHT_KNEE])
def test_words_never_enter_the_ring(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, joint: Joint, size: tuple[int, int]
) -> None:
    monkeypatch.setattr(gauge_module, "QPainter", Recorder)
    gauge = Gauge(joint)
    qtbot.addWidget(gauge)
    gauge.resize(*size)
    assert not gauge.is_brief
    for shown in set(GaugeState) - {GaugeState.ABSENT}:
        gauge.show_face(replace(gauge_face(joint, state(1.4, 23.0), HUMAN, is_now=False), state=shown, note="Needs it"))
        Recorder.written, Recorder.round = [], []
        gauge.grab()
        ring = max(Recorder.round, key=QRectF.width)
        inside = {text for text, box in Recorder.written if text and box.intersects(ring)}
        figure = {"1.4°", "23 mm"}
        assert inside == figure, shown
