"""How well a foot's set angle is measured between two walks with the sensors left on.

    python -m tests.benchmarks.set_angles [--people 40] [--first 0] [--set 2.0] [--processes 2]

Every person wears an above-knee prosthesis on the left, varies as people do and walks 23 strides three times: as built,
as built once more, and with the foot plantarflexed by `--set`. Printed: how far what is measured is from what was set,
in how many it is within 0.7 deg, and in how many of the pairs without a change the interval holds nothing.
"""

import argparse
from functools import partial
from multiprocessing import get_context

import numpy as np

from core.analysis import analyse
from core.body import Side
from core.results import RecordingAnalysis
from core.verdicts.measurement_error import Difference, compare
from core.verdicts.quantities import assessment_of, values_of
from core.verdicts.sigmas import ComparisonKind
from core.verdicts.stride_means import mean_of_strides
from devices.simulation.walker import (
    PEOPLE,
    FreeMotion,
    ProsthesisSetting,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)

COLUMN = "shank_to_foot_in_swing_deg"
NEAR_DEG = 0.7


def difference(walk: RecordingAnalysis, before: RecordingAnalysis) -> Difference:
    """How much more the foot is dorsiflexed than in the walk before, as the bench judges it."""
    means = [
        mean_of_strides(values_of(one, Side.LEFT, COLUMN)[one.gait[Side.LEFT].strides.is_used])
        for one in (walk, before)
    ]
    stated = tuple(assessment_of(one.verdicts, Side.LEFT, COLUMN) for one in (walk, before))
    return compare(COLUMN, ComparisonKind.ATTACHED, means[0], means[1], stated)


def fitted(set_deg: float, seed: int) -> tuple[Difference, Difference]:
    """What is measured of one person where nothing was changed, and where the foot was set."""
    settings = (0.0, 0.0, set_deg)
    walks = [
        Walk(f"walk {k}", strides=23, prosthesis=ProsthesisSetting(plantar_deg=one)) for k, one in enumerate(settings)
    ]
    session = simulate(
        WalkerSettings(
            seed=seed,
            tissue=Tissue.SOFT,
            recordings=(Standing(), FreeMotion(), *walks),
            variation=PEOPLE,
            prosthetic_side=Side.LEFT,
        )
    ).session
    built, again, changed = analyse(session).recordings[-3:]
    return difference(again, built), difference(changed, built)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--people", type=int, default=40)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--set", type=float, default=2.0, help="plantarflexion, deg")
    parser.add_argument("--processes", type=int, default=2)
    required = parser.parse_args()
    people = range(required.first + 20_000, required.first + 20_000 + required.people)
    with get_context("spawn").Pool(required.processes) as pool:
        found = pool.map(partial(fitted, required.set), people)
    nothing, changed = zip(*found, strict=True)
    silent = np.array([one.difference for one in nothing])
    off = np.array([-one.difference for one in changed]) - required.set
    errors = np.array([one.error for one in changed])
    print(f"{len(found)} people, {np.isfinite(off).sum()} reported; interval of {np.nanmedian(errors):.2f} deg")
    print(
        f"nothing set: SD {np.nanstd(silent):.2f} deg, stated as nothing in {sum(not one.exceeds for one in nothing)}"
    )
    near = int(np.sum(np.abs(off) <= NEAR_DEG))
    print(f"{required.set:g} deg set: {np.nanmean(off):+.2f} ({np.nanstd(off):.2f}) deg off, within {NEAR_DEG}: {near}")


if __name__ == "__main__":
    main()
