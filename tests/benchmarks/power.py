"""Size of a true change that is called larger than its error in nine of ten comparisons.

    python -m tests.benchmarks.power [--draws 2000] [--sessions 40]

The table is computed from strides drawn with the spread and correlation of people and with the spread between walks,
strappings and visits that the error assumes, in brackets for page one; legs with the asymmetry of healthy ones. The
sessions are whole: a simulated patient walks twice, the second time with a change of known size, and both walks go
through the analysis.
"""

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
from core.verdicts.measurement_error import Z95, Mark, compare
from core.verdicts.model import READ
from core.verdicts.sigmas import HEALTHY_BETWEEN_LEGS, ComparisonKind, sigma_of
from core.verdicts.stride_means import MeanOfStrides, mean_of_strides
from devices.simulation.walker import PEOPLE, FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate
from devices.simulation.walker_body import GaitChange
from tests.driver import options

STRIDES = 20
CORRELATION = 0.3
REQUIRED = 0.9
SPEED_M_S = 1.2


@dataclass(frozen=True, slots=True)
class Figure:
    """A quantity's usual mean and spread between strides."""

    mean: float
    sd: float


FIGURES = {  # feet: median of 25 healthy people; joints assumed
    "knee_stance_to_swing_deg": Figure(60.0, 2.0),
    "knee_while_loading_deg": Figure(14.0, 1.8),
    "knee_straightening_deg": Figure(14.0, 1.8),
    "knee_range_deg": Figure(60.0, 1.8),
    "knee_swing_peak_deg": Figure(62.0, 2.0),
    "ankle_push_off_deg": Figure(28.0, 1.8),
    "ankle_rocker_deg": Figure(24.0, 1.8),
    "ankle_range_deg": Figure(28.0, 1.8),
    "ankle_stance_dorsiflexion_deg": Figure(12.0, 1.5),
    "stance_percent": Figure(62.0, 1.0),
    "stride_time_s": Figure(1.08, 0.022),
    "speed_m_s": Figure(1.2, 0.045),
    "stride_length_m": Figure(1.3, 0.035),
    "foot_pitch_at_contact_deg": Figure(22.8, 2.4),
    "foot_heel_rise_deg": Figure(70.0, 1.9),
    "foot_flat_percent": Figure(22.6, 1.3),
}
KINDS = (ComparisonKind.ATTACHED, ComparisonKind.LEGS, ComparisonKind.VISITS)
# of one mean among healthy legs; of others it is what 95 of 100 stay below
SIGMA_OF_LEGS = {"knee_straightening_deg": 0.59, "knee_while_loading_deg": 1.54}
Means = tuple[MeanOfStrides, MeanOfStrides]


def strides(figure: Figure, level: float, rng: np.random.Generator, n: int = STRIDES) -> FloatArray:
    """Strides (n,) about `level`, correlated as a first-order process."""
    noise = rng.normal(size=n + 20)
    for k in range(1, len(noise)):
        noise[k] = CORRELATION * noise[k - 1] + math.sqrt(1 - CORRELATION**2) * noise[k]
    return level + figure.sd * noise[20:]


def drawn(name: str, kind: ComparisonKind, draws: int, seed: int = 0) -> list[Means]:
    """Pairs of means between which nothing differs but what people do."""
    figure, rng = FIGURES[name], np.random.default_rng(seed)
    spread = _spread(name, kind)

    def one() -> MeanOfStrides:
        return mean_of_strides(strides(figure, figure.mean + rng.normal(0.0, spread), rng))

    return [(one(), one()) for _ in range(draws)]


def _spread(name: str, kind: ComparisonKind) -> float:
    """Of one mean, in its unit."""
    if kind is ComparisonKind.LEGS:
        return SIGMA_OF_LEGS.get(name, HEALTHY_BETWEEN_LEGS[name] / (Z95 * math.sqrt(2)))
    sigma = sigma_of(name, kind)
    assert sigma is not None
    return sigma.of(FIGURES[name].mean, SPEED_M_S)


def found_share(name: str, kind: ComparisonKind, pairs: list[Means], change: float, *, is_page: bool = False) -> float:
    """How often a true change is marked, or stated on page one; with a change of 0, how often wrongly."""
    found = 0
    for one, other in pairs:
        changed = replace(one, mean=one.mean + change)
        reported = compare(name, kind, changed, other, (READ, READ), speeds_m_s=(SPEED_M_S, SPEED_M_S))
        is_marked = reported.mark is Mark.HEALTHY if kind is ComparisonKind.LEGS else reported.exceeds
        found += reported.is_worth_a_sentence if is_page else is_marked
    return found / len(pairs)


def smallest_found(name: str, kind: ComparisonKind, pairs: list[Means], *, is_page: bool = False) -> float:
    """The smallest change found in nine of ten comparisons, by bisection."""
    least, most = 0.0, 40.0 * FIGURES[name].sd
    while most - least > 0.02 * FIGURES[name].sd:
        middle = 0.5 * (least + most)
        is_found = found_share(name, kind, pairs, middle, is_page=is_page) >= REQUIRED
        least, most = (least, middle) if is_found else (middle, most)
    return most


def table(draws: int) -> Iterator[str]:
    """As markdown."""
    yield "| quantity | sensors left on | left against right | strapped again, or visits |"
    yield "|---|---|---|---|"
    for name in FIGURES:
        yield f"| {name} | " + " | ".join(_cell(name, kind, draws) for kind in KINDS) + " |"


def _cell(name: str, kind: ComparisonKind, draws: int) -> str:
    if sigma_of(name, kind) is None:
        return "-"
    pairs = drawn(name, kind, draws)
    least, on_page_one = (smallest_found(name, kind, pairs, is_page=is_page) for is_page in (False, True))
    decimals = 1 if name.endswith(("deg", "percent")) else 2
    dagger = " †" if compare(name, kind, *pairs[0], (READ, READ)).is_unverified else ""
    false = 100.0 * found_share(name, kind, drawn(name, kind, draws, seed=1), 0.0)
    page = "" if kind is ComparisonKind.LEGS else f" ({on_page_one:.{decimals}f})"
    return f"{least:.{decimals}f}{page}{dagger}, {false:.0f} % false"


# changes of the left leg or of both, and the columns in which they show
CHANGES: Mapping[str, tuple[GaitChange, Side | None, str, float]] = {
    "6 deg of knee": (GaitChange(knee_deg=6.0), Side.LEFT, "knee_range_deg", 6.0),
    "6 deg of ankle": (GaitChange(ankle_deg=6.0), Side.LEFT, "ankle_range_deg", 6.0),
    "4 points of stance": (GaitChange(stance_percent=4.0), Side.LEFT, "stance_percent", 4.0),
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
            return Outcome(reported.is_judged, reported.exceeds, reported.difference, reported.error)
    return Outcome(False, False, math.nan, math.nan)


def main() -> None:
    required = options(__doc__, draws=2000, sessions=40, tissue={"type": Tissue, "default": Tissue.SOFT}, workers=1)
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
