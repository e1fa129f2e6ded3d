"""Estimate whether the patient keeps still, who moved, and what the sensors read meanwhile."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from core.calibration.rest import MAX_SPREAD_RAD_S
from core.live.standing import REQUIRED_S, LiveStanding, StandingState
from core.samples import ImuBlock

LIMIT_DEG_S = float(np.rad2deg(MAX_SPREAD_RAD_S))  # of the rate's spread: what rest may sway and tremble


@dataclass(frozen=True, slots=True)
class StandingView:
    """The standing so far, by the sensors' names.

    `movement_deg_s`: what each sensor moved in its last quarter of a second, on the scale whose limit is LIMIT_DEG_S:
    the spread of its rate, or what its specific force or its mean rate would amount to there, whichever is worst. A
    sensor moves just when it reaches the limit; infinite where too little was received.
    """

    standing: StandingState[str]
    movement_deg_s: Mapping[str, float] = field(default_factory=dict)


class StandingEstimator:
    """One attempt to stand still; another begins with another estimator. Nobody waits for what is `optional`."""

    def __init__(
        self, sensors: Iterable[str], required_s: float = REQUIRED_S, optional: frozenset[str] = frozenset()
    ) -> None:
        self._names = frozenset(sensors)
        self._standing = LiveStanding(sorted(self._names), required_s, optional)
        self.state = StandingView(self._standing.state)

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        """Take new samples of some or all sensors; those that are not worn are passed over."""
        state = self._standing.update({name: block for name, block in blocks.items() if name in self._names})
        movement = {name: share * LIMIT_DEG_S for name, share in state.movement.items()}
        self.state = StandingView(state, movement)
