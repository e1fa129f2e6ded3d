"""How does a number go from stride to stride? The strip of strides."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.charts.drawing import COLOURS, DASHES, MM, Picture, badge, box, line, marker, picture, text
from app.colours import PAPER
from app.reports.patient_report.numbers_in_words import Band, fixed
from app.wording import tr
from core.body import Side

STRIP_WIDTH, STRIP_HEIGHT = 175 * MM, 40 * MM


@dataclass(frozen=True, slots=True)
class StrideValues:
    """One value of every stride (k,) in the order walked, and which of them are used."""

    values: Sequence[float]
    is_used: Sequence[bool]
    mean: float


def stride_strip(
    title: str,
    sides: Mapping[Side, StrideValues],
    low: float,
    high: float,
    band: Band | None,
    is_simulated: bool,
    alt: str,
) -> Picture:
    """Every stride in order; those left out are crosses with their side."""
    left, right, top = 27.0, STRIP_WIDTH - 3.0, 13.0
    bottom = STRIP_HEIGHT - 24
    count = max((len(side.values) for side in sides.values()), default=1)

    def y(value: float) -> float:
        return bottom - (bottom - top) * (min(max(value, low), high) - low) / (high - low)

    def x(k: float) -> float:
        return left + (right - left - 34) * (k + 0.6) / max(count, 8)

    parts = [text(0, 8, title, 7.6, weight=600)]
    if band is not None:
        mean, sd = (band[0] + band[1]) / 2, (band[1] - band[0]) / 2
        for reach, fill in ((2 * sd, PAPER.band_2sd), (sd, PAPER.band_1sd)):
            parts.append(box(left, y(mean + reach), right - left, y(mean - reach) - y(mean + reach), fill))
    for value in np.arange(low, high + 1, 20):
        parts.append(line(left, y(value), right, y(value), PAPER.grid, 0.25))
        parts.append(text(left - 6, y(value) + 2.5, fixed(float(value), 0), 7, anchor="end"))
    for side, strides in sides.items():
        if np.isfinite(strides.mean):
            parts.append(line(left, y(strides.mean), right - 34, y(strides.mean), COLOURS[side], 0.8, DASHES[side]))
    for side, strides in sides.items():
        shift = -2.8 if side is Side.LEFT else 2.8  # side by side: strides are alike, and one would cover the other
        for k, (value, is_used) in enumerate(zip(strides.values, strides.is_used, strict=True)):
            here = x(k) + shift
            if is_used and np.isfinite(value):
                parts.append(marker(here, y(value), side, COLOURS[side], 4.4))
            elif not is_used:
                there = bottom - (14 if side is Side.LEFT else 6)
                parts += [
                    line(here - 1.8, there - 1.8 * d, here + 1.8, there + 1.8 * d, PAPER.ink, 0.9) for d in (1, -1)
                ]
                parts.append(text(here + 3, there + 2.3, side[0].upper(), 6.4))
    ends = sorted((y(s.mean), side) for side, s in sides.items() if np.isfinite(s.mean))
    for k, (height, side) in enumerate(ends):
        parts.append(badge(right - 26 + 13 * k, height, side[0].upper(), side, COLOURS[side]))
    for k in range(count):
        if k == 0 or (k + 1) % 5 == 0:
            parts.append(text(x(k), bottom + 9.5, str(k + 1), 7, anchor="middle"))
    parts.append(text((left + right) / 2, bottom + 20, tr("Stride, in the order walked"), 7, anchor="middle"))
    parts.append(box(left, top, right - left, bottom - top, "none", PAPER.ink, 0.7))
    if is_simulated:
        parts.append(text(right, 8, tr("SIMULATED"), 6.6, anchor="end", weight=600))
    return picture(parts, STRIP_WIDTH, STRIP_HEIGHT, alt)
