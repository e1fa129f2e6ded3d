"""Lag of the distal sensor's clock, looked for every few seconds of a free motion, as offline."""

from collections import deque
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from core.calibration.lag import find_lag
from core.live.orientation import OrientedSamples, joined
from core.live.pairing import PairedSamples, Pairing, joined_rows
from core.signal.datasets import gather, moving_indices
from core.signal.pair import FAST_RAD_S, pair_of

KEPT_LOOKS = 4
SAMPLES = 150
MIN_MOVING_S = 4.0


class LagVerdict(StrEnum):
    """NONE: no lag. LAG: one that the analysis takes out. NOT_ONE_JOINT: too far apart, or not adjacent."""

    NONE = "none"
    LAG = "lag"
    NOT_ONE_JOINT = "not_one_joint"


@dataclass(frozen=True, slots=True)
class LagState:
    """`lag_s` is to be added to the distal sensor's stamps, `sd_s` its standard deviation (None: not known)."""

    verdict: LagVerdict
    lag_s: float
    sd_s: float | None


class LiveLag:
    """The lag of one joint's distal sensor, from the samples between the last looks."""

    def __init__(self, proximal_step_s: float, distal_step_s: float) -> None:
        self._pairing = Pairing(proximal_step_s, distal_step_s, 0.0)
        self._step_s = proximal_step_s
        self._kept: deque[PairedSamples] = deque(maxlen=KEPT_LOOKS)
        self._new: tuple[list[OrientedSamples], list[OrientedSamples]] = ([], [])

    def feed(self, proximal: OrientedSamples, distal: OrientedSamples) -> None:
        """Take what is new of both sensors; they are paired at the next look."""
        self._new[0].append(proximal)
        self._new[1].append(distal)

    def look(self, heading_rad: float) -> LagState | None:
        """Give what samples show at the heading of the distal earth; None for too little movement."""
        new = self._pairing.update(joined(self._new[0]), joined(self._new[1]))
        self._new = [], []
        if len(new):
            self._kept.append(new)
        rows = self._of_one_stretch()
        if rows is None:
            return None
        one, two = rows.proximal, rows.distal
        rates, forces = (one[:, 4:7], two[:, 4:7]), (one[:, 7:10], two[:, 7:10])
        pair = pair_of(rows.time_s, self._step_s, rates, forces, (one[:, 0:4], two[:, 0:4]), rows.is_measured)
        index = moving_indices(pair, FAST_RAD_S)
        if len(index) * self._step_s < MIN_MOVING_S:
            return None
        data = gather((pair,), [index]).thinned(SAMPLES)
        found = find_lag(data, np.full(data.knots, heading_rad))
        verdict = LagVerdict.NOT_ONE_JOINT if found.is_at_border else LagVerdict.LAG if found.lag_s else LagVerdict.NONE
        return LagState(verdict, found.lag_s, found.sd_s)

    def _of_one_stretch(self) -> PairedSamples | None:
        """The samples since the orientations last restarted, and their heading with them."""
        if not self._kept:
            return None
        rows = joined_rows(self._kept)
        breaks = np.flatnonzero((np.diff(rows.tick) > 1) | ~rows.is_paired[1:])
        first = int(breaks[-1]) + 1 if len(breaks) else 0
        while first < len(rows) and not rows.is_paired[first]:
            first += 1
        return rows.part(slice(first, None)) if first < len(rows) else None
