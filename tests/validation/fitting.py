"""How true are the measures for fitting on simulated patients, and how large a change of them is found?

    python -m tests.validation.fitting [--people 20] [--sessions 0] [--first 0] [--tissue soft] [--optics]

The first table: bias of a walk's mean and the 90th percentile of its size, each leg of each person one. With
`--sessions` a second: walks that differ by 1.7 times a measure's error, and walks that do not differ at all.
"""

import argparse
import os
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.analysis import analyse
from core.body import Side
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.verdicts.measurement_error import ComparisonKind, Difference, Judgement, compare, mean_of_strides
from core.verdicts.quantities import FITTING, assessment_of, values_of
from devices.walker import (
    PEOPLE,
    FreeMotion,
    GaitChange,
    SimulatedSession,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)
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


CHANGES: Mapping[str, tuple[Callable[[float], GaitChange], str]] = {  # and the measure that is to show it
    "knee stop, peak in swing": (lambda x: GaitChange(knee_deg=x), "knee_swing_peak_deg"),
    "foot angle at toe-off": (lambda x: GaitChange(ankle_deg=x), "foot_heel_rise_deg"),
    "stance, foot flat": (lambda x: GaitChange(stance_percent=x), "foot_flat_percent"),
}


def told(seed: int, tissue: Tissue, change: GaitChange) -> dict[str, Difference]:
    """Walk 2 less walk 1 of the left leg, sensors left on, people's variation; by measure."""
    walks = (Walk("walk 1", strides=23), Walk("walk 2", strides=23, change=change, changed_side=Side.LEFT))
    recordings = (Standing(), FreeMotion(), *walks)
    made = simulate(WalkerSettings(seed=seed, tissue=tissue, recordings=recordings, variation=PEOPLE))
    one, other = analyse(made.session).recordings[-2:]
    found = {}
    for name in (*FITTING, "knee_swing_peak_deg", "knee_while_loading_deg"):
        mean, before = (
            mean_of_strides(values_of(walk, Side.LEFT, name)[walk.gait[Side.LEFT].strides.is_used])
            for walk in (other, one)
        )
        said = tuple(assessment_of(walk.verdicts, Side.LEFT, name) for walk in (other, one))
        speeds = [np.nanmean(values_of(walk, Side.LEFT, "speed_m_s")) for walk in (other, one)]
        apart = float(speeds[0] - speeds[1])
        found[name] = compare(name, ComparisonKind.ATTACHED, mean, before, said, speed_apart_m_s=apart)
    return found


def power(sessions: int, first: int, tissue: Tissue) -> Iterator[str]:
    """What is told where nothing changed, then how often changes of 1.7 times the usual error are found."""
    seeds = range(first, first + sessions)
    null = [told(seed, tissue, GaitChange()) for seed in seeds]
    judged = (Judgement.EXCEEDS_ERROR, Judgement.INSIDE_ERROR)
    for name in null[0]:
        some = [one[name] for one in null if one[name].judgement in judged]
        error = float(np.median([one.error for one in some])) if some else float("nan")
        yield f"| none | {name} | E {error:.2f} | told in {sum(one.exceeds for one in some)} of {len(some)} |"
    for title, (change, name) in CHANGES.items():
        error = float(np.median([one[name].error for one in null]))
        size = 1.7 * error
        middle = told(first, tissue, change(size))[name].difference - null[0][name].difference
        size *= size / middle if abs(middle) > 0.1 * size else 1.0  # the walker's change moves the measure by another
        some = [told(seed, tissue, change(size))[name] for seed in seeds]
        moved = float(np.median([one.difference for one in some]))
        found = sum(one.exceeds for one in some)
        said = f"moved {moved:.2f}, 1.7 E {1.7 * error:.2f} | found in {found} of {len(some)}"
        yield f"| {title}: {size:.2f} | {name} | {said} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--people", type=int, default=20)
    parser.add_argument("--sessions", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--tissue", type=Tissue, nargs="+", default=list(Tissue))
    parser.add_argument("--prosthetic", type=Side, default=None)
    parser.add_argument("--optics", action="store_true")
    wanted = parser.parse_args()
    if wanted.optics:
        data = Path(os.environ["GAITWRIGHT_TEST_DATA"])
        print("two feet beside optics: measure, strides, bias, sd, median, middle half")
        print(*feet_beside_optics(data), sep="\n", flush=True)
        print("mechanical hinge beside optics: lean, samples, rms")
        print(*hinges_beside_optics(data), sep="\n", flush=True)
    for tissue in wanted.tissue:
        if wanted.people:
            print(f"{tissue}: measure, legs, bias, p90", flush=True)
            print(*accuracy(wanted.people, wanted.first, tissue, wanted.prosthetic), sep="\n", flush=True)
        if wanted.sessions:
            print(f"{tissue}: change, measure, size, told", flush=True)
            print(*power(wanted.sessions, wanted.first, tissue), sep="\n", flush=True)


if __name__ == "__main__":
    main()
