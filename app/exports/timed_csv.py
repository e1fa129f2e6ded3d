"""What came of each timed test of a session, as tables for other programs: `timed_test.csv`, and a part of the summary.

One row for the test itself, then one for every third, lap, turn, pause, rise, stair and silence of a sensor, part of an
up and go and sitting; of several rises and sittings the mean and the slowest. Times of parts count from the start of
the test. What was not measured is an empty cell, and the row of the test states why, and whether it is valid.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from app.system.tables import typed_cell
from core.results import Analysis, RecordingAnalysis
from core.session import Recording
from core.timed.found import TimedPart, TimedTest

TIMED = "timed_test.csv"
HEADER = (
    *("recording", "condition", "test", "row", "number", "start_s", "end_s", "time_s"),
    *("distance_m", "sensor_distance_m", "speed_m_s", "cadence_steps_min", "turn_deg", "side", "climb_m"),
    *("started_by", "ended_by", "sensor", "missing"),
    *("part", "validity", "not_valid", "course_m", "course_found_m", "distance_source"),
)


def timed_walks(analysis: Analysis) -> list[RecordingAnalysis]:
    """The walks that are timed tests, in order of time."""
    return [one for one in analysis.recordings if one.timed is not None]


def timed_rows(analysis: Analysis, recordings: Sequence[Recording]) -> Iterator[tuple[str, ...]]:
    """The rows of every timed test that counts."""
    conditions = {one.name: one.condition for one in recordings}
    for walk in timed_walks(analysis):
        assert walk.timed is not None
        head = {
            "recording": typed_cell(walk.folder),
            "condition": typed_cell(conditions.get(walk.name, "")),
            "test": str(walk.timed.protocol),
        }
        for row in _rows(walk.timed):
            cells = head | row
            yield tuple(cells.get(name, "") for name in HEADER)


def _rows(test: TimedTest) -> Iterator[dict[str, str]]:
    yield {
        "row": "test",
        "number": "1",
        **_span(test.start_s, test.end_s, 0.0),
        **_walked(test),
        "sensor_distance_m": figure(test.sensor_distance_m, 3),
        "started_by": "key" if test.is_start_by_key else "motion",
        "ended_by": "key" if test.is_end_by_key else "motion",
        "missing": " ".join(str(one) for one in test.missing),
        "validity": str(test.validity),
        "not_valid": " ".join(str(one) for one in test.not_valid),
        "course_m": figure(test.course_m, 3),
        "course_found_m": figure(test.course_found_m, 3),
        "distance_source": str(test.distance_source) if math.isfinite(test.distance_m) else "",
    }
    parts: dict[str, list[tuple[float, float, dict[str, str]]]] = {
        "third": [(one.start_s, one.end_s, _walked(one)) for one in test.thirds],
        "lap": [(one.start_s, one.end_s, _walked(one)) for one in test.laps],
        "turn": [
            (one.start_s, one.end_s, {"turn_deg": figure(float(np.rad2deg(one.angle_rad)), 1)}) for one in test.turns
        ],
        "pause": [(start_s, end_s, {}) for start_s, end_s in test.pauses_s],
        "rise": [(one.left_seat_s, one.upright_s, {}) for one in test.rises],
        "stair": [
            (one.start_s, one.end_s, {"side": str(one.side), "climb_m": figure(one.climb_m, 3)}) for one in test.stairs
        ],
        "silence": [(one.start_s, one.end_s, {"sensor": str(one.site)}) for one in test.silences],
        "part": [(one.start_s, one.end_s, {"part": str(one.part)}) for one in test.parts],
        "sitting": [(one.left_upright_s, one.seated_s, {}) for one in test.sittings],
    }
    for word, rows in parts.items():
        for number, (start_s, end_s, more) in enumerate(rows, 1):
            yield {"row": word, "number": str(number), **_span(start_s, end_s, test.start_s), **more}
    if test.definition.rises > 1:
        for word in ("rise", "sitting"):
            yield from _mean_and_slowest(word, parts[word], test.start_s)


def _mean_and_slowest(
    word: str, rows: list[tuple[float, float, dict[str, str]]], from_s: float
) -> Iterator[dict[str, str]]:
    if len(rows) < 2:
        return
    times_s = [end_s - start_s for start_s, end_s, _ in rows]
    slowest = int(np.argmax(times_s))
    yield {"row": f"{word}_mean", "number": "1", "time_s": figure(float(np.mean(times_s)), 3)}
    yield {"row": f"{word}_slowest", "number": "1", **_span(*rows[slowest][:2], from_s)}


def _walked(one: TimedPart | TimedTest) -> dict[str, str]:
    return {
        "distance_m": figure(one.distance_m, 3),
        "speed_m_s": figure(one.speed_m_s, 4),
        "cadence_steps_min": figure(one.cadence_steps_min, 2),
    }


def _span(start_s: float, end_s: float, from_s: float) -> dict[str, str]:
    origin_s = from_s if math.isfinite(from_s) else 0.0
    return {
        "start_s": figure(start_s - origin_s, 3),
        "end_s": figure(end_s - origin_s, 3),
        "time_s": figure(end_s - start_s, 3),
    }


def figure(value: float, decimals: int) -> str:
    """A figure, or an empty cell where it was not measured."""
    return f"{value:.{decimals}f}" if math.isfinite(value) else ""


def timed_summary(test: TimedTest) -> dict[str, Any]:
    """What `summary.json` holds of a timed test, under its walk; null where not measured."""
    return {
        "test": str(test.protocol),
        "start_s": _known(test.start_s, 3),
        "end_s": _known(test.end_s, 3),
        "time_s": _known(test.time_s, 3),
        "started_by": "key" if test.is_start_by_key else "motion",
        "ended_by": "key" if test.is_end_by_key else "motion",
        "distance_m": _known(test.distance_m, 3),
        "sensor_distance_m": _known(test.sensor_distance_m, 3),
        "speed_m_s": _known(test.speed_m_s, 4),
        "cadence_steps_min": _known(test.cadence_steps_min, 2),
        "laps": len(test.laps),
        "turns": len(test.turns),
        "pauses": len(test.pauses_s),
        "paused_s": _known(sum(end - start for start, end in test.pauses_s), 3),
        "rises": len(test.rises),
        "stairs": {"up": _stairs(test, is_up=True), "down": _stairs(test, is_up=False)},
        "thirds_speed_m_s": [_known(one.speed_m_s, 4) for one in test.thirds],
        "missing": [str(one) for one in test.missing],
        "errors": [
            {
                "quantity": one.quantity,
                "low": one.low,
                "high": one.high,
                "source": one.source,
                "unverified": not one.is_verified,
            }
            for one in test.definition.errors
        ],
        "validity": str(test.validity),
        "not_valid": [str(one) for one in test.not_valid],
        "course_m": _known(test.course_m, 3),
        "course_found_m": _known(test.course_found_m, 3),
        "distance_source": str(test.distance_source) if math.isfinite(test.distance_m) else None,
        "parts": [
            {
                "part": str(one.part),
                "start_s": _known(one.start_s, 3),
                "end_s": _known(one.end_s, 3),
                "time_s": _known(one.time_s, 3),
            }
            for one in test.parts
        ],
        "rise_s": _times([one.time_s for one in test.rises]),
        "sitting_s": _times([one.time_s for one in test.sittings]),
    }


def _times(times_s: list[float]) -> dict[str, Any]:
    """How long each took, the mean and the slowest; null without any."""
    return {
        "each": [_known(one, 3) for one in times_s],
        "mean": _known(float(np.mean(times_s)) if times_s else math.nan, 3),
        "slowest": _known(max(times_s, default=math.nan), 3),
    }


def _stairs(test: TimedTest, *, is_up: bool) -> dict[str, Any]:
    """How many strides led up, or down, and how long they took on average."""
    times_s = [one.end_s - one.start_s for one in test.stairs if one.is_up is is_up]
    mean_s = sum(times_s) / len(times_s) if times_s else math.nan
    return {"strides": len(times_s), "stride_time_s_mean": _known(mean_s, 3)}


def _known(value: float, decimals: int) -> float | None:
    return round(value, decimals) if math.isfinite(value) else None
