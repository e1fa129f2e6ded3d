"""The lengths of both sensors' accelerations, as measured and shifted into the joint."""

import numpy as np
from matplotlib.figure import Figure
from site_material import FREE, as_published, pair

from core.signal.pair import lever_acceleration
from devices.simulation.walker import Tissue

SHOWN_S = (4.0, 7.0)


def draw(figure: Figure) -> None:
    knee, found = pair(Tissue.RIGID, FREE), as_published(Tissue.RIGID)
    shifted_1 = knee.a1 - lever_acceleration(knee.g1, knee.dg1, found.centre_1_m)
    shifted_2 = knee.a2 - lever_acceleration(knee.g2, knee.dg2, found.centre_2_m)
    titles = {"At the sensors": (knee.a1, knee.a2), "Shifted into the knee": (shifted_1, shifted_2)}
    for axes, (title, forces) in zip(figure.subplots(1, 2, sharey=True), titles.items(), strict=True):
        for force, label, line in zip(forces, ("thigh", "shank"), ("-", "--"), strict=True):
            axes.plot(knee.time_s, np.linalg.norm(force, axis=1), line, label=label)
        axes.set(title=title, xlim=SHOWN_S, ylim=(8.0, 14.0), xlabel="time (s)")
    figure.axes[0].set_ylabel("length of the specific force (m/s²)")
    figure.axes[0].legend(loc="upper left")
