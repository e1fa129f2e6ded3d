"""Tests that what was planned comes back from its line, and that nothing else is taken for it."""

import pytest

from core.timed.protocols import PlannedTest, TimedProtocol, planned_of_text, planned_text


def test_a_planned_test_comes_back_from_its_line() -> None:
    planned = PlannedTest(TimedProtocol.SIX_MINUTES, start_key_s=2.5, lap_m=20.0, typed_laps=9, rest_m=4.0)
    assert planned_of_text(planned_text(planned)) == planned
    assert planned_of_text(planned_text(None)) is None


@pytest.mark.parametrize("text", ["no JSON", "3", "[]", "[" * 100_000, '{"test": "to the moon"}'])
def test_a_line_of_something_else_is_no_test(text: str) -> None:
    assert planned_of_text(text) is None
