"""Show what a timed test of a session gives: its time, its parts and its turns.

    python -m tests.examples.timed_test SESSION FIGURE.png

A walk is a timed test where the session states which one. Printed are time, distance and parts of each test; the figure
shows when they were, below the speed at which the left shank turned.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from core import Site, analyse
from devices import read_session


def main(folder: Path, out: Path) -> None:
    session = read_session(folder)
    tests = [(one.name, one.timed) for one in analyse(session).recordings if one.timed is not None]
    figure = Figure(figsize=(9, 3 * len(tests)), layout="constrained")
    for axes, (name, found) in zip(figure.subplots(len(tests), squeeze=False)[:, 0], tests, strict=True):
        shank = next(one for one in session.recordings if one.name == name).imu[Site.LEFT_SHANK]
        axes.plot(shank.time_s, np.linalg.norm(shank.gyr_rad_s, axis=1), linewidth=0.8, color="grey")
        print(f"{name}: {found.protocol}, {found.end_s - found.start_s:.2f} s, {found.distance_m:.1f} m")
        for number, part in enumerate(found.parts):
            axes.axvspan(part.start_s, part.end_s, alpha=0.25, color=f"C{number}", label=part.part)
            print(f"  {part.part}: {part.time_s:.2f} s")
        axes.set(title=name, xlabel="time (s)", ylabel="rate of the shank (rad/s)")
        axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), fontsize="small")
    figure.savefig(out)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
