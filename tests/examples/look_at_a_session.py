"""Read a session and look at what one sensor recorded.

    python -m tests.examples.look_at_a_session SESSION FIGURE.png

Each recording has one block of samples per site: stamps in seconds, angular rate in rad/s, specific force in m/s2, in
the sensor's own axes. Printed are the recordings with their sites and lengths; the figure shows how fast one sensor
turned.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from core import Site
from devices import read_session

SITE = Site.LEFT_SHANK


def main(folder: Path, out: Path) -> None:
    recordings = [one for one in read_session(folder).recordings if SITE in one.imu]
    figure = Figure(figsize=(8, 2 + 1.6 * len(recordings)), layout="constrained")
    for axes, recording in zip(figure.subplots(len(recordings), squeeze=False)[:, 0], recordings, strict=True):
        block = recording.imu[SITE]
        axes.plot(block.time_s, np.linalg.norm(block.gyr_rad_s, axis=1), linewidth=0.8)
        axes.set(title=f"{recording.name} ({recording.kind})", ylabel="rate (rad/s)")
        length_s = block.time_s[-1] - block.time_s[0]
        print(f"{recording.name}: {', '.join(recording.imu)}, {length_s:.1f} s, {len(block)} samples")
    axes.set_xlabel("time (s)")
    figure.savefig(out)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
