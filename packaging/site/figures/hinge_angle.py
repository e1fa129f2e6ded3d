"""The angle of a hinge from rates alone, from accelerations alone, and from both."""

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure
from site_material import WALK, as_published, pair, true_flexion

from core.published.angles import angle_from_accelerations, angle_from_rates, published_angle
from core.samples import FloatArray
from devices.simulation.walker import Tissue

BIAS_RAD_S = np.deg2rad(2.0)  # what a gyroscope may be off by where nobody stood still


def draw(figure: Figure) -> None:
    knee, found = pair(Tissue.RIGID, WALK), as_published(Tissue.RIGID)
    j1, j2, o1, o2 = found.axis_1, found.axis_2, found.centre_1_m, found.centre_2_m
    knee = replace(knee, g1=knee.g1 + BIAS_RAD_S * j1)
    true_rad = true_flexion(Tissue.RIGID, knee.time_s)
    courses = {
        "rates": angle_from_rates(knee.g1, knee.g2, j1, j2, knee.step_s),
        "accelerations": angle_from_accelerations(knee, j1, j2, o1, o2),
        "both": published_angle(knee, j1, j2, o1, o2),
    }
    sign = np.sign(np.corrcoef(courses["rates"], true_rad)[0, 1])
    titles = ("Either alone", "Both together")
    left, right = figure.subplots(1, 2, sharey=True)
    forces_deg = _turned(courses["accelerations"], sign, true_rad)
    left.plot(knee.time_s, forces_deg, color="C2", linewidth=0.8, label="accelerations")
    left.plot(knee.time_s, _from_start(courses["rates"], sign, true_rad), color="C1", label="rates")
    right.plot(knee.time_s, np.rad2deg(true_rad), color="C1", linestyle="--", label="truth")
    right.plot(knee.time_s, _turned(courses["both"], sign, true_rad), color="C0", label="both")
    left.legend(loc="upper left", ncols=2)
    right.legend(loc="upper left", ncols=2)
    for axes, title in zip((left, right), titles, strict=True):
        axes.set(title=title, xlabel="time (s)", ylim=(-30.0, 90.0))
    left.set_ylabel("knee flexion (°)")


def _turned(angle_rad: FloatArray, sign: float, true_rad: FloatArray) -> FloatArray:
    """In degrees, with the sign and about the zero of the truth."""
    apart = sign * angle_rad - true_rad
    middle = np.angle(np.nanmean(np.exp(1j * apart)))
    return np.rad2deg(true_rad + np.angle(np.exp(1j * (apart - middle))))


def _from_start(angle_rad: FloatArray, sign: float, true_rad: FloatArray) -> FloatArray:
    return np.rad2deg(sign * (angle_rad - angle_rad[0]) + true_rad[0])
