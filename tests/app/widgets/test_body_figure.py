"""The drawn body: sides, places, marks, and its words."""

import pytest
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QImage, QPainter
from pytestqt.qtbot import QtBot

from app.theme.current import current_theme
from app.widgets.body_figure import BodyFigure, SensorMark, paint_legs
from app.widgets.body_shapes import body_shapes, read_path
from core.body import LEG_JOINTS, LEG_SITES, Side, Site


@pytest.fixture
def figure(qtbot: QtBot) -> BodyFigure:
    figure = BodyFigure()
    qtbot.addWidget(figure)
    figure.resize(360, 560)
    return figure


def test_the_drawing_names_every_segment_joint_and_sensor() -> None:
    shapes = body_shapes()
    assert {"body", "head", "pelvis", "left_arm", "right_arm", *LEG_SITES} == set(shapes.outlines)
    assert {*LEG_JOINTS, *(f"{site}_sensor" for site in Site), "left_eye", "right_eye"} == set(shapes.points)
    for site in Site:
        assert shapes.outlines[site].contains(shapes.points[f"{site}_sensor"])


def test_a_path_that_cannot_be_read_is_refused() -> None:
    with pytest.raises(ValueError, match="command Q"):
        read_path("M 0 0 Q 1 1 2 2")
    with pytest.raises(ValueError, match="C has 4 numbers"):
        read_path("M 0 0 C 1 1 2 2")


def test_the_patients_right_is_at_the_left_and_changes_over_from_behind(figure: BodyFigure) -> None:
    middle = figure.width() / 2
    for site in LEG_SITES:
        assert (figure.anchor(site).x() > middle) == (site.side is Side.LEFT)
    figure.set_from_behind(True)
    for site in LEG_SITES:
        assert (figure.anchor(site).x() < middle) == (site.side is Side.LEFT)
    assert figure.accessibleName() == "Seen from behind"


@pytest.mark.parametrize("is_legs_only", [False, True])
def test_each_place_is_found_where_it_is_drawn(figure: BodyFigure, is_legs_only: bool) -> None:
    figure.set_legs_only(is_legs_only)
    for site in Site:
        assert figure.site_at(figure.anchor(site)) is site
    assert figure.site_at(QPointF(figure.width() / 2, 4 if is_legs_only else 40)) is None
    for joint in LEG_JOINTS:
        thigh_or_shank, below = figure.anchor(joint.proximal).y(), figure.anchor(joint.distal).y()
        assert thigh_or_shank < figure.joint_anchor(joint).y() < below


def test_the_figure_states_its_places(figure: BodyFigure) -> None:
    figure.show_worn({Site.LEFT_THIGH: SensorMark.WORN, Site.RIGHT_FOOT: SensorMark.SILENT})
    figure.emphasise(Site.LEFT_SHANK)
    assert figure.accessibleDescription() == "L thigh: worn; R foot: no signal; marked: L shank"


@pytest.mark.parametrize("size", [(32, 56), (190, 400)])
def test_legs_show_a_silent_sensor_in_yellow_and_the_side_in_its_colour(size: tuple[int, int]) -> None:
    theme = current_theme()
    image = QImage(*size, QImage.Format.Format_ARGB32)
    image.fill(QColor(theme.colours.surface))
    painter = QPainter(image)
    paint_legs(painter, QRectF(image.rect()), theme, None, {Site.RIGHT_FOOT: SensorMark.SILENT})
    painter.end()
    yellow = QColor(theme.colours.caution_mark)
    found = [(x, y) for x in range(size[0]) for y in range(size[1]) if image.pixelColor(x, y) == yellow]
    assert found
    assert all(x < size[0] / 2 and y > size[1] * 0.8 for x, y in found)
    left = QColor(theme.colours.left_pale)
    assert all(x > size[0] / 2 for x in range(size[0]) for y in range(size[1]) if image.pixelColor(x, y) == left)
