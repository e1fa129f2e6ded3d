"""Size of a true change that is called larger than its error in nine of ten comparisons.

    python -m tests.benchmarks.power [--draws 4000] [--sessions 40]

The table is computed from strides drawn with the spread and correlation of people and with the spread between walks,
strappings and visits that the error assumes. The sessions are whole: a simulated patient walks twice, the second time
with a change of known size, and both walks go through the analysis.
"""

import argparse
import math
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from app.summary.differences import comparisons_of, rows_of
from core.analysis import analyse
from core.body import Side
from core.samples import FloatArray
from core.verdicts.measurement_error import Judgement, compare
from core.verdicts.model import READ
from core.verdicts.sigmas import ComparisonKind, sigma_of
from core.verdicts.stride_means import mean_of_strides
from devices.simulation.walker import PEOPLE, FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate
from devices.simulation.walker_body import GaitChange

STRIDES = 20
CORRELATION = 0.3
REQUIRED = 0.9


@dataclass(frozen=True, slots=True)
class Figure:
    """A quantity's usual mean and spread between strides."""

    mean: float
    sd: float


FIGURES = {
    "knee_range_deg": Figure(60.0, 1.8),
    "knee_swing_peak_deg": Figure(62.0, 2.0),
    "ankle_range_deg": Figure(28.0, 1.8),
    "ankle_stance_dorsiflexion_deg": Figure(12.0, 1.5),
    "stance_percent": Figure(62.0, 1.0),
    "stride_time_s": Figure(1.08, 0.022),
    "speed_m_s": Figure(1.2, 0.045),
    "stride_length_m": Figure(1.3, 0.035),
}
KINDS = (ComparisonKind.ATTACHED, ComparisonKind.LEGS, ComparisonKind.STRAPPINGS, ComparisonKind.VISITS)


def strides(figure: Figure, level: float, rng: np.random.Generator, n: int = STRIDES) -> FloatArray:
    """Strides (n,) about `level`, correlated as a first-order process."""
    noise = rng.normal(size=n + 20)
    for k in range(1, len(noise)):
        noise[k] = CORRELATION * noise[k - 1] + math.sqrt(1 - CORRELATION**2) * noise[k]
    return level + figure.sd * noise[20:]


def found_share(name: str, kind: ComparisonKind, change: float, draws: int, seed: int = 0) -> float:
    """How often a true change is called larger than its error; with a change of 0, how often wrongly."""
    figure, sigma = FIGURES[name], sigma_of(name, kind)
    assert sigma is not None
    spread = sigma.of(figure.mean, SPEED_M_S)
    rng, found = np.random.default_rng(seed), 0
    for _ in range(draws):
        one, other = (
            mean_of_strides(strides(figure, figure.mean + rng.normal(0.0, spread) + more, rng))
            for more in (change, 0.0)
        )
        reported = compare(name, kind, one, other, (READ, READ), speeds_m_s=(SPEED_M_S, SPEED_M_S))
        found += reported.is_worth_a_sentence if is_on_page_one else _is_marked(reported, kind)
    return found / draws


def _is_marked(found: Difference, kind: ComparisonKind) -> bool:
    return found.mark is Mark.HEALTHY if kind is ComparisonKind.LEGS else found.exceeds


def smallest_found(name: str, kind: ComparisonKind, draws: int) -> float:
    """The smallest change found in nine of ten comparisons, by bisection."""
    least, most = 0.0, 40.0 * FIGURES[name].sd
    while most - least > 0.01 * FIGURES[name].sd:
        middle = 0.5 * (least + most)
        least, most = (least, middle) if found_share(name, kind, middle, draws) >= REQUIRED else (middle, most)
    return most


def table(draws: int) -> Iterator[str]:
    yield "| quantity | " + " | ".join(str(kind) for kind in KINDS) + " |"
    for name, figure in FIGURES.items():
        cells = []
        for kind in KINDS:
            if sigma_of(name, kind) is None:
                cells.append("-")
                continue
            change = smallest_found(name, kind, draws)
            share = f" ({100 * change / figure.mean:.0f} %)" if not name.endswith(("deg", "percent")) else ""
            false = 100.0 * found_share(name, kind, 0.0, draws, seed=1)
            cells.append(f"{change:.2f}{share}, {false:.1f} % false")
        yield f"| {name} | " + " | ".join(cells) + " |"


# changes of the left leg or of both, and the columns in which they show
CHANGES: Mapping[str, tuple[GaitChange, Side | None, str, float]] = {
    "6 deg of knee": (GaitChange(knee_deg=6.0), Side.LEFT, "knee_range_deg", 6.0),
    "6 deg of ankle": (GaitChange(ankle_deg=6.0), Side.LEFT, "ankle_range_deg", 6.0),
    "3 points of stance": (GaitChange(stance_percent=3.0), Side.LEFT, "stance_percent", 3.0),
    "12 % of stride length": (GaitChange(length=0.12), None, "stride_length_m", 0.12),
    "none": (GaitChange(), None, "knee_range_deg", 0.0),
}


@dataclass(frozen=True, slots=True)
class Outcome:
    """Whether the left leg's change was judged and found, its size and error; rows called larger beside it."""

    is_judged: bool
    is_found: bool
    difference: float
    error: float


def whole_session(seed: int, change: str, tissue: Tissue) -> Outcome:
    """One simulated patient with sensors left on, two walks."""
    gait_change, side, column, _ = CHANGES[change]
    walks = (Walk("walk 1", strides=STRIDES + 3), Walk("walk 2", strides=STRIDES + 3))
    changed = replace(walks[1], change=gait_change, changed_side=side)
    settings = WalkerSettings(
        seed=seed,
        tissue=tissue,
        recordings=(Standing(), FreeMotion(), walks[0], changed),
        variation=PEOPLE,
    )
    session = simulate(settings).session
    conditions = {"walk 1": "A", "walk 2": "B"}
    recordings = tuple(replace(one, condition=conditions.get(one.name, "")) for one in session.recordings)
    session = replace(session, recordings=recordings)
    found = comparisons_of([(session, analyse(session))])
    for row in (row for comparison in found for row in rows_of(comparison)):
        if row.side is Side.LEFT and row.parameter == column:
            reported = row.difference
            is_judged = reported.judgement in (Judgement.EXCEEDS_ERROR, Judgement.INSIDE_ERROR)
            return Outcome(is_judged, reported.exceeds, reported.difference, reported.error)
    return Outcome(False, False, math.nan, math.nan)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=4000)
    parser.add_argument("--sessions", type=int, default=40)
    parser.add_argument("--tissue", type=Tissue, default=Tissue.SOFT)
    parser.add_argument("--workers", type=int, default=1)
    required = parser.parse_args()
    if required.draws:
        print(*table(required.draws), sep="\n")
    with ProcessPoolExecutor(required.workers) as pool:
        for change in CHANGES if required.sessions else ():
            found = list(
                pool.map(partial(whole_session, change=change, tissue=required.tissue), range(required.sessions))
            )
            judged = [one for one in found if one.is_judged]
            share = 100.0 * sum(one.is_found for one in judged) / max(len(judged), 1)
            middle = [float(np.median([getattr(one, name) for one in judged])) for name in ("difference", "error")]
            print(f"{change:24} judged {len(judged)} of {len(found)}, larger in {share:.0f} %", end=", ")
            print(f"median difference {middle[0]:.2f}, error {middle[1]:.2f}")


if __name__ == "__main__":
    main()
