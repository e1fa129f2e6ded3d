"""What a sensor's trace draws: even steps about one axis, and nothing where nothing was received."""

import numpy as np
import pytest

from app.wizard.sensors.trace_values import TRACE_POINTS, TRACE_S, TraceValues
from core.samples import FloatArray, ImuBlock


def turning(x_rad_s: float, y_rad_s: float, end_s: float = TRACE_S) -> ImuBlock:
    """A sensor that swings about two of its axes until `end_s`."""
    time_s = np.arange(0.0, end_s, 0.01)
    swing = np.sin(2.0 * np.pi * time_s)
    rates = np.column_stack([x_rad_s * swing, y_rad_s * swing, np.zeros_like(time_s)])
    return ImuBlock("0A09", time_s, rates, np.zeros_like(rates))


def drawn(values: TraceValues, block: ImuBlock) -> FloatArray:
    return values.of([block], TRACE_S)["0A09"]


def test_the_axis_that_turns_most_is_drawn_until_another_turns_clearly_more() -> None:
    values = TraceValues()
    assert np.nanmax(drawn(values, turning(2.0, 1.0))) == pytest.approx(np.rad2deg(2.0), rel=0.01)
    assert np.nanmax(drawn(values, turning(2.0, 2.5))) == pytest.approx(np.rad2deg(2.0), rel=0.01)
    assert np.nanmax(drawn(values, turning(2.0, 3.0))) == pytest.approx(np.rad2deg(3.0), rel=0.01)


def test_where_it_is_silent_nothing_is_drawn() -> None:
    found = drawn(TraceValues(), turning(2.0, 0.0, end_s=2.0))
    assert len(found) == TRACE_POINTS
    assert np.isfinite(found[:100]).all()
    assert np.isnan(found[-50:]).all()
    assert np.isnan(drawn(TraceValues(), turning(2.0, 0.0, end_s=0.01))).all()
