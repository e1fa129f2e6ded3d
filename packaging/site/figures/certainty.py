"""A knee in walking with twice its stated standard deviation, and the bones' angle."""

import numpy as np
from matplotlib.figure import Figure
from site_material import KNEE, analysis_of, true_flexion

from devices.simulation.walker import Tissue

SHOWN_S = (3.0, 7.0)


def draw(figure: Figure) -> None:
    walk = analysis_of(Tissue.SOFT).recordings[-1]
    knee = walk.joints[KNEE]
    angle_deg, sd_deg = np.rad2deg(knee.angle_rad), np.rad2deg(knee.sd_rad)
    axes = figure.subplots()
    low_deg, high_deg = angle_deg - 2 * sd_deg, angle_deg + 2 * sd_deg
    axes.fill_between(walk.time_s, low_deg, high_deg, alpha=0.35, linewidth=0, label="±2 SD")
    axes.plot(walk.time_s, angle_deg, "C0", label="measured")
    axes.plot(walk.time_s, np.rad2deg(true_flexion(Tissue.SOFT, walk.time_s)), "C1--", label="bones")
    axes.set(xlim=SHOWN_S, xlabel="time (s)", ylabel="knee flexion (°)")
    axes.legend(loc="upper right", ncols=3)
    axes.set_ylim(top=1.25 * axes.get_ylim()[1])
