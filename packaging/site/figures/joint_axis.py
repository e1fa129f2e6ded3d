"""The lengths of both sensors' rates across the joint, with the axes that were found and with a wrong one."""

import numpy as np
from matplotlib.figure import Figure
from site_material import FREE, as_published, pair

from core.samples import FloatArray
from core.signal.rotations import joint_frame
from devices.simulation.walker import Tissue

SHOWN_S = (4.0, 8.0)
WRONG_RAD = np.deg2rad(30.0)


def draw(figure: Figure) -> None:
    knee, found = pair(Tissue.RIGID, FREE), as_published(Tissue.RIGID)
    wrong = np.cos(WRONG_RAD) * found.axis_1 + np.sin(WRONG_RAD) * joint_frame(found.axis_1)[0]
    titles = {"With the axes that were found": found.axis_1, "Thigh's axis turned by 30°": wrong}
    for axes, (title, axis_1) in zip(figure.subplots(1, 2, sharey=True), titles.items(), strict=True):
        axes.plot(knee.time_s, _across(knee.g1, axis_1), label="thigh")
        axes.plot(knee.time_s, _across(knee.g2, found.axis_2), "--", label="shank")
        axes.set(title=title, xlim=SHOWN_S, ylim=(0.0, 2.2), xlabel="time (s)")
    figure.axes[0].set_ylabel("rate across the axis (rad/s)")
    figure.axes[0].legend(loc="upper left")


def _across(rate: FloatArray, axis: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(np.cross(rate, axis), axis=1))
