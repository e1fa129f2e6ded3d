"""One and the same change of a knee's movement, with what is likely to be true of it in each kind of comparison."""

import numpy as np
from matplotlib.figure import Figure

from core.verdicts.measurement_error import compare
from core.verdicts.model import READ
from core.verdicts.sigmas import ComparisonKind
from core.verdicts.stride_means import MeanOfStrides

COLUMN, CHANGE_DEG = "knee_stance_to_swing_deg", 6.0
EARLIER = MeanOfStrides(mean=52.0, sd=2.0, n=20, standard_error=0.6, drift=0.3)
LATER = MeanOfStrides(mean=EARLIER.mean + CHANGE_DEG, sd=2.0, n=20, standard_error=0.6, drift=0.3)
KINDS = {
    "halves of one walk": ComparisonKind.HALVES,
    "two walks, sensors left on": ComparisonKind.ATTACHED,
    "sensors attached again": ComparisonKind.STRAPPINGS,
    "two visits": ComparisonKind.VISITS,
}


def draw(figure: Figure) -> None:
    axes = figure.subplots()
    for row, kind in enumerate(KINDS.values()):
        found = compare(COLUMN, kind, LATER, EARLIER, (READ, READ))
        words, colour = ("beyond error", "C0") if found.exceeds else ("within error", "C1")
        axes.errorbar(found.difference, -row, xerr=found.error, fmt="o", color=colour, capsize=4)
        axes.text(found.interval[1] + 0.6, -row, words, va="center")
    axes.axvline(0.0, color="C2", linestyle="--", linewidth=1.0)
    axes.set_yticks(-np.arange(len(KINDS)), list(KINDS))
    axes.set(xlim=(-4.0, 20.0), ylim=(-3.6, 0.6), xlabel="change of knee flexion, stance to swing (°)")
