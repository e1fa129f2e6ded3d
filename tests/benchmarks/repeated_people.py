"""Pairs of measurements of the same people, from the shared recordings, and two rules that call them different.

`before` is the rule until 5ff57b15, whose constants stand here as numbers; `after` is `compare` of the core.
"""

import csv
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from statistics import fmean
from typing import NamedTuple

from core.parameters import SPEED, STANCE
from core.verdicts.measurement_error import UNKNOWN, Z95, Mark, Speeds, compare
from core.verdicts.model import READ
from core.verdicts.sigmas import ComparisonKind
from core.verdicts.stride_means import MIN_CORRELATION, MeanOfStrides

FOOT_ANGLE, HEEL_RISE, FOOT_FLAT = "foot_pitch_at_contact_deg", "foot_heel_rise_deg", "foot_flat_percent"
LENGTH, TIME = "stride_length_m", "stride_time_s"
HEALTHY, STROKE = "felius_Healthy", "felius_Stroke"
KNEES = {  # of the other maker's columns
    "knee_range_deg": ("K6", ""),
    "knee_stance_to_swing_deg": ("K5", "K3"),
    "knee_while_loading_deg": ("K2", "K1"),
    "knee_straightening_deg": ("K2", "K3"),
    "knee_swing_peak_deg": ("K5", ""),
    "knee_at_initial_contact_deg": ("K1", ""),
}
KNEE_STRIDES_SD_DEG = 1.8  # where a file has no spread


@dataclass(frozen=True, slots=True)
class Repeated:
    """One quantity at an earlier and a later time, or of the right leg and the left; `side` empty: of both legs."""

    person: str
    side: str
    quantity: str
    earlier: MeanOfStrides
    later: MeanOfStrides
    speeds_m_s: Speeds = UNKNOWN
    kind: ComparisonKind = ComparisonKind.VISITS

    def with_change(self, change: float) -> "Repeated":
        return replace(self, later=replace(self.later, mean=self.later.mean + change))


class Call(NamedTuple):
    """What a rule makes of a pair: later less earlier, whether tables mark it, whether page one states it.

    Between legs a mark is what exceeds healthy legs as well.
    """

    difference: float
    is_marked: bool
    is_on_page_one: bool
    is_beyond_speed: bool = False


Rule = Callable[[Repeated], Call]


class Old(NamedTuple):
    """Until 5ff57b15: least error, or sigma of one mean in percent, and what a metre per second of speed added.

    `factor`: what page one needed; infinite where it was silent.
    """

    error: float
    percent: float = 0.0
    per_speed: float = 0.0
    factor: float = 1.5


_SHAPE, _HEIGHT = Old(9.2, per_speed=11.0, factor=1.0), Old(12.4, per_speed=11.0, factor=1.0)
_FOOT = Old(9.2, per_speed=11.0, factor=math.inf)
_BETWEEN_TIMES: Mapping[str, Old] = {
    STANCE: Old(3.0 * 1.96 * math.sqrt(2), per_speed=4.8),
    TIME: Old(0.0, percent=4.0),
    SPEED: Old(0.20),
    LENGTH: Old(0.0, percent=5.0),
    FOOT_ANGLE: _FOOT,
    HEEL_RISE: _FOOT,
    FOOT_FLAT: Old(3.0 * 1.96 * math.sqrt(2), per_speed=4.8, factor=math.inf),
    **{name: _SHAPE if other or "range" in name else _HEIGHT for name, (_, other) in KNEES.items()},
}
_BETWEEN_LEGS: Mapping[str, Old] = {STANCE: Old(2.5), FOOT_ANGLE: _FOOT, HEEL_RISE: _FOOT}


def before(pair: Repeated) -> Call:
    one, other = pair.later, pair.earlier
    difference = one.mean - other.mean
    old = (_BETWEEN_LEGS if pair.kind is ComparisonKind.LEGS else _BETWEEN_TIMES).get(pair.quantity)
    if old is None:
        return Call(difference, False, False)
    relative = Z95 * math.sqrt(2) * 0.01 * old.percent * 0.5 * abs(one.mean + other.mean)
    change_m_s = pair.speeds_m_s[1] - pair.speeds_m_s[0]
    by_speed = 0.0 if math.isnan(change_m_s) else Z95 * old.per_speed * change_m_s
    error = math.hypot(Z95 * one.uncertainty, Z95 * other.uncertainty, by_speed, old.error, relative)
    return Call(difference, abs(difference) > error, abs(difference) > old.factor * error)


def after(pair: Repeated) -> Call:
    speeds = pair.speeds_m_s[1], pair.speeds_m_s[0]
    found = compare(pair.quantity, pair.kind, pair.later, pair.earlier, (READ, READ), speeds_m_s=speeds)
    is_marked = found.mark is Mark.HEALTHY if pair.kind is ComparisonKind.LEGS else found.exceeds
    rest = found.by_speed
    is_beyond = is_marked if rest is None else abs(rest.beyond) > rest.error
    return Call(found.difference, is_marked, found.is_worth_a_sentence, is_beyond)


Means = Mapping[tuple[str, str], MeanOfStrides]
"""Of one visit, by side and quantity."""


def two_visits(folder: Path, which: str) -> list[Repeated]:
    """The pairs of one set of felius_two_visits.csv."""
    return [pair for who, visits in _visits(folder, which).items() for pair in _pairs(who, *visits)]


def legs_of_visits(folder: Path, which: str) -> list[Repeated]:
    """Left less right at each of the two visits, of what is compared between legs."""
    found = []
    for who, visits in _visits(folder, which).items():
        for means in visits:
            speed_m_s = _speed(means).mean
            for quantity in (STANCE, FOOT_ANGLE, HEEL_RISE, FOOT_FLAT):
                legs = means.get(("right", quantity)), means.get(("left", quantity))
                if legs[0] is not None and legs[1] is not None:
                    pair = Repeated(who, "", quantity, legs[0], legs[1], (speed_m_s, speed_m_s), ComparisonKind.LEGS)
                    found.append(pair)
    return found


def walks_of_visits(folder: Path, which: str) -> list[tuple[float, tuple[float, ...]]]:
    """Speed and stance of both legs of every walk."""
    return [
        (_speed(means).mean, tuple(means[side, STANCE].mean for side in ("left", "right") if (side, STANCE) in means))
        for visits in _visits(folder, which).values()
        for means in visits
    ]


def rehabilitation(folder: Path) -> tuple[list[Repeated], list[Repeated]]:
    """From each visit to the next, and from the first to the last, each with a walking aid or without."""
    courses: dict[tuple[str, str], dict[int, dict[tuple[str, str], MeanOfStrides]]] = {}
    for row in _rows(folder / "felius_rehabilitation.csv"):
        visits = courses.setdefault((row["person"], row["aid"]), {})
        visits.setdefault(int(row["visit"]), {})[row["side"], row["quantity"]] = _mean(row, "")
    following: list[Repeated] = []
    whole: list[Repeated] = []
    for (person, aid), visits in courses.items():
        course, who = [visits[number] for number in sorted(visits)], f"{person}, aid: {aid}"
        following += [pair for one, other in pairwise(course) for pair in _pairs(who, one, other)]
        whole += _pairs(who, course[0], course[-1]) if len(course) > 1 else ()
    return following, whole


def other_knees(folder: Path) -> list[Repeated]:
    """Knees on two days with another maker's sensors; of their strides nothing is known, so chance counts as none."""
    with (folder / "technaid_knee.csv").open(encoding="utf-8-sig", newline="") as file:
        people = [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file, delimiter=";")]
    found = []
    for number, person in enumerate(people):
        for quantity, (more, less) in KNEES.items():
            days = [person[f"{more}{day}"] - (person[f"{less}{day}"] if less else 0.0) for day in ("", "_2")]
            earlier, later = (MeanOfStrides(value, math.nan, 20, 0.0, 0.0) for value in days)
            found.append(Repeated(str(number), "", quantity, earlier, later))
    return found


def simulated_knees(folder: Path) -> list[Repeated]:
    """Knees of simulated bodies strapped again, walks of free motion and enough strides."""
    means: dict[tuple[str, ...], MeanOfStrides] = {}
    for row in _rows(folder / "simulated_strappings.csv"):
        if row["mode"] == "free" and row["quantity"] in KNEES:
            n = int(row["n"])
            error = KNEE_STRIDES_SD_DEG * math.sqrt((1 + MIN_CORRELATION) / (1 - MIN_CORRELATION) / n)
            key = (row["body"], row["walk"], row["side"], row["quantity"], row["strapping"])
            means[key] = MeanOfStrides(float(row["measured"]), KNEE_STRIDES_SD_DEG, n, error, 0.0)
    return [
        Repeated(body, side, quantity, mean, means[body, walk, side, quantity, "1"], kind=ComparisonKind.STRAPPINGS)
        for (body, walk, side, quantity, strapping), mean in means.items()
        if strapping == "0"
    ]


def _visits(folder: Path, which: str) -> dict[str, tuple[Means, Means]]:
    found: dict[str, tuple[dict[tuple[str, str], MeanOfStrides], dict[tuple[str, str], MeanOfStrides]]] = {}
    for row in _rows(folder / "felius_two_visits.csv"):
        if row["set"] == which:
            for means, end in zip(found.setdefault(row["person"], ({}, {})), ("_1", "_2"), strict=True):
                means[row["side"], row["quantity"]] = _mean(row, end)
    return dict(found)


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _mean(row: Mapping[str, str], end: str) -> MeanOfStrides:
    mean, sd, n, error, drift = (float(row[f"{name}{end}"]) for name in ("mean", "sd", "n", "se", "drift"))
    return MeanOfStrides(mean, sd, int(n), error, drift)


def _pairs(who: str, one: Means, other: Means) -> Iterator[Repeated]:
    """Of what both visits hold; speed is of both legs, as the program compares it."""
    earlier, later = _speed(one), _speed(other)
    speeds = earlier.mean, later.mean
    yield Repeated(who, "", SPEED, earlier, later, speeds)
    for side, quantity in one:
        if quantity != SPEED and (side, quantity) in other:
            yield Repeated(who, side, quantity, one[side, quantity], other[side, quantity], speeds)


def _speed(means: Means) -> MeanOfStrides:
    """Both legs walk at one speed: what is uncertain of one goes with the other."""
    legs: Sequence[MeanOfStrides] = [mean for (_, quantity), mean in means.items() if quantity == SPEED]
    mean, sd, error, drift = (
        fmean(getattr(leg, name) for leg in legs) for name in ("mean", "sd", "standard_error", "drift")
    )
    return MeanOfStrides(mean, sd, min(leg.n for leg in legs), error, drift)
