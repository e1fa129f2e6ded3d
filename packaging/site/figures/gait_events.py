"""The pitch rate of a foot over two strides, the events that are found in it, and the true ones."""

import numpy as np
from matplotlib.figure import Figure
from site_material import WALK, sensor, session_of

from core.body import Side, Site
from core.gait.events import gait_of
from core.gait.foot import follow
from devices.simulation.walker import Tissue

MARKS = {"heel_rise_s": "^", "toe_off_s": "o", "initial_contact_s": "s", "full_contact_s": "v"}


def draw(figure: Figure) -> None:
    foot = sensor(Tissue.SOFT, WALK, Site.LEFT_FOOT)
    motion, events = follow(foot), gait_of(foot)
    truth = session_of(Tissue.SOFT).truth.recordings[WALK].feet[Side.LEFT].events
    time_s = motion.time_of(np.arange(len(motion.pitch_rate_rad_s), dtype=np.float64))
    first, last = events.heel_rise_s[3] - 0.3, events.full_contact_s[4] + 0.3
    axes = figure.subplots()
    axes.plot(time_s, motion.pitch_rate_rad_s, "C0")
    for number, (name, mark) in enumerate(MARKS.items()):
        at = getattr(events, name)[3:5]
        label = name.removesuffix("_s").replace("_", " ")
        axes.plot(at, np.interp(at, time_s, motion.pitch_rate_rad_s), mark, color=f"C{number % 2 + 1}", label=label)
        for true_s in getattr(truth, name):
            axes.axvline(true_s, color=f"C{number % 2 + 1}", linewidth=0.8, linestyle=":")
    axes.set(xlim=(first, last), xlabel="time (s)", ylabel="pitch rate, toes up (rad/s)")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
