"""A knee's twist as the sensors sit, and its flexion after zero and sign."""

import numpy as np
from matplotlib.figure import Figure
from site_material import KNEE, WALK, analysis_of, down, pair

from core.angles.twist import twist
from core.calibration.heading import heading_over
from core.calibration.zero import standing_twist
from devices.simulation.walker import Tissue

SHOWN_S = (0.0, 8.0)


def draw(figure: Figure) -> None:
    knee, analysis = pair(Tissue.SOFT, WALK), analysis_of(Tissue.SOFT)
    found, walk = analysis.calibrations[-1].joints[KNEE], analysis.recordings[-1]
    j1, j2 = found.axis_proximal, found.axis_distal
    turned = twist(knee, j1, j2, heading_over(knee, j1, j2, np.zeros(12)))
    zero = standing_twist(down(Tissue.SOFT, KNEE.proximal), down(Tissue.SOFT, KNEE.distal), j1, j2)
    turned += 2 * np.pi * np.round((zero - turned[0]) / (2 * np.pi))
    left, right = figure.subplots(1, 2)
    left.plot(knee.time_s, np.rad2deg(turned))
    left.axhline(np.rad2deg(zero), color="C1", linestyle="--", label="standing, from gravity")
    right.plot(walk.time_s, np.rad2deg(walk.joints[KNEE].angle_rad))
    right.axhline(0.0, color="C1", linestyle="--")
    for axes, title in ((left, "Twist"), (right, "Flexion: sign × (twist − standing)")):
        axes.set(title=title, xlim=SHOWN_S, xlabel="time (s)")
    left.set_ylabel("angle (°)")
    left.legend(loc="upper left")
    left.set_ylim(top=left.get_ylim()[1] + 15.0)
