"""Sensors of each leg, found from the movement. Looked for once a second while the patient moves."""

from collections.abc import Generator, Iterable, Mapping
from dataclasses import replace

import numpy as np

from app.acquisition.motion_memory import KEPT_S, Looks, MotionMemory, tracks_in_steps
from core.live.sensors import LiveSensor
from core.placement.chains import LIFTED_RAD_S, USUAL_SITES, Chain, Chains, chains_in_steps
from core.samples import FloatArray, ImuBlock
from core.signal.pair import MOVING_RAD_S, MOVING_WINDOW_S, moving_mean
from core.signal.tracks import nominal_step_s

LOOK_S = 1.0
SURE_AFTER = 2  # looks that say the same
LYING_RAD_S = np.deg2rad(1.0)  # spread of the rate: nobody who wears a sensor keeps it so still for half a minute
MOST = max(USUAL_SITES)


class ChainSearch:
    """Chains of the sensors that are received, from the last KEPT_S; who was lifted first is remembered from the start
    on.

    `chains`: what the last look found; None before, and where it found nothing.
    `is_sure`: whether the last looks were certain of the same legs.
    """

    def __init__(
        self,
        names: Iterable[str],
        sensors: Mapping[str, LiveSensor] | None = None,
        standing: Mapping[str, FloatArray] | None = None,
    ) -> None:
        self.chains: Chains | None = None
        self._memory = MotionMemory(names)
        self._sensors, self._standing = sensors or {}, standing or {}
        self._lifted_at_s: dict[str, float] = {}
        self._looks = Looks(self._memory, self._look, LOOK_S)
        self._alike = 0

    @property
    def is_sure(self) -> bool:
        return self._alike >= SURE_AFTER

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        """Take new samples of some or all sensors."""
        self._looks.update(blocks)

    def _look(self, at_s: float) -> Generator[None, None, None]:
        speeds = self._note_lifts(at_s)
        blocks = {k: v for k, v in self._memory.between(at_s - KEPT_S, at_s).items() if k in speeds}
        lying = [name for name, block in blocks.items() if _spread_rad_s(block) < LYING_RAD_S]
        if len(blocks) == MOST and len(lying) == 1:  # a spare one beside the patient would pass for a pelvis that rests
            del blocks[lying[0]]
        moving = sum(speed > MOVING_RAD_S for speed in speeds.values())
        if len(blocks) not in USUAL_SITES or moving < min(2, len(blocks) - 1):  # one alone is being shaken
            return
        yield
        tracks = yield from tracks_in_steps(blocks, self._sensors)
        found = yield from chains_in_steps(tracks, self._standing)
        before, self.chains = self.chains, found and self._in_order(found)
        if found is None or not found.is_certain:
            self._alike = 0
        else:
            self._alike = self._alike + 1 if before is not None and _legs(before) == _legs(found) else 1

    def _note_lifts(self, at_s: float) -> dict[str, float]:
        """Mean speed over the last look's time of each sensor that is received; who was lifted in it is noted."""
        half_s = 0.5 * MOVING_WINDOW_S
        speeds = {}
        for name, block in self._memory.between(at_s - LOOK_S - 2 * half_s, at_s).items():
            speed, is_last = np.linalg.norm(block.gyr_rad_s, axis=1), block.time_s >= at_s - LOOK_S
            known = np.isfinite(speed)
            if not (known & is_last).any() or np.count_nonzero(known) < 2:
                continue
            speeds[name] = float(np.mean(speed[known & is_last]))
            time_s = block.time_s[known]
            mean = moving_mean(speed[known], max(1, round(MOVING_WINDOW_S / nominal_step_s(time_s))))
            is_whole = (time_s >= at_s - LOOK_S - half_s) & (time_s < at_s - half_s)
            lifted = np.flatnonzero((mean > LIFTED_RAD_S) & is_whole)
            if len(lifted):
                self._lifted_at_s.setdefault(name, float(time_s[lifted[0]]))
        return speeds

    def _in_order(self, chains: Chains) -> Chains:
        """The same legs in the order in which they were lifted, however long ago."""
        legs = [replace(leg, moved_at_s=self._moved_at_s(leg)) for leg in chains.legs]
        legs.sort(key=lambda leg: np.inf if leg.moved_at_s is None else leg.moved_at_s)
        at_s = [leg.moved_at_s for leg in legs]
        lead_s = None if len(at_s) < 2 or at_s[0] is None or at_s[1] is None else at_s[1] - at_s[0]
        return replace(chains, legs=tuple(legs), lead_s=lead_s)

    def _moved_at_s(self, leg: Chain) -> float | None:
        at_s = [self._lifted_at_s[name] for name in leg.sensors if name in self._lifted_at_s]
        return min(at_s, default=None)


def _legs(chains: Chains) -> set[tuple[str, ...]]:
    pelvis = () if chains.pelvis is None else (chains.pelvis,)
    return {pelvis, *(leg.sensors for leg in chains.legs)}


def _spread_rad_s(block: ImuBlock) -> float:
    known = block.gyr_rad_s[np.isfinite(block.gyr_rad_s).all(axis=1)]
    return float(np.sqrt(np.sum(np.var(known, axis=0)))) if len(known) else 0.0
