"""Tables as a batch writes them, made at random: gaps, not reported values, single walks, conditions that change."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

STATUSES = ("read", "care", "withheld", "not_measured")
MEASURE = "knee_range_deg"


def row(session: str, value: float | None, status: str = "read", **more: Any) -> dict[str, Any]:
    """One row of one measure, of the left leg in the first walk, as somebody barefoot."""
    return {
        "session": session,
        "patient": session,
        "walk": "walk 1",
        "condition": "barefoot",
        "side": "left",
        "is_affected": None,
        "is_prosthetic": None,
        "device": None,
        "age_years": 50,
        "is_simulated": False,
        "walk_speed_m_s": 1.0,
        "walk_speed_m_s_status": "read",
        MEASURE: value,
        f"{MEASURE}_sd": 1.0,
        f"{MEASURE}_error": 9.2,
        f"{MEASURE}_status": status,
        "cadence_steps_min": None,
        "cadence_steps_min_status": None,
        **more,
    }


SCHEMA = pa.schema(
    [
        (name, pa.bool_() if name.startswith("is_") else pa.int64() if name == "age_years" else pa.float64())
        if name.startswith("is_") or isinstance(value, (int, float)) or name == "cadence_steps_min"
        else (name, pa.string())
        for name, value in row("", 0.0).items()
    ]
)


def write_rows(rows: list[dict[str, Any]], path: Path) -> Path:
    pq.write_table(pa.Table.from_pylist(rows, schema=SCHEMA), path)
    return path


def random_rows(seed: int, sessions: int) -> list[dict[str, Any]]:
    """Rows of `sessions` sessions of one to four walks, of one or both legs."""
    rng = np.random.default_rng(seed)
    rows = []
    for number in range(sessions):
        prosthetic = rng.choice(["left", "right", "none", ""])
        reported = {
            "patient": f"patient {number // 2}",
            "age_years": None if rng.random() < 0.1 else int(rng.integers(5, 95)),
            "device": rng.choice(np.array(["knee A", " knee B ", None, ""], dtype=object)),
            "is_simulated": bool(rng.random() < 0.1),
        }
        for walk in range(int(rng.integers(1, 5))):
            reported |= {
                "walk": f"walk {walk + 1}",
                "condition": rng.choice(np.array(["barefoot", "shoes", 'it\'s "odd"', None], dtype=object)),
                "walk_speed_m_s": None if rng.random() < 0.1 else float(rng.uniform(0.1, 2.0)),
                "walk_speed_m_s_status": rng.choice(STATUSES[:3]),
            }
            for side in ("left", "right")[: int(rng.integers(1, 3))]:
                has_none = rng.random() < 0.2
                value = rng.choice([np.nan, np.inf]) if rng.random() < 0.05 else float(rng.normal(60, 8))
                rows.append(
                    row(
                        f"session {number}",
                        None if has_none else value,
                        str(rng.choice(STATUSES, p=[0.6, 0.2, 0.15, 0.05])),
                        **reported,
                        side=side,
                        is_affected=None,
                        is_prosthetic=None if not prosthetic else side == prosthetic,
                    )
                )
            rows.append(
                row(f"session {number}", None, "", **reported, side="both")
                | {"cadence_steps_min": float(rng.normal(100, 9)), "cadence_steps_min_status": "read"}
            )
    return rows
