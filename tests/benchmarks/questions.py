"""Time of a question over 100 000 sessions, and comparison of its figures with those of pandas.

    python -m tests.benchmarks.questions [--sessions 100000] [--repeats 5] [--table FOLDER]

A table as a batch writes it (two walks, both legs and both together: 600 000 rows of 19 parameters) is made up. Each
question is asked from opening the file to the last figure; pandas reads only the columns that it needs.
"""

import os
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from app.cohort.study.groups import Grouping, GroupQuestion, answer
from app.cohort.study.parameter_table import ParameterTable
from core.verdicts.quantities import PARAMETERS
from tests.driver import options

MEASURE = "knee_range_deg"
REQUIRED_S, CLOSE = 1.0, 1e-9
SIDES = ("left", "right", "both")
SQL = {
    "mean by condition": f"SELECT condition, count(*), avg({MEASURE}) FROM parameters GROUP BY condition",
    "quantiles by device": f"SELECT device, quantile_cont({MEASURE}, [0.1, 0.5, 0.9]) FROM parameters GROUP BY device",
    "sessions over a limit": f"SELECT count(DISTINCT session) FROM parameters WHERE {MEASURE} > 70",
    "six means at once": "SELECT side, "
    + ", ".join(f"avg({name})" for name in PARAMETERS[:6])
    + " FROM parameters GROUP BY side",
}


def write_table(path: Path, sessions: int, seed: int = 7) -> None:
    """Write a made-up table of so many sessions."""
    rng = np.random.default_rng(seed)
    rows = sessions * 2 * len(SIDES)
    session, walk = np.arange(rows) // 6, np.arange(rows) // 3 % 2
    is_leg = np.arange(rows) % 3 < 2

    def typed(words: list[str | None], of: np.ndarray) -> pa.Array:
        return pa.array(words, pa.string()).take(pa.array(of))

    columns: dict[str, pa.Array] = {
        "session": pa.array([f"session-{number:06d}" for number in range(sessions)]).take(pa.array(session)),
        "patient": pa.array([f"P{number:06d}" for number in range(sessions)]).take(pa.array(session // 3)),
        "walk": typed(["walk 1", "walk 2"], walk),
        "condition": typed(
            ["barefoot", "shoes", "alignment A", None], rng.integers(0, 4, sessions * 2)[np.arange(rows) // 3]
        ),
        "side": typed(list(SIDES), np.arange(rows) % 3),
        "is_affected": pa.array(np.arange(rows) % 3 == 0),
        "is_prosthetic": pa.array(np.zeros(rows, bool)),
        "device": typed(["knee A", "knee B", None], rng.integers(0, 3, sessions)[session]),
        "age_years": pa.array(rng.integers(8, 91, sessions)[session]),
        "is_simulated": pa.array(np.zeros(rows, bool)),
        "walk_speed_m_s": pa.array(rng.uniform(0.2, 1.8, sessions * 2)[np.arange(rows) // 3]),
        "walk_speed_m_s_status": typed(["read"], np.zeros(rows, int)),
    }
    for number, name in enumerate(PARAMETERS):
        status = rng.choice(3, rows, p=[0.8, 0.12, 0.08])
        is_empty = (status == 2) | ~is_leg
        value = 60 + number + rng.normal(0, 5, rows) + rng.normal(0, 4, sessions)[session]
        columns[name] = pa.array(value, mask=is_empty)
        columns[f"{name}_sd"] = pa.array(rng.uniform(1, 3, rows), mask=is_empty)
        columns[f"{name}_error"] = pa.array(rng.uniform(3, 9, rows), mask=is_empty)
        columns[f"{name}_status"] = pa.array(np.array(["read", "care", "withheld"], object)[status], mask=~is_leg)
    pq.write_table(pa.table(columns), path)


def by_page(path: Path, grouping: Grouping) -> dict[str, tuple[float, ...]]:
    """The page's question: sessions, mean, sd of each group."""
    with ParameterTable.opened(path) as table:
        found = answer(table, GroupQuestion(MEASURE, grouping))
    return {row.group: (row.sessions, row.mean, row.sd, row.withheld) for row in found.rows}


def by_pandas(path: Path, grouping: Grouping) -> dict[str, tuple[float, ...]]:
    """The same in pandas."""
    column = {Grouping.SIDE: "side", Grouping.ALL: "is_simulated"}.get(grouping, grouping.value)
    names = dict.fromkeys(["session", "side", column, MEASURE, f"{MEASURE}_status"])
    frame = pd.read_parquet(path, columns=list(names))
    frame = frame[frame["side"] != "both"]
    frame["group"] = "all" if grouping is Grouping.ALL else frame[column].fillna("")
    used = frame[(frame[f"{MEASURE}_status"] == "read") & np.isfinite(frame[MEASURE])]
    sides = used.groupby(["group", "session", "side"])[MEASURE].mean()
    values = sides.groupby(["group", "session"]).mean().groupby("group")
    out = frame[frame[f"{MEASURE}_status"] == "withheld"].groupby("group").size()
    return {str(g): (v.size, v.mean(), v.std(), out.get(g, 0)) for g, v in values}


def seconds(work: Callable[[], object], repeats: int) -> float:
    """The median time of some work, s."""
    taken = []
    for _ in range(repeats):
        begun = time.perf_counter()
        work()
        taken.append(time.perf_counter() - begun)
    return median(taken)


def main() -> int:
    required = options(
        __doc__, sessions=100_000, repeats=5, table={"type": Path, "help": "a folder to keep the table in"}
    )
    with tempfile.TemporaryDirectory() as temporary:
        path = (required.table or Path(temporary)) / f"questions-{required.sessions}.parquet"
        if not path.exists():
            write_table(path, required.sessions)
        size = path.stat().st_size / 1e6
        rows = pq.read_metadata(path).num_rows
        print(f"{required.sessions} sessions, {rows} rows, {size:.0f} MB; load {os.getloadavg()[0]:.1f}")
        return ask_all(path, required.repeats)


def ask_all(path: Path, repeats: int) -> int:
    """Print a line for each question; 1 where one is too slow or its figures are not those of pandas."""
    worst, furthest = 0.0, 0.0
    for grouping in Grouping:
        ours = by_page(path, grouping)
        taken = seconds(partial(by_page, path, grouping), repeats)
        worst, stated = max(worst, taken), "-"
        if grouping in (Grouping.CONDITION, Grouping.DEVICE, Grouping.SIDE, Grouping.ALL):
            theirs = by_pandas(path, grouping)
            assert set(ours) == set(theirs)
            off = max(abs(a - b) / max(abs(b), 1) for g in ours for a, b in zip(ours[g], theirs[g], strict=True))
            furthest = max(furthest, off)
            taken_there = seconds(partial(by_pandas, path, grouping), repeats)
            stated = f"{taken_there:.2f} s, apart by {off:.1e}"
        print(f"page, by {grouping.value:<12} {taken:6.2f} s   pandas {stated}", flush=True)
    for name, sql in SQL.items():

        def asked(sql: str = sql) -> list[tuple[object, ...]]:
            with ParameterTable.opened(path) as table:
                return list(table.ask(sql).rows)

        taken = seconds(asked, repeats)
        worst = max(worst, taken)
        print(f"SQL, {name:<22} {taken:6.2f} s", flush=True)
    print(
        f"slowest {worst:.2f} s ({REQUIRED_S:.0f} wanted), figures apart by {furthest:.1e} at most ({CLOSE:.0e} wanted)"
    )
    return int(worst >= REQUIRED_S or furthest > CLOSE)


if __name__ == "__main__":
    sys.exit(main())
