"""The knee of a person whose skin moves: the twist of the orientations, and the integral of the rates."""

import numpy as np
from matplotlib.figure import Figure
from site_material import KNEE, WALK, analysis_of, pair, true_flexion

from core.published.angles import angle_from_rates
from devices.simulation.walker import Tissue

SHOWN_S = (3.0, 9.0)


def draw(figure: Figure) -> None:
    knee, analysis = pair(Tissue.REAL, WALK), analysis_of(Tissue.REAL)
    calibration, walk = analysis.calibrations[-1].joints[KNEE], analysis.recordings[-1]
    rates = angle_from_rates(knee.g1, knee.g2, calibration.axis_proximal, calibration.axis_distal, knee.step_s)
    true_deg = np.rad2deg(true_flexion(Tissue.REAL, knee.time_s))
    integral_deg = -calibration.clinical_sign * np.rad2deg(rates)
    axes = figure.subplots()
    axes.plot(knee.time_s, true_deg, "C1--", label="bones")
    axes.plot(walk.time_s, np.rad2deg(walk.joints[KNEE].angle_rad), "C0", label="twist of the orientations")
    axes.plot(knee.time_s, integral_deg - integral_deg[0] + true_deg[0], "C2:", label="integral of the rates")
    axes.set(xlim=SHOWN_S, ylim=(-20.0, 110.0), xlabel="time (s)", ylabel="knee flexion (°)")
    axes.legend(loc="upper left", ncols=3)
