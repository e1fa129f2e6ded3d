"""Simulate a patient whose angles are known, analyse what the sensors recorded, and compare.

    python -m tests.examples.simulate_and_compare FIGURE.png

The true angle is zero in the anatomical neutral position and the measured one in standing, so the standing angle is
subtracted. Printed are the root mean square and the largest difference of each joint over the walk, in degrees.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from core import analyse
from devices import FreeMotion, Standing, Walk, WalkerSettings, simulate


def main(out: Path) -> None:
    simulated = simulate(WalkerSettings(seed=3, recordings=(Standing(), FreeMotion(), Walk(strides=8))))
    walk = analyse(simulated.session).recordings[-1]
    figure = Figure(figsize=(9, 2.2 * len(walk.joints)), layout="constrained")
    for axes, (joint, found) in zip(figure.subplots(len(walk.joints), sharex=True), walk.joints.items(), strict=True):
        truth = simulated.truth.recordings[walk.name].joints[joint]
        true_deg = np.rad2deg(np.interp(walk.time_s, truth.time_s, truth.angle_rad - truth.standing_rad))
        wrong_deg = np.rad2deg(found.angle_rad) - true_deg
        print(f"{joint}: rms {np.sqrt(np.nanmean(wrong_deg**2)):.2f} deg, largest {np.nanmax(abs(wrong_deg)):.2f} deg")
        axes.plot(walk.time_s, true_deg, label="true", linewidth=3, alpha=0.4)
        axes.plot(walk.time_s, true_deg + wrong_deg, label="measured", linewidth=1)
        axes.set(ylabel=f"{joint} (deg)")
    axes.set_xlabel("time (s)")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    figure.savefig(out)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
