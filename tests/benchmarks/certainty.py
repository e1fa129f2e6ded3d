"""Does what is said of an angle's certainty hold on the project's own patient?

    python -m tests.benchmarks.certainty --seeds 12 [--first 0]

One line per tissue, kind of joint and kind of recording: share of samples within two standard deviations after
removing the mean, pooled (93 to 97 % wanted) and in the worst session (80 %), and the standard deviation over the
error (under 2).
"""

import argparse
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from core.analysis import analyse
from core.body import Joint
from devices.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate

SETTINGS = {
    "free motion, walk": WalkerSettings(recordings=(Standing(), FreeMotion(), Walk(strides=12))),
    "walk alone": WalkerSettings(recordings=(Standing(), Walk(strides=12))),
}


@dataclass(frozen=True, slots=True)
class Coverage:
    """Of one joint in one recording: `inside` and `samples` are numbers, the others mean squares, deg^2."""

    inside: int
    samples: int
    error: float
    sd: float


def coverages(settings: WalkerSettings) -> Iterator[tuple[str, Coverage]]:
    """What every joint's angle of one session is worth, by the kind of joint and recording."""
    simulated = simulate(settings)
    analysis = analyse(simulated.session)
    for recording in analysis.recordings:
        truths = simulated.truth.recordings[recording.name].joints
        for joint, angle in recording.joints.items():
            truth = truths[joint]
            error = np.rad2deg(angle.angle_rad - np.interp(recording.time_s, truth.time_s, truth.angle_rad))
            is_known = np.isfinite(error)
            error, sd = error[is_known] - np.mean(error[is_known]), np.rad2deg(angle.sd_rad[is_known])
            inside = int(np.count_nonzero(np.abs(error) < 2 * sd))
            found = Coverage(inside, len(error), float(np.mean(error**2)), float(np.mean(sd**2)))
            yield f"{_kind(joint, analysis.calibrations[0].joints[joint].is_hinge)}, {recording.kind}", found


def _kind(joint: Joint, is_hinge: bool) -> str:
    return "hinge" if is_hinge else "knee" if joint.is_knee else "ankle"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=12)
    parser.add_argument("--first", type=int, default=0)
    arguments = parser.parse_args()
    for tissue in Tissue:
        found: dict[str, list[Coverage]] = defaultdict(list)
        for settings in SETTINGS.values():
            for seed in range(arguments.first, arguments.first + arguments.seeds):
                for kind, coverage in coverages(replace(settings, seed=seed, tissue=tissue)):
                    found[kind].append(coverage)
        for kind, many in found.items():
            pooled = sum(one.inside for one in many) / sum(one.samples for one in many)
            worst = min(one.inside / one.samples for one in many)
            ratio = np.sqrt(np.mean([one.sd for one in many]) / np.mean([one.error for one in many]))
            print(
                f"{tissue:6s} {kind:20s} {len(many):4d} joints  {100 * pooled:5.1f} % of samples, "
                f"worst {100 * worst:5.1f} %, sd/error {ratio:.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
