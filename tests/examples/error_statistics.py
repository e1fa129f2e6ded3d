"""Errors over many simulated people: by how much the range of a joint differs from the true one.

    python -m tests.examples.error_statistics FIGURE.png [PEOPLE]

Each person has another body, another gait and sensors strapped on in another way. Printed are the mean error and the
limits of agreement (mean and 1.96 standard deviations); the figure shows each error against the mean of both ranges,
as Bland and Altman (1986), doi 10.1016/S0140-6736(86)90837-8. A simulated person is kinder than a real one: these are
errors of the method alone.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from core import Joint, analyse
from devices import FreeMotion, Standing, Walk, WalkerSettings, simulate

JOINTS = (Joint.LEFT_KNEE, Joint.LEFT_ANKLE)


def ranges_deg(seed: int) -> list[tuple[float, float]]:
    """Measured and true range of each joint over one person's walk."""
    simulated = simulate(WalkerSettings(seed=seed, recordings=(Standing(), FreeMotion(), Walk(strides=6))))
    walk = analyse(simulated.session).recordings[-1]
    truth = simulated.truth.recordings[walk.name].joints
    both = [(walk.joints[joint].angle_rad, truth[joint].angle_rad) for joint in JOINTS]
    return [(np.rad2deg(np.ptp(found[np.isfinite(found)])), np.rad2deg(np.ptp(true))) for found, true in both]


def main(out: Path, people: int = 10) -> None:
    found, true = np.moveaxis(np.array([ranges_deg(seed) for seed in range(1, people + 1)]), 2, 0)
    figure = Figure(figsize=(8, 3.5), layout="constrained")
    for number, (axes, joint) in enumerate(zip(figure.subplots(1, len(JOINTS)), JOINTS, strict=True)):
        error, middle = (found - true)[:, number], ((found + true) / 2)[:, number]
        mean, limit = error.mean(), 1.96 * error.std(ddof=1)
        print(f"{joint}: mean error {mean:.2f} deg, limits {mean - limit:.2f} to {mean + limit:.2f} deg")
        axes.scatter(middle, error)
        for line in (mean - limit, mean, mean + limit):
            axes.axhline(line, color="grey", linestyle="-" if line == mean else "--")
        axes.set(title=joint, xlabel="mean of both ranges (deg)", ylabel="measured less true (deg)")
    figure.savefig(out)


if __name__ == "__main__":
    main(Path(sys.argv[1]), *map(int, sys.argv[2:]))
