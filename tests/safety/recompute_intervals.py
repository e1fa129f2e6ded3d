"""Recompute every interval of an output folder from its tables. Nothing of the program is imported.

    python tests/safety/recompute_intervals.py FOLDER [FOLDER ...]

Of each row of differences.csv, visits.csv and sides.csv: the difference is that of the means, `low` and `high` lie an
error to either side of it, `verdict`, `mark` and the part beyond speed follow from them. Where strides of both means
are in the folder, mean, sd and n are theirs, and so is the error, with the figures below; what the lag between sensors
and the axis of a joint add is in no table, so that such an error is at least what is recomputed.
"""

import csv
import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

Z95 = 1.96
CELL = 2e-5  # five decimals are written
LEAST_CORRELATION, MOST_CORRELATION = 0.3, 0.9
FEWEST = 10  # strides of a mean that is judged
SLOW_M_S = 0.8
SPEED_REPORTED_M_S = 0.005
SLOPE_SD = 0.3
JUDGED = ("exceeds_error", "inside_error")
NOT_IN_TABLES = ("clock", "axis")
JOINED = "; "
Cells = Mapping[str, str]
Spread = tuple[float, float, float, float]
"""Of one mean: a constant, percent of the mean; both below SLOW_M_S."""


def _always(constant: float, percent: float = 0.0) -> Spread:
    return constant, percent, constant, percent


KINDS = {
    "stance": ("stance_percent", "swing_percent"),
    "time": ("stride_time_s", "step_time_s", "cadence_steps_min"),
    "length": ("stride_length_m",),
    "speed": ("speed_m_s",),
    "knee height": (
        *("knee_at_initial_contact_deg", "knee_loading_peak_deg", "knee_stance_minimum_deg", "knee_swing_peak_deg"),
        "knee_terminal_extension_deg",
    ),
    "knee shape": (
        *("knee_range_deg", "knee_while_loading_deg", "knee_stance_to_swing_deg"),
        *("shank_heel_rocker_deg", "shank_over_flat_foot_deg", "shank_forefoot_rocker_deg"),
    ),
    "knee straightening": ("knee_straightening_deg",),
    "ankle height": (
        *("ankle_at_initial_contact_deg", "ankle_loading_plantarflexion_deg", "ankle_stance_dorsiflexion_deg"),
        *("ankle_push_off_plantarflexion_deg", "ankle_swing_dorsiflexion_deg"),
    ),
    "ankle shape": (
        *("ankle_range_deg", "ankle_heel_rocker_deg", "ankle_rocker_deg", "ankle_push_off_deg"),
        "ankle_toes_lifted_deg",
    ),
    "knee timing": ("knee_extended_before_contact_percent",),
    "foot flat": ("foot_flat_percent",),
    "foot pitch": ("foot_pitch_at_contact_deg",),
    "heel rise": ("foot_heel_rise_deg",),
    "set angle": ("shank_to_foot_in_swing_deg",),  # between walks with the sensors left on alone
    "segment height": tuple(
        f"{segment}_at_{when}_deg"
        for segment in ("shank", "thigh")
        for when in ("initial_contact", "mid_stance", "toe_off")
    ),
}
KIND_OF = {column: kind for kind, columns in KINDS.items() for column in columns}
STRAPPED_AGAIN: Mapping[str, Spread] = {
    "stance": (1.1, 0.0, 1.5, 0.0),
    "time": (0.0, 2.7, 0.0, 5.5),
    "speed": _always(0.065),
    "length": (0.045, 0.0, 0.055, 0.0),
    "foot pitch": _always(2.0),
    "heel rise": _always(3.2),
    "foot flat": _always(4.8),
    "knee shape": _always(1.2, 4.3),
    "knee straightening": _always(2.4),
    "knee height": _always(2.2, 4.0),
    "segment height": _always(2.2, 4.0),
    "ankle shape": _always(3.3),
    "ankle height": _always(4.5),
    "knee timing": (1.1, 0.0, 1.5, 0.0),
}
LEFT_ON: Mapping[str, Spread] = {
    "set angle": _always(0.25),  # of 40 simulated fittings
    "stance": _always(0.55),
    "time": _always(0.0, 2.2),
    "speed": _always(0.045),
    "length": _always(0.022),
    "foot pitch": _always(0.5),
    "heel rise": _always(0.9),
    "foot flat": _always(4.0),
    "knee shape": _always(1.0),
    "knee straightening": _always(1.0),
    "knee height": _always(1.2),
    "segment height": _always(1.2),
    "ankle shape": _always(1.0),
    "ankle height": _always(1.2),
    "knee timing": _always(0.55),
}
STEPS_OF_LEGS = _always(0.018)
NOT_BETWEEN_LEGS = ("speed", "length", "time")
HEALTHY = {
    "stance_percent": 4.0,
    "swing_percent": 4.0,
    "foot_pitch_at_contact_deg": 6.1,
    "foot_heel_rise_deg": 8.5,
    "foot_flat_percent": 8.5,
    "knee_range_deg": 10.2,
    "knee_stance_to_swing_deg": 10.5,
    "knee_while_loading_deg": 4.4,
    "knee_straightening_deg": 2.8,
    "knee_at_initial_contact_deg": 7.8,
    "knee_loading_peak_deg": 8.1,
    "knee_stance_minimum_deg": 8.3,
    "knee_swing_peak_deg": 13.5,
    "ankle_range_deg": 6.2,
    "ankle_rocker_deg": 6.4,
    "ankle_push_off_deg": 7.7,
    "ankle_toes_lifted_deg": 7.0,
    "ankle_heel_rocker_deg": 4.6,
    "ankle_at_initial_contact_deg": 7.9,
    "ankle_stance_dorsiflexion_deg": 6.1,
    "ankle_push_off_plantarflexion_deg": 10.4,
    "ankle_swing_dorsiflexion_deg": 10.0,
}
SLOPES = {  # per m/s below SLOW_M_S and above, and what one mean differs by beside it at most
    "stance_percent": (-18.0, -5.0, 1.1),
    "swing_percent": (18.0, 5.0, 1.1),
    "foot_pitch_at_contact_deg": (12.0, 8.0, 1.8),
    "foot_heel_rise_deg": (33.0, 15.0, 2.6),
    "stride_length_m": (0.86, 0.58, math.inf),
    **dict.fromkeys(("knee_range_deg", "knee_stance_to_swing_deg", "knee_swing_peak_deg"), (11.0, 11.0, math.inf)),
}


class Folder:
    """The strides and speeds of an output folder."""

    def __init__(self, path: Path) -> None:
        self.path = path
        summary = json.loads((path / "summary.json").read_text(encoding="utf-8"))
        walks = summary["walks"].items()
        self.speeds: dict[str, float | None] = {name: (one.get("both") or {}).get("speed_m_s") for name, one in walks}
        self.has_published_figures = (summary.get("error_figures") or {}).get("source", "published") == "published"
        self._peaks = _rows(path / "peaks.csv") if (path / "peaks.csv").exists() else []

    def values(self, walks: str, side: str, column: str) -> list[float] | None:
        """Of the strides used of some walks, in order; None where the folder does not hold them."""
        if column == "cadence_steps_min":
            times = self.values(walks, side, "stride_time_s")
            return None if times is None else [120.0 / one for one in times]
        found: list[float] = []
        for walk in walks.split(JOINED):
            if walk not in self.speeds or not (self.path / walk.replace(" ", "_") / "strides.csv").exists():
                return None
            folder = walk.replace(" ", "_")
            tables = [_rows(self.path / folder / name) for name in ("strides.csv", "fitting.csv")]
            tables.append([row for row in self._peaks if row["recording"] == folder])
            table = next((rows for rows in tables if rows and column in rows[0]), None)
            if table is None:
                return None
            used = [row[column] for row in table if row["side"] == side and row["used"] == "true"]
            found += [float(cell) for cell in used if cell]
        return found

    def speed(self, walks: str) -> float:
        """Of some walks, their mean; NaN where not reported."""
        known = [speed for one in walks.split(JOINED) if (speed := self.speeds.get(one)) is not None]
        return sum(known) / len(known) if known else math.nan


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        return list(csv.DictReader(file))


def uncertainty(values: Sequence[float]) -> float:
    """Of a mean over strides: correlated chance, and drift of the halves or thirds beyond it."""
    n, mean = len(values), sum(values) / len(values)
    apart = [one - mean for one in values]
    total = sum(one * one for one in apart)
    if not total:
        return 0.0
    r = sum(a * b for a, b in pairwise(apart)) / total
    r = min(max(LEAST_CORRELATION, r), MOST_CORRELATION)
    plain = math.sqrt(total / (n - 1) / n)
    error = plain * math.sqrt((1 + r) / (1 - r))
    drift = 0.0
    for parts, by_chance in ((2, 1.0), (3, 2.5)):
        means = [sum(part) / len(part) for part in _split(values, parts) if part]
        drift = max(drift, 0.25 * (max(means) - min(means)) ** 2 - by_chance * plain * error)
    return math.sqrt(error**2 + drift)


def _split(values: Sequence[float], parts: int) -> list[Sequence[float]]:
    """Parts as equal as may be, the first ones longer by one."""
    length, longer = divmod(len(values), parts)
    edges = [k * length + min(k, longer) for k in range(parts + 1)]
    return [values[a:b] for a, b in pairwise(edges)]


def sigma(spread: Spread, mean: float, speed_m_s: float) -> float:
    constant, percent = spread[2:] if speed_m_s < SLOW_M_S else spread[:2]
    return math.hypot(constant, 0.01 * percent * mean)


def _number(cell: str) -> float:
    return float(cell) if cell else math.nan


def _differs(one: float, other: float, rounding: float = CELL) -> bool:
    return math.isnan(one) != math.isnan(other) or abs(one - other) > rounding + 1e-4 * abs(other)


def structure_faults(row: Cells, first: str, second: str, *, is_legs: bool) -> Iterator[str]:
    """What of a row does not follow from the row itself; `first` and `second` are the names of its two means."""
    figures = {name: _number(row[name]) for name in ("difference", "error", "low", "high", "healthy_limit")}
    difference, error = figures["difference"], figures["error"]
    expected = _number(row[first]) - _number(row[second])  # of curves there are no means
    if not math.isnan(difference) and not math.isnan(expected) and _differs(difference, expected):
        yield "the difference is not that of the means"
    is_judged = row["verdict"] in JUDGED
    if is_judged is math.isnan(error):
        yield "error and verdict do not agree"
    for name, edge in (("low", difference - error), ("high", difference + error)):
        if _differs(figures[name], edge):
            yield f"{name} is {figures[name]:g}, expected {edge:g}"
    if is_judged:
        exceeds = not figures["low"] <= 0 <= figures["high"]
        if abs(abs(difference) - error) > CELL and exceeds is not (row["verdict"] == "exceeds_error"):
            yield f"0 is {'not ' * exceeds}within, the verdict is {row['verdict']}"
        is_healthy = is_legs and abs(difference) > figures["healthy_limit"]
        mark = ("beyond_healthy" if is_healthy else "beyond_error") if exceeds else ""
        if row["mark"] != mark:
            yield f"the mark is {row['mark']!r}, expected {mark!r}"
    elif row["mark"]:
        yield "a mark without a judgement"
    beyond, low, high = (_number(row[name]) for name in ("beyond_speed", "beyond_speed_low", "beyond_speed_high"))
    if not math.isnan(beyond) and _differs(beyond - low, high - beyond, 2 * CELL):
        yield "what is beyond speed is not in the middle of its interval"


def recomputed_faults(
    row: Cells, means: tuple[Sequence[float], Sequence[float]], speeds: tuple[float, float], spread: Spread
) -> Iterator[str]:
    """What the strides of both means show otherwise."""
    own = math.hypot(*map(uncertainty, means))
    column, is_legs = row["parameter"], "against_mean" not in row
    sizes = [sum(one) / len(one) for one in means]
    sigmas = [sigma(spread, size, speed) for size, speed in zip(sizes, speeds, strict=True)]
    between, healthy = math.hypot(*sigmas), HEALTHY.get(column, math.nan) if is_legs else math.nan
    if healthy / Z95 < between:
        between = healthy / Z95
    checked = [("error", Z95 * math.hypot(own, between), _number(row["error"]))]
    if is_legs:
        checked.append(("healthy_limit", math.hypot(healthy, Z95 * own), _number(row["healthy_limit"])))
    elif column in SLOPES and abs(speeds[0] - speeds[1]) >= SPEED_REPORTED_M_S:
        slow, other, most = SLOPES[column]
        of_speed = (slow if 0.5 * sum(speeds) < SLOW_M_S else other) * (speeds[0] - speeds[1])
        beyond = _number(row["beyond_speed"])
        if _differs(beyond, sizes[0] - sizes[1] - of_speed):
            yield f"beyond speed is {beyond:g}, expected {sizes[0] - sizes[1] - of_speed:g}"
        rest = Z95 * math.hypot(own, *(min(one, most) for one in sigmas), SLOPE_SD * of_speed)
        checked.append(("beyond_speed", rest, _number(row["beyond_speed_high"]) - beyond))
    is_least = any(one in row["error_sources"].split() for one in NOT_IN_TABLES)
    for name, expected, reported in checked:
        if math.isnan(expected) or math.isnan(reported):
            if math.isnan(expected) != math.isnan(reported):
                yield f"{name} is {reported}, expected {expected:g}"
        elif reported < expected - 2 * CELL - 2e-4 * expected or (not is_least and _differs(reported, expected)):
            yield f"{name} is {reported:g}, expected {'at least ' * is_least}{expected:g}"


def mean_faults(values: Sequence[float], row: Cells, head: str) -> Iterator[str]:
    """Whether `n`, `mean` and `sd` of a row are those of the strides."""
    mean = sum(values) / len(values)
    sd = math.sqrt(sum((one - mean) ** 2 for one in values) / (len(values) - 1)) if len(values) > 1 else math.nan
    for name, expected in (("n", len(values)), ("mean", mean), ("sd", sd)):
        if _differs(_number(row[head + name]), expected):
            yield f"{head}{name} is {row[head + name]}, that of the strides {expected:g}"


def differences_faults(folder: Folder, table: str, found: Counter[str]) -> Iterator[str]:
    """Of differences.csv, or of the table of visits, whose earlier strides are in another folder."""
    rows = _rows(folder.path / table)
    for row in rows:
        where = f"{table}: {row['part']} against {row['against_part']}, {row['side']} {row['parameter']}"
        yield from (f"{where}: {fault}" for fault in structure_faults(row, "mean", "against_mean", is_legs=False))
        found["rows"] += 1
        if row["side"] == "both" or row["verdict"] not in JUDGED or table != "differences.csv":
            continue
        walks = row["walks"], row["against_walks"]
        of_walks = [folder.values(one, row["side"], row["parameter"]) for one in walks]
        if not (of_walks[0] and of_walks[1]) or not folder.has_published_figures:
            continue
        for values, head in ((of_walks[0], ""), (of_walks[1], "against_")):
            yield from (f"{where}: {fault}" for fault in mean_faults(values, row, head))
        spreads = STRAPPED_AGAIN if "strapping" in row["error_sources"].split() else LEFT_ON
        speeds = folder.speed(walks[0]), folder.speed(walks[1])
        pair = of_walks[0], of_walks[1]
        faults = recomputed_faults(row, pair, speeds, spreads[KIND_OF[row["parameter"]]])
        yield from (f"{where}: {fault}" for fault in faults)
        found["recomputed"] += 1


def sides_faults(folder: Folder, found: Counter[str]) -> Iterator[str]:
    """Of sides.csv; the first of its two legs is the one whose columns stand first."""
    rows = _rows(folder.path / "sides.csv")
    for row in rows:
        first, second = sorted(("left", "right"), key=lambda side: list(row).index(f"{side}_mean"))
        column, where = row["parameter"], f"sides.csv: {row['part']} {row['parameter']}"
        faults = structure_faults(row, f"{first}_mean", f"{second}_mean", is_legs=True)
        yield from (f"{where}: {fault}" for fault in faults)
        found["rows"] += 1
        if row["verdict"] not in JUDGED or not folder.has_published_figures:
            continue
        if KIND_OF[column] in NOT_BETWEEN_LEGS and column != "step_time_s":
            yield f"{where}: judged between legs"
            continue
        legs = [folder.values(row["walks"], side, column) for side in (first, second)]
        if not (legs[0] and legs[1]):
            continue
        for values, side in ((legs[0], first), (legs[1], second)):
            yield from (f"{where}: {fault}" for fault in mean_faults(values, row, f"{side}_"))
        spread = STEPS_OF_LEGS if column == "step_time_s" else STRAPPED_AGAIN[KIND_OF[column]]
        speed_m_s = folder.speed(row["walks"])
        pair = legs[0], legs[1]
        yield from (f"{where}: {fault}" for fault in recomputed_faults(row, pair, (speed_m_s, speed_m_s), spread))
        found["recomputed"] += 1


def faults_of(path: Path, found: Counter[str]) -> list[str]:
    """All of an output folder."""
    folder, faults = Folder(path), list[str]()
    tables: dict[str, Callable[[], Iterator[str]]] = {
        "differences.csv": lambda: differences_faults(folder, "differences.csv", found),
        "visits.csv": lambda: differences_faults(folder, "visits.csv", found),
        "sides.csv": lambda: sides_faults(folder, found),
    }
    for name, of_table in tables.items():
        if (path / name).exists():
            faults += of_table()
    return faults


def main() -> int:
    total, are_sound = Counter[str](), True
    for name in sys.argv[1:]:
        faults = faults_of(Path(name), total)
        are_sound &= not faults
        print(f"{name}: {len(faults)} faults", *faults, sep="\n  ")
    print(f"{total['rows']} rows, {total['recomputed']} recomputed from their strides")
    return 0 if are_sound and total["rows"] else 1


if __name__ == "__main__":
    sys.exit(main())
