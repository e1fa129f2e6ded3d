"""Where percent of the stride and degrees lie in a plot; a painter's own unit, y downwards."""

from dataclasses import dataclass

import numpy as np

from core.samples import FloatArray


@dataclass(frozen=True, slots=True)
class Frame:
    """The room inside the axes, and the degrees at its bottom and top."""

    left: float
    top: float
    width: float
    height: float
    low_deg: float
    high_deg: float

    @property
    def right(self) -> float:
        return self.left + self.width

    @property
    def bottom(self) -> float:
        return self.top + self.height

    def x(self, percent: FloatArray | float) -> FloatArray:
        return np.asarray(self.left + self.width * np.asarray(percent, dtype=np.float64) / 100)

    def y(self, angle_deg: FloatArray | float) -> FloatArray:
        height_deg = np.asarray(angle_deg, dtype=np.float64) - self.low_deg
        return np.asarray(self.bottom - self.height * height_deg / (self.high_deg - self.low_deg))

    def percent_at(self, x: float) -> float:
        return 100 * (x - self.left) / self.width

    def angle_at(self, y: float) -> float:
        return self.low_deg + (self.high_deg - self.low_deg) * (self.bottom - y) / self.height
