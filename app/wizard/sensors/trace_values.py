"""How each sensor turned in the last seconds, as its row draws it: at even steps, about the axis that turns most."""

from collections.abc import Iterable

import numpy as np

from app.widgets.sensor_tile import SILENT_FROM_S
from core.samples import FloatArray, ImuBlock

TRACE_S, TRACE_POINTS = 5.0, 250
TURNS_MORE = 2.0  # times the variance that another axis needs before the trace goes over to it


class TraceValues:
    """Remembers of each sensor which axis is drawn, so that the line does not jump between two that turn alike."""

    def __init__(self) -> None:
        self._axis: dict[str, int] = {}

    def of(self, blocks: Iterable[ImuBlock], now_s: float) -> dict[str, FloatArray]:
        """Give (n,) deg/s by the sensor's name, from blocks that reach back TRACE_S; NaN where it is silent."""
        return {block.sensor: self._values(block, now_s) for block in blocks}

    def _values(self, block: ImuBlock, now_s: float) -> FloatArray:
        time_s = np.linspace(now_s - TRACE_S, now_s, TRACE_POINTS)
        received = np.isfinite(block.gyr_rad_s).all(axis=1)
        if np.count_nonzero(received) < 2:
            return np.full(TRACE_POINTS, np.nan)
        rates = block.gyr_rad_s[received]
        variance = rates.var(axis=0)
        most = int(np.argmax(variance))
        axis = self._axis.setdefault(block.sensor, most)
        if variance[most] > TURNS_MORE * variance[axis]:
            axis = self._axis[block.sensor] = most
        known_s = block.time_s[received]
        values: FloatArray = np.rad2deg(np.interp(time_s, known_s, rates[:, axis], left=np.nan))
        values[time_s > known_s[-1] + SILENT_FROM_S / 2] = np.nan
        return values
