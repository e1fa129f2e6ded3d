"""Check on the project's own patient that what is stated about an angle's certainty holds.

    python -m tests.benchmarks.certainty --seeds 12 [--first 0]

One line per tissue, wearer, kind of joint and kind of recording: share of samples within two standard deviations after
removing the mean, pooled (90 to 100 % required) and in the worst session, and the standard deviation over the error.
"""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from core.analysis import analyse
from core.body import Joint, Side
from core.session import Patient
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate
from tests.driver import options

SETTINGS = {
    "free motion, walk": WalkerSettings(recordings=(Standing(), FreeMotion(), Walk(strides=12))),
    "walk alone": WalkerSettings(recordings=(Standing(), Walk(strides=12))),
}
TURN_RAD = np.deg2rad(2.0)
TISSUES = {
    "rigid": (Tissue.RIGID, 0.0),
    "soft": (Tissue.SOFT, 0.0),
    "soft, turning": (Tissue.SOFT, TURN_RAD),
    "real": (Tissue.REAL, 0.0),
    "real, turning": (Tissue.REAL, TURN_RAD),
}
# what is worn, and what is declared; an ankle with play is a prosthetic one that moves as a bare person's
WORN: dict[str, tuple[Side | None, str]] = {
    "person": (None, "none"),
    "prosthesis": (Side.LEFT, "left"),
    "undeclared": (Side.LEFT, "none"),
    "with play": (None, "left"),
}


@dataclass(frozen=True, slots=True)
class Coverage:
    """Of one joint in one recording: `inside` and `samples` are numbers, the others mean squares, deg^2."""

    inside: int
    samples: int
    error: float
    sd: float


def coverages(settings: WalkerSettings, worn: str = "person") -> Iterator[tuple[str, Coverage]]:
    """What every joint's angle of one session is worth, by kind of joint and recording; of a wearer's, one leg's."""
    prosthetic, declared = WORN[worn]
    simulated = simulate(replace(settings, prosthetic_side=prosthetic))
    analysis = analyse(replace(simulated.session, patient=Patient(prosthetic_side=declared)))
    for recording in analysis.recordings:
        truths = simulated.truth.recordings[recording.name].joints
        for joint, angle in recording.joints.items():
            if worn != "person" and joint.side is Side.RIGHT:
                continue
            truth = truths[joint]
            error = np.rad2deg(angle.angle_rad - np.interp(recording.time_s, truth.time_s, truth.angle_rad))
            is_known = np.isfinite(error)
            error, sd = error[is_known] - np.mean(error[is_known]), np.rad2deg(angle.sd_rad[is_known])
            inside = int(np.count_nonzero(np.abs(error) < 2 * sd))
            found = Coverage(inside, len(error), float(np.mean(error**2)), float(np.mean(sd**2)))
            yield f"{_kind(joint, analysis.calibrations[0].joints[joint].is_hinge)}, {recording.kind}", found


def _kind(joint: Joint, is_hinge: bool) -> str:
    return f"{'hinge, ' if is_hinge else ''}{'knee' if joint.is_knee else 'ankle'}"


def main() -> None:
    arguments = options(__doc__, seeds=12, first=0)
    for name, (tissue, turn_rad) in TISSUES.items():
        for worn in WORN if tissue is not Tissue.REAL else ("person", "prosthesis"):
            if worn == "with play" and tissue is not Tissue.RIGID:
                continue
            found: dict[str, list[Coverage]] = defaultdict(list)
            for settings in SETTINGS.values():
                for seed in range(arguments.first, arguments.first + arguments.seeds):
                    of_seed = replace(settings, seed=seed, tissue=tissue, tissue_turn_rad=turn_rad)
                    for kind, coverage in coverages(of_seed, worn):
                        found[kind].append(coverage)
            for kind, many in found.items():
                print(f"{name:14s} {worn:10s} {kind:20s} {summary(many)}", flush=True)


def summary(many: list[Coverage]) -> str:
    pooled = sum(one.inside for one in many) / sum(one.samples for one in many)
    worst = min(one.inside / one.samples for one in many)
    ratio = np.sqrt(np.mean([one.sd for one in many]) / np.mean([one.error for one in many]))
    return f"{len(many):4d} joints  {100 * pooled:5.1f} %, worst {100 * worst:5.1f} %, sd/error {ratio:.2f}"


if __name__ == "__main__":
    main()
