"""Angle range of each chart. It is the same every time, so that two patients are compared at a glance."""

from collections.abc import Iterable

import numpy as np

from app.wording.body import name_of
from app.wording.numbers import MINUS
from app.wording.translation import capitalised, figure_text, later, tr
from core.body import JointKind, Side
from core.samples import FloatArray

KNEE_DEG = (-10.0, 80.0)
ANKLE_DEG = (-30.0, 30.0)
HIP_DEG = (-30.0, 60.0)
USUAL_DEG = {JointKind.HIP: HIP_DEG, JointKind.KNEE: KNEE_DEG, JointKind.ANKLE: ANKLE_DEG}
ABOUT_MEAN_DEG = {  # of curves without a height
    JointKind.HIP: (-40.0, 50.0),
    JointKind.KNEE: (-40.0, 50.0),
    JointKind.ANKLE: ANKLE_DEG,
}
TITLES = {JointKind.HIP: later("Hip"), JointKind.KNEE: later("Knee"), JointKind.ANKLE: later("Ankle")}
SIGNS = {
    JointKind.HIP: later("flexion + (°)"),
    JointKind.KNEE: later("flexion + (°)"),
    JointKind.ANKLE: later("dorsiflexion + (°)"),
}
NOTHING = {
    JointKind.HIP: later("No hip angles."),
    JointKind.KNEE: later("No knee angles."),
    JointKind.ANKLE: later("No ankle angles."),
}
AXIS_WIDTH, RIGHT_MARGIN = 40, 16  # fixed, so that charts above one another align
WIDEN_TO_DEG = 10  # a range that is left is widened to the next full ten


def range_for(fixed_deg: tuple[float, float], curves: Iterable[FloatArray]) -> tuple[float, float]:
    """Give `fixed_deg`, widened where a curve leaves it. NaN counts for nothing."""
    lowest, highest = fixed_deg
    for values in curves:
        if np.isfinite(values).any():
            lowest = min(lowest, WIDEN_TO_DEG * np.floor(np.nanmin(values) / WIDEN_TO_DEG))
            highest = max(highest, WIDEN_TO_DEG * np.ceil(np.nanmax(values) / WIDEN_TO_DEG))
    return float(lowest), float(highest)


def degrees_in_words(value: float | np.floating, decimals: int = 1) -> str:
    return f"{figure_text(float(value), f'.{decimals}f')}°".replace("-", MINUS)


def angle_in_words(value: float) -> str:
    """A label of an axis, in whole degrees; never minus zero."""
    return f"{round(value)}".replace("-", MINUS)


def part_in_words(side: Side, kind: JointKind) -> str:
    """Name a joint where a sentence begins: "Left knee"."""
    return capitalised(name_of(kind.of(side)))


def title_in_words(kind: JointKind) -> str:
    return tr(TITLES[kind])


def sign_in_words(kind: JointKind) -> str:
    return tr(SIGNS[kind])


def nothing_in_words(kind: JointKind) -> str:
    return tr(NOTHING[kind])


def range_in_words(range_deg: tuple[float, float]) -> str:
    """Say that an axis is not the one that everybody else's curves are read on."""
    lowest, highest = (degrees_in_words(end, 0) for end in range_deg)
    return tr("Axis widened: {lowest} to {highest}.").format(lowest=lowest, highest=highest)
