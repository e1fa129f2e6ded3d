"""A joint over the stride, and a group's band: the curves that charts are made of."""

from dataclasses import dataclass, replace

import numpy as np

from core.gait.cycles import POINTS, MeanCycle
from core.samples import FloatArray
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD

PERCENT = np.arange(POINTS, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class SideCycle:
    """One joint over the strides used, degrees: the mean with its spread, and single strides (k, 101)."""

    mean: MeanCycle
    strides_deg: FloatArray
    toe_off_percent: float

    @property
    def height_deg(self) -> float:
        """The mean over the stride: how high the curve lies as a whole."""
        return float(np.mean(self.mean.mean)) if self.mean.n else 0.0

    def about_mean(self) -> "SideCycle":
        """The same without its height, as it is drawn where that means nothing."""
        lowered = replace(self.mean, mean=self.mean.mean - self.height_deg)
        return replace(self, mean=lowered, strides_deg=self.strides_deg - self.height_deg)


@dataclass(frozen=True, slots=True)
class Band:
    """Mean and standard deviation between subjects (101,), degrees."""

    mean_deg: FloatArray
    sd_deg: FloatArray


def is_mean_enough(n: int) -> bool:
    return n >= MIN_STRIDES_FOR_MEAN


def is_spread_enough(n: int) -> bool:
    return n >= MIN_STRIDES_FOR_SD
