"""Show where the axes of every joint lie in the sensors, and how sure they are.

    python -m tests.examples.axes_of_a_joint SESSION FIGURE.png

The axes are unit vectors in the axes of the proximal and of the distal sensor; a sensor may be worn in any orientation,
so they differ from session to session. Printed are both with the standard deviation in degrees and what they rest on.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from core import analyse
from devices import read_session


def main(folder: Path, out: Path) -> None:
    joints = analyse(read_session(folder)).calibrations[-1].joints
    figure = Figure(figsize=(2.6 * len(joints), 3.2), layout="constrained")
    for axes, (joint, found) in zip(figure.subplots(1, len(joints), squeeze=False)[0], joints.items(), strict=True):
        pair = np.array([found.axis_proximal, found.axis_distal])
        sd_deg = np.rad2deg(found.axis_sd_rad) if found.axis_sd_rad is not None else np.nan
        print(f"{joint}: {pair.round(3).tolist()}, sd {sd_deg:.2f} deg, {found.axis_source}")
        for number, site in enumerate((joint.proximal, joint.distal)):
            axes.bar(np.arange(3) + 0.4 * number - 0.2, pair[number], width=0.4, label=site)
        axes.set(title=f"{joint} (sd {sd_deg:.1f} deg)", ylim=(-1.05, 1.05))
        axes.set_xticks(range(3), ["x", "y", "z"])
        axes.legend(fontsize="small")
    figure.savefig(out)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
