"""Find which sensor is worn where, by shaking one after the other or by moving the legs."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from app.acquisition.chain_search import ChainSearch
from app.wizard.sensors.shaking import Shaking
from core.body import Side, Site
from core.placement.chains import Chains
from core.samples import FloatArray, ImuBlock


@dataclass(frozen=True, slots=True)
class PlacingState:
    """What the movement so far shows.

    `shaken`, `shaken_together`, `shakes`: as in `ShakingState`; `shakes` counts, so that nothing is missed between two
    looks of the screen.
    `movement_deg_s`: spread of each sensor's rate over its last quarter of a second.
    `is_sure`: whether the legs are certain, and have been for two seconds; left and right are another matter.
    """

    shaken: str | None = None
    shaken_together: tuple[str, ...] = ()
    shakes: int = 0
    movement_deg_s: Mapping[str, float] = field(default_factory=dict)
    chains: Chains | None = None  # the legs, once the patient moves; None before
    is_sure: bool = False

    def sites(self, first_moved: Side) -> dict[str, Site]:
        """Every sensor's site, once it is certain, with the side that was asked to move first; a single leg's side."""
        if self.chains is None or not self.is_sure:
            return {}
        is_reported = len(self.chains.legs) == 1 or self.chains.is_first_certain
        return self.chains.sites(first_moved) if is_reported else {}


class PlacingEstimator:
    """For one way of placing sensors; another begins with another estimator.

    Parameters
    ----------
    standing
        Mean specific force (3,) in standing of the sensors that have stood.
    """

    def __init__(self, sensors: Iterable[str], standing: Mapping[str, FloatArray] | None = None) -> None:
        names = tuple(sensors)
        self._shaking = Shaking(names)
        self._search = ChainSearch(names, standing=standing)
        self.state = PlacingState()

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        """Take new samples of some or all sensors."""
        shaking = self._shaking.update(blocks)
        self._search.update(blocks)
        self.state = PlacingState(
            shaking.shaken,
            shaking.shaken_together,
            shaking.count,
            {name: float(np.rad2deg(spread)) for name, spread in self._shaking.spread_rad_s.items()},
            self._search.chains,
            self._search.is_sure,
        )
