"""The forward speed of a foot's sensor, integrated once for the whole walk and from stance to stance."""

import numpy as np
from matplotlib.figure import Figure
from site_material import WALK, sensor

from core.body import Site
from core.gait.foot import follow
from core.samples import GRAVITY_M_S2
from devices.simulation.walker import Tissue


def draw(figure: Figure) -> None:
    foot = sensor(Tissue.SOFT, WALK, Site.LEFT_FOOT)
    motion, track = follow(foot), foot.track
    acceleration = np.einsum("nij,nj->ni", foot.earth_from_sensor, track.acc_m_s2) - [0.0, 0.0, GRAVITY_M_S2]
    once = np.cumsum(acceleration, axis=0) * track.step_s
    way = motion.travel_m.sum(axis=0)
    forward = np.append(way / np.linalg.norm(way), 0.0)
    rests = motion.swings.anchor_before
    axes = figure.subplots()
    axes.plot(track.time_s, once @ forward, "C1--", label="integrated once")
    axes.plot(track.time_s, motion.velocity_m_s @ forward, "C0", label="zero in every stance")
    axes.plot(track.time_s[rests], np.zeros(len(rests)), "C2o", label="calmest instants")
    axes.set(xlabel="time (s)", ylabel="forward speed (m/s)")
    axes.legend(loc="upper left", ncols=3)
    axes.set_ylim(top=1.25 * axes.get_ylim()[1])
