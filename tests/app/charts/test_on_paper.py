"""A chart on paper: which leg is which without colour, what is not reported, and what has no room."""

import re
from dataclasses import replace

import numpy as np
import pytest

from app.charts.cycles import PERCENT
from app.charts.drawing import COLOURS
from app.charts.on_paper import draw, frame_of
from app.charts.stride_chart import Axis, StrideChart, StrideCurve
from core.body import Side
from core.samples import FloatArray

WIDTH = 150.0
KNEE: FloatArray = 10 * np.exp(-(((PERCENT - 14) / 8) ** 2)) + 55 * np.exp(-(((PERCENT - 73) / 12) ** 2))
CHART = StrideChart(
    Axis(-10, 80, 20, 10, "bent", "straight"),
    (StrideCurve("L", Side.LEFT, KNEE, 60.0, toe_off_label="L toe-off 60.0 %"),),
    band=None,
    is_simulated=False,
    alt="Knee.",
)


@pytest.mark.parametrize("side", Side)
def test_sides_are_reported_by_letter_and_line_and_not_by_colour_alone(side: Side) -> None:
    """As they print in grey: left is solid with its letter, right dashed with its."""
    curve = StrideCurve(side[0].upper(), side, KNEE, 60.0, toe_off_label=f"{side[0].upper()} toe-off 60.0 %")
    svg = draw(replace(CHART, curves=(curve,)), WIDTH).svg
    (drawn,) = re.findall(rf'<path [^>]*stroke="{re.escape(COLOURS[side])}"[^>]*>', svg)
    assert ("stroke-dasharray" in drawn) is (side is Side.RIGHT)
    assert f">{side[0].upper()}</text>" in svg


def test_a_curve_that_is_compared_is_drawn_by_its_order() -> None:
    def widths(*orders: tuple[int, int]) -> list[float]:
        curves = tuple(StrideCurve("ABC"[k], Side.LEFT, KNEE + 5 * k, order=order) for k, order in enumerate(orders))
        svg = draw(replace(CHART, curves=curves), WIDTH).svg
        return [
            float(width)
            for width in re.findall(r'stroke-linejoin="round" stroke="#(?!FFFFFF)\w+" stroke-width="([\d.]+)"', svg)
        ]

    assert widths((0, 2), (1, 2)) == [1.0, 1.9]
    assert widths((0, 3), (1, 3), (2, 3)) == [0.95, 1.4, 2.1]


def test_what_is_not_reported_is_hatched_with_its_reason_and_has_no_curve() -> None:
    why = "81° of range; walking has no more than 60°. Foot and shank sensor do not move as neighbours."
    drawn = draw(replace(CHART, not_reported=why), WIDTH)
    words = re.findall(r">([^<>]+)</text>", drawn.svg)
    at = words.index("Not reported")
    assert why in " ".join(words[at:])
    assert "<path" not in drawn.svg
    assert "SIMULATED" not in words
    assert ">SIMULATED</text>" in draw(replace(CHART, not_reported=why, is_simulated=True), WIDTH).svg
    assert drawn.alt == f"Knee. Not reported. {why}"
    assert "Not reported" not in draw(CHART, WIDTH).svg


def test_hatching_stays_inside_the_plot() -> None:
    not_reported = replace(CHART, not_reported="The sign is not known.")
    frame = frame_of(not_reported, WIDTH)
    hatches = re.findall(
        r'<line x1="([\d.]+)" y1="([\d.]+)" x2="([\d.]+)" y2="([\d.]+)"[^>]*width="0.35"', draw(not_reported, WIDTH).svg
    )
    assert len(hatches) > 20
    for x, y in [end for hatch in hatches for end in (hatch[:2], hatch[2:])]:
        assert frame.left - 0.01 <= float(x) <= frame.right + 0.01
        assert frame.top - 0.01 <= float(y) <= frame.bottom + 0.01


def test_a_narrow_chart_leaves_the_words_of_its_axis_away() -> None:
    narrow, wide = draw(CHART, WIDTH), draw(CHART, 200.0)
    assert "initial contact" in wide.svg
    assert "initial contact" not in narrow.svg
    assert ">100 %</text>" in narrow.svg
    assert 'text-anchor="middle">L toe-off 60.0 %' in narrow.svg
    assert 'text-anchor="start">L toe-off 60.0 %' in wide.svg
    assert ">100</text>" in wide.svg
