"""Changes of a prosthesis that the measures for fitting find, and what is given where nothing was changed.

    python -m tests.validation.fitting_power [--people 100] [--silent 200] [--first 0] [--tissue soft] [--processes 2]

Every person wears an above-knee prosthesis on the left, varies as people do and walks 23 strides, sensors left on.
First two walks that do not differ: how often is one of the measures reported as larger than its error, on either leg?
Then a walk as built and one with a change that moves the bones' own measure by 1.7 times the median of its errors: how
often is that found? The change is the one that needs the least share of what is plausible, its size that of each
person: by `fitting_truth`, which knows nothing of the core.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from multiprocessing.pool import Pool

import numpy as np

from core.analysis import analyse
from core.body import Side
from core.results import RecordingAnalysis
from core.verdicts.fitting import BY_COLUMN
from core.verdicts.measurement_error import Difference, Judgement, compare
from core.verdicts.quantities import assessment_of, values_of
from core.verdicts.sigmas import KINDS, ComparisonKind
from core.verdicts.stride_means import mean_of_strides
from devices.simulation.walker import (
    NO_CHANGE,
    PEOPLE,
    FreeMotion,
    GaitChange,
    ProsthesisSetting,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)
from tests.driver import options
from tests.validation.fitting_truth import true_strides

FACTOR = 1.7
STRIDES, FEW_STRIDES = 23, 8
SEEDS_OF_SIZES = (9001, 9002, 9003)
OF_BENCH = ("knee_swing_peak_deg", "knee_stance_to_swing_deg", "stance_percent")
MEASURES = tuple(name for name in (*BY_COLUMN, *OF_BENCH) if name in KINDS)
PROSTHETIC = Side.LEFT


@dataclass(frozen=True, slots=True)
class Change:
    """A change by `size`, from `least` to `most`, which are beyond what is plausible."""

    unit: str
    least: float
    most: float
    setting: Callable[[float], ProsthesisSetting] | None = None
    gait: Callable[[float], GaitChange] | None = None

    def walk(self, name: str, size: float, strides: int) -> Walk:
        setting = self.setting(size) if self.setting is not None else ProsthesisSetting()
        gait = self.gait(size) if self.gait is not None else NO_CHANGE
        return Walk(name, strides=strides, prosthesis=setting, change=gait, changed_side=PROSTHETIC)


CHANGES: Mapping[str, Change] = {
    "foot angle": Change("° plantar", -15.0, 15.0, lambda x: ProsthesisSetting(plantar_deg=x)),
    "foot shift": Change(" mm back", -60.0, 60.0, lambda x: ProsthesisSetting(back_mm=x)),
    "knee stop": Change("°", 0.0, 12.0, lambda x: ProsthesisSetting(stop_deg=x)),
    "extension": Change(" x resistance, log", -1.5, 1.5, lambda x: ProsthesisSetting(extension=math.exp(x))),
    "stance resistance": Change(" of flexion", -1.0, 0.0, lambda x: ProsthesisSetting(stance_flexion=1.0 + x)),
    "swing resistance": Change("° of peak", -25.0, 15.0, lambda x: ProsthesisSetting(swing_flexion_deg=x)),
    # no change of the prosthesis, but what a person does with another one
    "stance": Change(" points", -6.0, 6.0, gait=lambda x: GaitChange(stance_percent=x)),
    "stride length": Change(" of itself", -0.2, 0.15, gait=lambda x: GaitChange(length=x)),
    "stride time": Change(" of itself", -0.2, 0.2, gait=lambda x: GaitChange(time=x)),
}


def settings_of(seed: int, tissue: Tissue, walks: Sequence[Walk]) -> WalkerSettings:
    return WalkerSettings(
        seed=seed,
        tissue=tissue,
        recordings=(Standing(), FreeMotion(), *walks),
        variation=PEOPLE,
        prosthetic_side=PROSTHETIC,
    )


def differences(walk: RecordingAnalysis, before: RecordingAnalysis, side: Side) -> dict[str, Difference]:
    """The walk less the one before, by measure, as every page judges them."""
    found = {}
    for name in MEASURES:
        means = [mean_of_strides(values_of(one, side, name)[one.gait[side].strides.is_used]) for one in (walk, before)]
        stated = tuple(assessment_of(one.verdicts, side, name) for one in (walk, before))
        speeds = [float(np.nanmean(values_of(one, side, "speed_m_s"))) for one in (walk, before)]
        kind = ComparisonKind.ATTACHED
        found[name] = compare(name, kind, means[0], means[1], stated, speeds_m_s=(speeds[0], speeds[1]))
    return found


def silent(tissue: Tissue, seed: int) -> dict[Side, dict[str, Difference]]:
    """Two walks of one person between which nothing was changed."""
    walks = (Walk("walk 1", strides=STRIDES), Walk("walk 2", strides=STRIDES))
    one, other = analyse(simulate(settings_of(seed, tissue, walks)).session).recordings[-2:]
    return {side: differences(other, one, side) for side in Side}


def true_changes(seed: int, walks: Sequence[Walk]) -> list[dict[str, float]]:
    """By how much the bones' measures of each walk differ from those of the first, of a person who never varies."""
    made = simulate(WalkerSettings(seed=seed, recordings=(Standing(), *walks), prosthetic_side=PROSTHETIC))
    means = []
    for walk in walks:
        strides = [measures for _, measures in true_strides(made, walk.name, PROSTHETIC)]
        means.append({name: float(np.nanmean([one[name] for one in strides])) for name in strides[0]})
    return [{name: one[name] - means[0][name] for name in one} for one in means]


def sizes(errors: Mapping[str, float]) -> dict[str, tuple[str, float]]:
    """Of each measure the change that needs the least share of its range to move it by 1.7 errors, and its size."""
    steps = [
        (name, size)
        for name, change in CHANGES.items()
        for end in (change.least, change.most)
        for size in np.linspace(0.0, end, 5)[1:].tolist()
        if end
    ]
    walks = [Walk(strides=FEW_STRIDES, name="as built")]
    walks += [CHANGES[name].walk(f"{name} {size}", size, FEW_STRIDES) for name, size in steps]
    by_seed = [true_changes(seed, walks)[1:] for seed in SEEDS_OF_SIZES]
    found: dict[str, tuple[str, float]] = {}
    for measure, error in errors.items():
        required, best = FACTOR * error, math.inf
        before = (0.0, 0.0)
        for k, (name, size) in enumerate(steps):
            moved = abs(float(np.median([one[k].get(measure, math.nan) for one in by_seed])))
            if k == 0 or steps[k - 1][0] != name or steps[k - 1][1] * size < 0:
                before = (0.0, 0.0)
            end = CHANGES[name].most if size > 0 else CHANGES[name].least
            if before[1] < required <= moved:
                needed = before[0] + (size - before[0]) * (required - before[1]) / (moved - before[1])
                share = abs(needed / end) + (0.0 if CHANGES[name].setting is not None else 1.0)
                if share < best:
                    best, found[measure] = share, (name, needed)
            before = (size, moved)
    return found


def changed(
    tissue: Tissue, required: Mapping[str, tuple[str, float]], errors: Mapping[str, float], seed: int
) -> dict[str, tuple[float, float, Difference]]:
    """By measure its change's size for this person, by how much it moved the bones, and what was reported."""

    def walks(of: Mapping[str, float], strides: int) -> list[Walk]:
        made = [CHANGES[required[measure][0]].walk(measure, size, strides) for measure, size in of.items()]
        return [Walk("as built", strides=strides), *made]

    first = {measure: size for measure, (_, size) in required.items()}
    own = {}
    for (measure, size), moved in zip(first.items(), true_changes(seed, walks(first, FEW_STRIDES))[1:], strict=True):
        change = CHANGES[required[measure][0]]
        share = FACTOR * errors[measure] / max(abs(moved[measure]), 1e-9)
        own[measure] = float(np.clip(size * float(np.clip(share, 0.5, 2.0)), change.least, change.most))
    moved_by = true_changes(seed, walks(own, FEW_STRIDES))[1:]
    analysis = analyse(simulate(settings_of(seed, tissue, walks(own, STRIDES))).session)
    built, *others = analysis.recordings[-len(own) - 1 :]
    return {
        measure: (own[measure], moved[measure], differences(walk, built, PROSTHETIC)[measure])
        for measure, moved, walk in zip(own, moved_by, others, strict=True)
    }


def tables(people: range, silent_people: range, tissue: Tissue, pool: Pool) -> Iterator[str]:
    nulls = list(pool.imap(partial(silent, tissue), silent_people))
    judged = (Judgement.EXCEEDS_ERROR, Judgement.INSIDE_ERROR)
    errors, reported = {}, {}
    for name in MEASURES:
        counts = []
        for side in Side:
            some = [one[side][name] for one in nulls if one[side][name].judgement in judged]
            counts.append(f"{sum(one.exceeds for one in some)} of {len(some)}")
            if side is PROSTHETIC and some:
                errors[name] = float(np.median([one.error for one in some]))
                sd = float(np.std([one.difference for one in some]))
                counts.append(f"{sd:.2f}")
        reported[name] = counts
    required = sizes(errors)
    powers = list(pool.imap(partial(changed, tissue, required, errors), people))
    for name in MEASURES:
        sides = f"{reported[name][0]} | {reported[name][-1]}"
        head = f"| {name} | {errors.get(name, math.nan):.2f} | {reported[name][1]} | {sides} |"
        if name not in required:
            yield f"{head} no change moves it so far | - | - |"
            continue
        of_name = [one[name] for one in powers]
        some = [difference for _, _, difference in of_name if difference.judgement in judged]
        size = float(np.median([one for one, _, _ in of_name])) if of_name else required[name][1]
        moved = float(np.median([abs(one) for _, one, _ in of_name])) if of_name else math.nan
        change = f"{required[name][0]} {size:+.2f}{CHANGES[required[name][0]].unit}"
        not_judged = f", {len(of_name) - len(some)} not judged" if len(some) < len(of_name) else ""
        yield f"{head} {change} | {moved:.2f} | {sum(one.exceeds for one in some)} of {len(some)}{not_judged} |"


def main() -> None:
    required = options(
        __doc__,
        people=100,
        silent=200,
        first=0,
        tissue={"type": Tissue, "nargs": "+", "default": [Tissue.SOFT, Tissue.REAL]},
        processes=2,
    )
    people = range(required.first + 10_000, required.first + 10_000 + required.people)
    silent_people = range(required.first, required.first + required.silent)
    with get_context("spawn").Pool(required.processes) as pool:
        for tissue in required.tissue:
            print(f"{tissue}: measure, E, sd of null, told of nothing (prosthetic, sound), change, moved, found")
            print(*tables(people, silent_people, tissue, pool), sep="\n", flush=True)


if __name__ == "__main__":
    main()
