"""Tests that times written as texts become seconds, and go on over midnight."""

import pytest

from devices.files.refusal import FileRefusedError
from devices.files.text_times import is_time, seconds_of


def seconds(*cells: str) -> list[float]:
    found = seconds_of(cells, "Time", "a.csv", lambda row: f"line {row + 2}")
    return [round(float(one - found[0]), 6) for one in found]


@pytest.mark.parametrize(
    "cells",
    [
        ("23:59:59.990", "00:00:00.000", "00:00:00.010"),
        ("23:59:59,990", "0:00:00,000", "0:00:00,010"),
        ("23:59:59:990", "00:00:00:000", "00:00:00:010"),
        ("11:59:59.990 PM", "12:00:00.000 AM", "12:00:00.010 am"),
        ("2026-11-28T23:59:59.990", "2026-11-29T00:00:00.000", "2026-11-29T00:00:00.010"),
        ("2026-02-28 23:59:59.990Z", "2026-03-01 00:00:00.000Z", "2026-03-01 00:00:00.010Z"),
        ("2026-11-28 12:00:00.990+01:00", "2026-11-28 12:00:01.000+01:00", "2026-11-28 12:00:01.010+01:00"),
        ("12/31/2026 23:59:59.990", "1/1/2027 00:00:00.000", "1/1/2027 00:00:00.010"),
        ("28.11.2026 23:59:59,990", "29.11.2026 00:00:00,000", "29.11.2026 00:00:00,010"),
        ("59:59.990", "00:00.000", "00:00.010"),
        (" 10:00:00.990", " 10:00:01.000", " 10:00:01.010"),
    ],
)
def test_times_of_every_form_are_seconds(cells: tuple[str, ...]) -> None:
    assert all(map(is_time, cells))
    assert seconds(*cells) == [0.0, 0.01, 0.02]


def test_a_clock_that_steps_back_is_not_taken_for_midnight() -> None:
    assert seconds("12:00:00", "11:59:58") == [0.0, -2.0]
    assert seconds("2026-11-28 23:00:00", "2026-11-28 01:00:00") == [0.0, -79200.0]


def test_what_is_no_time_is_refused_and_nothing_is_missing() -> None:
    found = seconds_of(["12:00:00", "", "NA", "12:00:01"], "Time", "a.csv", str)
    assert [str(one) for one in (found - found[0]).tolist()] == ["0.0", "nan", "nan", "1.0"]
    with pytest.raises(FileRefusedError, match=r'a\.csv, line 3: "noon" in column "Time" is not a time'):
        seconds("12:00:00", "noon")
    assert not is_time("12.5")
    assert not is_time("2026-11-28")
