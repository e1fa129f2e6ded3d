"""Check on the project's own patient that what is stated about an angle's certainty holds.

    python -m tests.benchmarks.certainty --seeds 12 [--first 0] [--stated]

One line per tissue, wearer, kind of joint and kind of recording: share of samples within two standard deviations after
removing the mean, pooled (90 to 100 % required) and in the worst session, and the standard deviation over the error.
With `--stated` the wearers are those whose level, knee or foot is stated, beside the same walks of the side alone.
"""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from core.analysis import analyse
from core.body import Joint, Side
from core.prosthesis import NOT_STATED, AmputationLevel, FootKind, KneeKind, Prosthesis
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


@dataclass(frozen=True, slots=True)
class Wearer:
    """What is worn on the left, and what is declared of it."""

    fitted: Prosthesis | None
    patient: Patient = field(default_factory=partial(Patient, prosthetic_side="left"))


# an ankle with play is a prosthetic one that moves as a bare person's
WORN = {
    "person": Wearer(None, Patient()),
    "prosthesis": Wearer(NOT_STATED),
    "undeclared": Wearer(NOT_STATED, Patient()),
    "with play": Wearer(None),
}
FITTED = {
    "partial foot": Prosthesis(AmputationLevel.PARTIAL_FOOT),
    **{f"transtibial, {foot}": Prosthesis(AmputationLevel.TRANSTIBIAL, foot=foot) for foot in FootKind},
    **{f"transfemoral, {knee}": Prosthesis(AmputationLevel.TRANSFEMORAL, knee) for knee in KneeKind},
}
OF_SIDE, OF_LEVEL = "side alone", "stated"


def fitted_wearers() -> dict[str, dict[str, Wearer]]:
    """Of each prosthesis who states the side alone, and who states all of it."""
    return {
        name: {
            OF_SIDE: Wearer(one),
            OF_LEVEL: Wearer(one, Patient(prosthetic_side="left", prostheses={Side.LEFT: one})),
        }
        for name, one in FITTED.items()
    }


@dataclass(frozen=True, slots=True)
class Coverage:
    """Of one joint in one recording: `inside` and `samples` are numbers, the others mean squares, deg^2."""

    inside: int
    samples: int
    error: float
    sd: float


def coverages(settings: WalkerSettings, worn: Wearer) -> Iterator[tuple[str, Coverage]]:
    """What every joint's angle of one session is worth, by kind of joint and recording; of a wearer's, one leg's."""
    is_worn = worn.fitted is not None
    side, fitted = (Side.LEFT, worn.fitted) if worn.fitted is not None else (None, NOT_STATED)
    simulated = simulate(replace(settings, prosthetic_side=side, fitted=fitted))
    analysis = analyse(replace(simulated.session, patient=worn.patient))
    for recording in analysis.recordings:
        truths = simulated.truth.recordings[recording.name].joints
        for joint, angle in recording.joints.items():
            if (is_worn or worn.patient.prosthetic_sides) and joint.side is Side.RIGHT:
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
    arguments = options(__doc__, seeds=12, first=0, stated=False)
    seeds = range(arguments.first, arguments.first + arguments.seeds)
    for name in TISSUES:
        if arguments.stated:
            for worn, wearers in fitted_wearers().items():
                for declared, wearer in wearers.items():
                    _print(name, f"{worn}: {declared}", wearer, seeds)
            continue
        for worn, wearer in WORN.items():
            is_real = TISSUES[name][0] is Tissue.REAL
            if (worn == "with play" and name != "rigid") or (is_real and worn not in ("person", "prosthesis")):
                continue
            _print(name, worn, wearer, seeds)


def _print(name: str, worn: str, wearer: Wearer, seeds: range) -> None:
    tissue, turn_rad = TISSUES[name]
    found: dict[str, list[Coverage]] = defaultdict(list)
    for settings in SETTINGS.values():
        for seed in seeds:
            of_seed = replace(settings, seed=seed, tissue=tissue, tissue_turn_rad=turn_rad)
            for kind, coverage in coverages(of_seed, wearer):
                found[kind].append(coverage)
    for kind, many in found.items():
        print(f"{name:14s} {worn:40s} {kind:27s} {summary(many)}", flush=True)


def summary(many: list[Coverage]) -> str:
    pooled = sum(one.inside for one in many) / sum(one.samples for one in many)
    worst = min(one.inside / one.samples for one in many)
    ratio = np.sqrt(np.mean([one.sd for one in many]) / np.mean([one.error for one in many]))
    return f"{len(many):4d} joints  {100 * pooled:5.1f} %, worst {100 * worst:5.1f} %, sd/error {ratio:.2f}"


if __name__ == "__main__":
    main()
