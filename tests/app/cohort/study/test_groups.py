"""Means by group: the same figures as pandas has, sessions as what is counted, and what is left out."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from scipy import stats

from app.cohort.study.groups import (
    AGE_EDGES,
    SPEED_EDGES,
    GroupAnswer,
    Grouping,
    GroupQuestion,
    answer,
    groupings_of,
    table_of,
)
from app.cohort.study.parameter_table import ParameterTable
from devices.files.refusal import FileRefusedError
from tests.app.cohort.study.study_tables import MEASURE, random_rows, row, write_rows

CLOSE = 1e-9


def asked(path: Path, grouping: Grouping = Grouping.CONDITION, measure: str = MEASURE, **more: bool) -> GroupAnswer:
    with ParameterTable.opened(path) as table:
        return answer(table, GroupQuestion(measure, grouping, **more))


def pandas_groups(frame: pd.DataFrame, grouping: Grouping) -> pd.Series:
    """The group of each row, in a way of its own."""

    def banded(values: pd.Series, edges: tuple[float, ...]) -> pd.Series:
        names = ["0", *(f"{edge:g}" for edge in edges)]
        reported = pd.cut(values, [-np.inf, *edges, np.inf], right=False, labels=names).astype(object)
        return reported.where(values.notna(), "")

    match grouping:
        case Grouping.CONDITION | Grouping.DEVICE:
            return frame[grouping.value].fillna("").str.strip()
        case Grouping.AGE:
            return banded(frame["age_years"].astype(float), AGE_EDGES)
        case Grouping.SPEED:
            is_reported = frame["walk_speed_m_s_status"].isin(["read", "care"])
            return banded(frame["walk_speed_m_s"].where(is_reported), SPEED_EDGES)
        case Grouping.SIDE:
            return frame["side"]
        case Grouping.LEG:
            prosthetic = frame["is_prosthetic"].fillna(False).astype(bool)
            has_one = prosthetic.groupby(frame["session"]).transform("any")
            groups = pd.Series("neither", index=frame.index)
            groups[frame["is_prosthetic"].isna()] = ""
            groups[has_one] = "other"
            groups[prosthetic] = "prosthetic"
            return groups
        case Grouping.ALL:
            return pd.Series("all", index=frame.index)


def pandas_figures(path: Path, question: GroupQuestion) -> dict[str, dict[str, Any]]:
    frame = pq.read_table(path).to_pandas()
    frame = frame[frame["side"] != "both"]
    if not question.has_simulated:
        frame = frame[~frame["is_simulated"].astype(bool)]
    frame = frame.assign(group=pandas_groups(frame, question.grouping))
    reported = ["read", "care"] if question.has_care else ["read"]
    is_used = frame[f"{MEASURE}_status"].isin(reported) & np.isfinite(frame[MEASURE])
    used = frame[is_used]
    sides = used.groupby(["group", "session", "side"])[MEASURE].mean()
    values = sides.groupby(["group", "session"]).mean()
    found: dict[str, dict[str, Any]] = {}
    for group, rows in frame.groupby("group"):
        of_group = values[values.index.get_level_values("group") == group]
        own, n = used[used["group"] == group], len(of_group)
        left = rows.loc[~is_used.loc[rows.index], f"{MEASURE}_status"]
        low, high = stats.t.interval(0.95, n - 1, of_group.mean(), of_group.sem()) if n > 2 else (math.nan, math.nan)
        found[str(group)] = {
            "sessions": n,
            "patients": own["patient"].nunique(),
            "walks": len(own[["session", "walk"]].drop_duplicates()),
            "mean": of_group.mean(),
            "sd": of_group.std() if n > 2 else math.nan,
            "standard_error": of_group.sem() if n > 2 else math.nan,
            "low": low,
            "high": high,
            "value_error": own[f"{MEASURE}_error"].median(),
            "withheld": int((left == "withheld").sum()),
            "with_care": int((left == "care").sum()),
            "not_measured": int((~left.isin(["withheld", "care"])).sum()),
            "sessions_without": rows["session"].nunique() - n,
        }
    return found


@pytest.mark.endurance
@pytest.mark.parametrize("grouping", Grouping)
@pytest.mark.parametrize(("seed", "sessions", "is_more"), [(1, 40, False), (2, 3, True), (3, 90, True)])
def test_the_figures_are_those_of_pandas(
    tmp_path: Path, grouping: Grouping, seed: int, sessions: int, is_more: bool
) -> None:
    path = write_rows(random_rows(seed, sessions), tmp_path / "parameters.parquet")
    question = GroupQuestion(MEASURE, grouping, has_care=is_more, has_simulated=is_more)
    with ParameterTable.opened(path) as table:
        found = answer(table, question)
    required = pandas_figures(path, question)
    assert {one.group for one in found.rows} == set(required)
    for one in found.rows:
        low, high = one.interval
        for name, value in required[one.group].items():
            ours = {"low": low, "high": high}.get(name, getattr(one, name, None))
            assert ours == pytest.approx(value, rel=CLOSE, abs=CLOSE, nan_ok=True), (one.group, name)


def test_a_session_with_ten_walks_counts_once(tmp_path: Path) -> None:
    rows = [row("long", 50.0, walk=f"walk {k}") for k in range(10)] + [row("a", 60.0), row("b", 70.0)]
    (found,) = asked(write_rows(rows, tmp_path / "p.parquet")).rows
    assert (found.sessions, found.walks, found.mean) == (3, 12, 60.0)
    assert found.sd == pytest.approx(10.0)


def test_both_legs_of_a_session_are_one_value(tmp_path: Path) -> None:
    """As two they would be called independent, and the interval would be too narrow."""
    rows = [row(name, value + d, side=side) for name, value in (("a", 50.0), ("b", 60.0), ("c", 70.0))
            for side, d in (("left", -1.0), ("right", 1.0))]  # fmt: skip
    rows += [row("a", 49.0, side="left", walk="walk 2")]  # the left leg walked twice, and counts as much as the right
    (found,) = asked(write_rows(rows, tmp_path / "p.parquet")).rows
    assert (found.sessions, found.mean) == (3, 60.0)
    assert found.half_interval == pytest.approx(stats.t.ppf(0.975, 2) * 10 / math.sqrt(3))


@pytest.mark.parametrize("sessions", [1, 2, 3])
def test_under_three_sessions_there_is_a_mean_and_no_spread(tmp_path: Path, sessions: int) -> None:
    rows = [row(f"s{k}", 60.0 + k) for k in range(sessions)]
    (found,) = asked(write_rows(rows, tmp_path / "p.parquet")).rows
    assert math.isfinite(found.mean)
    assert [math.isfinite(one) for one in (found.sd, found.standard_error, found.half_interval)] == [sessions > 2] * 3


def test_what_is_not_reported_counts_nowhere_even_with_a_number(tmp_path: Path) -> None:
    rows = [row("a", 60.0), row("b", 1e6, "withheld"), row("c", 1e6, ""), row("d", None), row("e", 66.0, "care")]
    path = write_rows(rows, tmp_path / "p.parquet")
    (found,) = asked(path).rows
    assert (found.sessions, found.mean, found.withheld, found.with_care, found.not_measured) == (1, 60.0, 1, 1, 2)
    assert found.sessions_without == 4
    (found,) = asked(path, has_care=True).rows
    assert (found.sessions, found.mean, found.with_care) == (2, 63.0, 0)


def test_simulated_sessions_count_only_when_asked_for(tmp_path: Path) -> None:
    path = write_rows([row("a", 60.0), row("b", 70.0, is_simulated=True)], tmp_path / "p.parquet")
    found = asked(path)
    assert (found.rows[0].mean, found.simulated, found.simulated_left_out) == (60.0, 0, 1)
    found = asked(path, has_simulated=True)
    assert (found.rows[0].mean, found.simulated, found.simulated_left_out) == (65.0, 1, 0)


def test_groups_that_share_a_session_are_reported(tmp_path: Path) -> None:
    rows = [row("a", 60.0), row("a", 61.0, walk="walk 2", condition="shoes"), row("b", 62.0)]
    path = write_rows(rows, tmp_path / "p.parquet")
    assert asked(path).is_overlapping
    assert (asked(path).sessions, asked(path).patients) == (2, 2)
    assert not asked(path, Grouping.AGE).is_overlapping


def test_people_are_not_counted_where_one_session_does_not_show_its_own(tmp_path: Path) -> None:
    path = write_rows([row("a", 60.0), row("b", 61.0, patient=None)], tmp_path / "p.parquet")
    assert asked(path).patients == 0
    assert asked(path).rows[0].patients == 0


def test_a_measure_of_both_legs_is_read_from_their_row(tmp_path: Path) -> None:
    path = write_rows(random_rows(5, 8), tmp_path / "p.parquet")
    found = asked(path, Grouping.ALL, "cadence_steps_min", has_simulated=True)
    frame = pq.read_table(path).to_pandas()
    of_session = frame.groupby("session")["cadence_steps_min"].mean()
    assert found.rows[0].mean == pytest.approx(of_session.mean(), rel=CLOSE)
    assert found.rows[0].not_measured == 0


def test_groups_stand_in_their_own_order_and_what_is_not_stated_last(tmp_path: Path) -> None:
    ages = (None, 85, 10, 45)
    path = write_rows([row(f"s{k}", 60.0, age_years=age) for k, age in enumerate(ages)], tmp_path / "p.parquet")
    assert [one.group for one in asked(path, Grouping.AGE).rows] == ["0", "40", "80", ""]


def test_nothing_can_be_grouped_by_what_names_one_session() -> None:
    assert {one.value for one in Grouping} & {"session", "patient", "walk", "started"} == set()


def test_a_table_is_grouped_only_by_what_it_has(tmp_path: Path) -> None:
    path = tmp_path / "p.parquet"
    kept = ["session", "walk", "side", "condition", MEASURE, f"{MEASURE}_status"]
    pq.write_table(pq.read_table(write_rows([row("a", 60.0)], path)).select(kept), path)
    with ParameterTable.opened(path) as table:
        assert groupings_of(table) == (Grouping.CONDITION, Grouping.SIDE, Grouping.ALL)
        assert answer(table, GroupQuestion(MEASURE, Grouping.CONDITION)).rows[0].mean == 60.0
        for question, lacking in (
            (GroupQuestion(MEASURE, Grouping.AGE), "age_years"),
            (GroupQuestion("height_m", Grouping.ALL), "height_m"),
        ):
            with pytest.raises(FileRefusedError, match=lacking):
                answer(table, question)


def test_the_file_has_every_number_and_empty_cells_for_what_is_not_known(tmp_path: Path) -> None:
    rows = [row(f"s{k}", 60.0 + k) for k in range(3)] + [row("x", 50.0, condition="shoes")]
    header, lines = table_of(asked(write_rows(rows, tmp_path / "p.parquet")))
    many, one = (dict(zip(header, line, strict=True)) for line in lines)
    assert (many["measure"], many["grouped_by"], many["included"], many["holds_simulated"]) == (
        MEASURE, "condition", "read", "no")  # fmt: skip
    assert (many["group"], many["sessions"], many["mean"], many["sd"]) == ("barefoot", 3, 61.0, 1.0)
    assert float(str(many["interval_95_low"])) == pytest.approx(61.0 - stats.t.ppf(0.975, 2) / math.sqrt(3))
    assert [one[name] for name in ("sd", "standard_error", "interval_95_low", "interval_95_high")] == [None] * 4
