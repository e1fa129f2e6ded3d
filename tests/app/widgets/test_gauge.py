"""A gauge as it reads the excitation of a joint: figures without floors, rings that close, and words beside them."""

import math
from dataclasses import replace
from itertools import combinations, pairwise
from typing import ClassVar

import pytest
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter
from pytestqt.qtbot import QtBot

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


def test_a_knee_has_both_rings_and_shows_figures_without_floors() -> None:
    face = gauge_face(Joint.LEFT_KNEE, state(0.8, 6.2, floor_deg=4.0, is_closed=True), HUMAN, is_now=False)
    assert face.state is GaugeState.ENOUGH
    assert face.axis is not None
    assert face.centre is not None
    assert (face.axis.figure, face.axis.required, face.axis.share) == ("0.8", "1.5°", 1.0)
    assert (face.centre.figure, face.centre.required, face.centre.share) == ("6.2", "10 mm", 1.0)


def test_an_ankle_has_its_centre_only() -> None:
    face = gauge_face(Joint.LEFT_ANKLE, state(20, 18), HUMAN, is_now=False)
    assert face.axis is None
    assert face.centre is not None
    assert face.centre.figure == "18"


def test_of_an_ankle_the_motion_is_enough_for_its_centre_only() -> None:
    """Its axis is found while walking: nothing here has judged it."""
    found = state(20, 6, is_closed=True)
    assert gauge_face(Joint.LEFT_ANKLE, found, HUMAN, is_now=False).state is GaugeState.CENTRE
    assert gauge_face(Joint.LEFT_KNEE, found, HUMAN, is_now=False).state is GaugeState.ENOUGH


def test_a_ring_closes_by_as_much_with_each_halving() -> None:
    shares = []
    for axis_deg in (24.0, 12.0, 6.0, 3.0):
        axis = gauge_face(Joint.LEFT_KNEE, state(axis_deg, 50), HUMAN, is_now=True).axis
        assert axis is not None
        shares.append(axis.share)
    steps = [b - a for a, b in pairwise(shares)]
    assert steps == pytest.approx([math.log(2) / math.log(20)] * 3, abs=1 / 180)
    assert 0 < shares[0] < shares[-1] < 1


def test_more_is_required_of_a_prosthesis() -> None:
    human = gauge_face(Joint.LEFT_KNEE, state(1.0, 6), HUMAN, is_now=False)
    hinge = gauge_face(Joint.LEFT_KNEE, state(1.0, 6, floor_deg=0.15), PROSTHESIS, is_now=False)
    assert human.axis is not None
    assert human.axis.is_met
    assert hinge.axis is not None
    assert hinge.centre is not None
    assert (hinge.axis.is_met, hinge.axis.required, hinge.centre.required) == (False, "0.5°", "5 mm")


def test_an_open_ring_never_looks_closed() -> None:
    axis = gauge_face(Joint.LEFT_KNEE, state(1.5001, 50), HUMAN, is_now=False).axis
    assert axis is not None
    assert axis.share < 1.0
    assert not axis.is_met


def test_what_is_not_known_yet_is_a_dash() -> None:
    for found in (None, state(57, 250)):
        face = gauge_face(Joint.LEFT_KNEE, found, HUMAN, is_now=False)
        assert face.axis is not None
        assert (face.axis.figure, face.axis.share) == ("\N{EN DASH}", 0.0)


def test_a_plateau_keeps_its_figure_and_its_open_ring() -> None:
    face = gauge_face(Joint.LEFT_KNEE, state(3.8, 8, is_plateau=True), HUMAN, is_now=False)
    assert face.state is GaugeState.PLATEAU
    assert face.axis is not None
    assert (face.axis.figure, face.axis.is_met) == ("3.8", False)
    assert face.centre is not None
    assert face.centre.is_met
    once_more = gauge_face(Joint.LEFT_KNEE, state(3.8, 8, is_plateau=True), HUMAN, is_now=True)
    assert once_more.state is GaugeState.NOW


def test_a_prosthesis_that_turns_like_no_hinge_is_called_so() -> None:
    loose = state(0.4, 4, floor_deg=6.0, is_closed=True)
    assert gauge_face(Joint.LEFT_KNEE, loose, PROSTHESIS, is_now=False).state is GaugeState.LOOSE
    assert gauge_face(Joint.LEFT_KNEE, loose, HUMAN, is_now=False).state is GaugeState.ENOUGH
    firm = state(0.4, 4, floor_deg=0.6, is_closed=True)
    assert gauge_face(Joint.LEFT_KNEE, firm, PROSTHESIS, is_now=False).state is GaugeState.ENOUGH


@pytest.mark.parametrize("joint", [Joint.LEFT_KNEE, Joint.LEFT_ANKLE])
def test_an_axis_that_is_only_uncertain_is_not_called_no_hinge(joint: Joint) -> None:
    uncertain = state(11, 4, floor_deg=0.6, is_plateau=True)
    assert gauge_face(joint, uncertain, PROSTHESIS, is_now=False).state is GaugeState.PLATEAU


def test_of_an_ankles_hinge_nothing_is_stated_before_its_axis_is_known() -> None:
    found = state(20, 4, floor_deg=6.0, is_closed=True)
    assert gauge_face(Joint.LEFT_ANKLE, found, PROSTHESIS, is_now=False).state is GaugeState.CENTRE


def test_a_gauge_is_reported_to_readers_of_screens(qtbot: QtBot) -> None:
    gauge = Gauge(Joint.LEFT_KNEE)
    qtbot.addWidget(gauge)
    gauge.show_face(gauge_face(Joint.LEFT_KNEE, state(11, 34), HUMAN, is_now=True))
    assert gauge.accessibleName() == (
        "Left knee, axis 11°, under 1.5° required, centre 34 mm, under 10 mm required, move now"
    )
    gauge.show_face(GaugeFace(GaugeState.ABSENT, note="No foot sensor: no left ankle angle."))
    assert gauge.accessibleName() == "Left knee, No foot sensor: no left ankle angle."


def test_an_ankles_gauge_shows_readers_of_screens_what_it_judges(qtbot: QtBot) -> None:
    stated = {}
    for joint in (Joint.LEFT_ANKLE, Joint.LEFT_KNEE):
        gauge = Gauge(joint)
        qtbot.addWidget(gauge)
        gauge.show_face(gauge_face(joint, state(1, 6, is_closed=True), HUMAN, is_now=False))
        stated[joint] = gauge.accessibleName()
    assert stated[Joint.LEFT_ANKLE] == (
        "Left ankle, axis found while walking, centre 6.0 mm, under 10 mm required, Enough movement for the centre"
    )
    assert stated[Joint.LEFT_KNEE] == (
        "Left knee, axis 1.0°, under 1.5° required, centre 6.0 mm, under 10 mm required, Enough movement"
    )


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


def test_a_joint_whose_sensor_is_elsewhere_states_what_it_needs(qtbot: QtBot) -> None:
    gauge = Gauge(Joint.LEFT_KNEE)
    qtbot.addWidget(gauge)
    nothing = gauge_face(Joint.LEFT_KNEE, None, HUMAN, is_now=False)
    gauge.show_face(replace(nothing, state=GaugeState.NEEDS, note="Needs the left shank sensor"))
    assert gauge.accessibleName().endswith("Needs the left shank sensor")
