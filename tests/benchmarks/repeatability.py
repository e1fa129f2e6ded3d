"""Coverage of the confidence limits that a clinic's own study of repeatability gives.

    python -m tests.benchmarks.repeatability [--clinics 200] [--people 20] [--strides 20]

Clinics are drawn: healthy people, each leg's sensors attached twice, strides with the spread and correlation of people,
and between attachments a known factor of the published sigma, alike in all columns of a leg by half of its variance.
Required: the true figure is within the limits in 95 of 100 clinics.
"""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from core.body import Side
from core.parameters import SPEED, QuantityKind
from core.samples import FloatArray
from core.verdicts.own_figures import PUBLISHED_SIGMAS
from core.verdicts.repeatability import COLUMNS, Strapping, repeatability_of
from core.verdicts.sigmas import HEALTHY_BETWEEN_LEGS
from core.verdicts.stride_means import mean_of_strides
from tests.driver import options

CORRELATION = 0.3
BETWEEN_PEOPLE = 0.06  # of a mean
BETWEEN_LEGS = 0.6  # natural asymmetry, of the published sigma
SHARED = 0.5  # of the variance between attachments, in all columns of a leg and kind
FACTORS = (0.7, 1.0, 1.5)  # of the published sigma, clinic by clinic
Z95 = 1.96


class Drawn(NamedTuple):
    """A column's usual mean, and its spread between strides."""

    mean: float
    sd: float


_BY_KIND = {
    QuantityKind.STANCE: Drawn(62.0, 1.0),
    QuantityKind.TIME: Drawn(1.08, 0.022),
    QuantityKind.SPEED: Drawn(1.2, 0.045),
    QuantityKind.LENGTH: Drawn(1.3, 0.035),
    QuantityKind.FOOT_PITCH: Drawn(20.0, 1.5),
    QuantityKind.HEEL_RISE: Drawn(60.0, 2.0),
    QuantityKind.FOOT_FLAT: Drawn(30.0, 2.5),
    QuantityKind.KNEE_TIMING: Drawn(96.0, 0.7),
}
_KNEE = {"knee_while_loading_deg": 13.0, "knee_straightening_deg": 11.0, "knee_loading_peak_deg": 18.0}


def drawn(column: str, kind: QuantityKind) -> Drawn:
    if kind in _BY_KIND:
        return _BY_KIND[kind]
    if kind in (QuantityKind.KNEE_SHAPE, QuantityKind.KNEE_HEIGHT, QuantityKind.KNEE_STRAIGHTENING):
        return Drawn(_KNEE.get(column, 60.0), 1.8)
    return Drawn(25.0, 1.6)


def strides(level: float, sd: float, n: int, rng: np.random.Generator) -> FloatArray:
    """Strides (n,) about a level, correlated as a first-order process."""
    noise = rng.normal(size=n + 20) * math.sqrt(1 - CORRELATION**2)
    return level + sd * np.asarray(lfilter([1.0], [1.0, -CORRELATION], noise))[20:]


def person(
    columns: Mapping[QuantityKind, Sequence[str]], factor: float, n: int, rng: np.random.Generator, times: int = 2
) -> list[Strapping]:
    """One person in two attachments, or more."""
    legs: list[dict[tuple[Side, str], FloatArray]] = [{} for _ in range(times)]
    speeds: list[FloatArray] = [np.empty(0) for _ in range(times)]
    for kind, of in columns.items():
        for side in (Side.LEFT,) if kind is QuantityKind.SPEED else tuple(Side):
            shared = rng.normal(size=times)
            for column in of:
                figure, published = drawn(column, kind), PUBLISHED_SIGMAS[kind]
                sigma = published.of(figure.mean)
                level = figure.mean + BETWEEN_LEGS * sigma * rng.normal()
                for k in range(times):
                    apart = math.sqrt(SHARED) * shared[k] + math.sqrt(1 - SHARED) * rng.normal()
                    found = strides(level + factor * sigma * apart, figure.sd, n, rng)
                    if kind is QuantityKind.SPEED:
                        speeds[k] = found
                    else:
                        legs[k][side, column] = found
    return [
        Strapping(
            {key: mean_of_strides(found) for key, found in legs[k].items()},
            {SPEED: mean_of_strides(speeds[k])} if len(speeds[k]) else {},
            drawn(SPEED, QuantityKind.SPEED).mean,
        )
        for k in range(times)
    ]


def coverage(
    columns: Mapping[QuantityKind, Sequence[str]], clinics: int, people: int, n: int, seed: int = 0
) -> dict[str, float]:
    """In how many of 1 clinics the limits hold the true figure, by kind of quantity and by column between legs."""
    rng = np.random.default_rng(seed)
    held: defaultdict[str, list[bool]] = defaultdict(list)
    for clinic in range(clinics):
        factor = FACTORS[clinic % len(FACTORS)]
        own = repeatability_of([person(columns, factor, n, rng) for _ in range(people)])
        for kind, found in own.sigmas.items():
            held[str(kind)].append(found.factor.holds(factor))
        for column, limit in own.healthy.items():
            kind = next(kind for kind, of in columns.items() if column in of)
            sigma = PUBLISHED_SIGMAS[kind].of(drawn(column, kind).mean)
            true = Z95 * sigma * math.sqrt(2) * math.hypot(BETWEEN_LEGS, factor)
            held[f"between legs: {column}"].append(limit.holds(true))
    return {name: sum(found) / len(found) for name, found in held.items()}


def main() -> None:
    args = options(__doc__, clinics=200, people=20, strides=(20, "of each leg in each attachment"))
    found = coverage(COLUMNS, args.clinics, args.people, args.strides)
    for name, share in found.items():
        print(f"{name:50} {100 * share:5.1f} %")
    of: dict[str, list[float]] = {"own sigmas": [], "between legs": []}
    for name, share in found.items():
        of["between legs" if name.startswith("between") else "own sigmas"].append(share)
    for name, shares in of.items():
        print(f"{name}: {100 * sum(shares) / len(shares):.1f} % of {len(shares)} x {args.clinics}; required 95 %")
    assert set(HEALTHY_BETWEEN_LEGS) - {"swing_percent"} == {
        name.removeprefix("between legs: ") for name in found if name.startswith("between")
    }


if __name__ == "__main__":
    main()
