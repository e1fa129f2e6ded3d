"""Accuracy of the measures for fitting on simulated patients.

    python -m tests.validation.fitting [--people 20] [--first 0] [--tissue soft] [--prosthetic left] [--optics]

Bias of a walk's mean and the 90th percentile of its size, each leg of each person one. Which changes of them are found
reports `fitting_power`.
"""

import os
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.analysis import analyse
from core.body import Side
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.verdicts.quantities import FITTING, values_of
from devices.simulation.walker import (
    FreeMotion,
    SimulatedSession,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)
from tests.driver import options
from tests.validation.fitting_optics import feet_beside_optics, hinges_beside_optics
from tests.validation.fitting_truth import true_strides

SAME_S = 0.15  # a stride is the true one whose contact lies so near
OLDER = (*("knee_while_loading_deg", "knee_loading_peak_deg", "knee_swing_peak_percent"),)


@dataclass(frozen=True, slots=True)
class Errors:
    """Of one leg in one walk: mean of what was found less the truth, by measure; and how many strides were read."""

    side: Side
    of_mean: Mapping[str, float]
    strides: int


def errors_of(made: SimulatedSession, walk: RecordingAnalysis) -> Iterator[Errors]:
    """Each leg's errors over the strides used."""
    for side, gait in walk.gait.items():
        true = true_strides(made, walk.name, side)
        starts = np.array([start for start, _ in true])
        used = np.flatnonzero(gait.strides.is_used)
        nearest = {k: int(np.argmin(np.abs(starts - gait.strides.start_s[k]))) for k in used.tolist()}
        matched = [k for k, n in nearest.items() if abs(starts[n] - gait.strides.start_s[k]) < SAME_S]
        found = {}
        for name in (*OLDER, *FITTING):
            apart = [_value(walk, side, name)[k] - true[nearest[k]][1][name] for k in matched]
            known = [value for value in apart if np.isfinite(value)]
            found[name] = float(np.mean(known)) if known else float("nan")
        yield Errors(side, found, len(matched))


def _value(walk: RecordingAnalysis, side: Side, name: str) -> FloatArray:
    if name == "knee_swing_peak_percent":
        return walk.gait[side].parameters[name]
    return values_of(walk, side, name)


def settings_of(seed: int, tissue: Tissue, prosthetic: Side | None = None) -> WalkerSettings:
    recordings = (Standing(), FreeMotion(), Walk(strides=14))
    return WalkerSettings(seed=seed, tissue=tissue, recordings=recordings, prosthetic_side=prosthetic)


def accuracy(people: int, first: int, tissue: Tissue, prosthetic: Side | None = None) -> Iterator[str]:
    """One row per measure; of prosthetic legs alone where `prosthetic` names one."""
    errors: dict[str, list[float]] = defaultdict(list)
    for seed in range(first, first + people):
        made = simulate(settings_of(seed, tissue, prosthetic))
        for one in errors_of(made, analyse(made.session).recordings[-1]):
            if prosthetic in (None, one.side):
                for name, value in one.of_mean.items():
                    errors[name].append(value)
    for name, values in errors.items():
        known = np.array(values)[np.isfinite(values)]
        if len(known):
            p90 = float(np.quantile(np.abs(known), 0.9))
            yield f"| {name} | {len(known)} of {len(values)} | {known.mean():+.2f} | {p90:.2f} |"
        else:
            yield f"| {name} | 0 of {len(values)} | - | - |"


def main() -> None:
    required = options(
        __doc__,
        people=20,
        first=0,
        tissue={"type": Tissue, "nargs": "+", "default": list(Tissue)},
        prosthetic={"type": Side, "default": None},
        optics=False,
    )
    if required.optics:
        data = Path(os.environ["GAITWRIGHT_TEST_DATA"])
        print("two feet beside optics: measure, strides, bias, sd, median, middle half")
        print(*feet_beside_optics(data), sep="\n", flush=True)
        print("mechanical hinge beside optics: lean, samples, rms")
        print(*hinges_beside_optics(data), sep="\n", flush=True)
    for tissue in required.tissue:
        if required.people:
            print(f"{tissue}: measure, legs, bias, p90", flush=True)
            print(*accuracy(required.people, required.first, tissue, required.prosthetic), sep="\n", flush=True)


if __name__ == "__main__":
    main()
