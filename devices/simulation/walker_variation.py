"""How simulated gait varies from stride to stride, over a walk, from walk to walk and from strapping to strapping."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from core.body import Joint, Side, Site
from core.samples import FloatArray
from devices.simulation.walker_body import NO_CHANGE, GaitChange, Walk, WalkerSettings
from devices.simulation.walker_motion import LegMotion, rotation_about

LARGEST_FACTOR = 1.4  # of a stride's time or length
# the ranges that a strapping's knee_deg and ankle_deg refer to: the walker's own in ordinary walking
KNEE_RANGE_DEG, ANKLE_RANGE_DEG = 59.0, 25.0


@dataclass(frozen=True, slots=True)
class FootChanges:
    """What is added in each stride of one foot, (strides,)."""

    knee_deg: FloatArray
    ankle_deg: FloatArray
    stance_percent: FloatArray


@dataclass(frozen=True, slots=True)
class StepChanges:
    """What differs from stride to stride; `time` and `length` (strides,) are factors. Empty: nothing."""

    feet: Mapping[Side, FootChanges] = field(default_factory=dict)
    time: FloatArray | None = None
    length: FloatArray | None = None

    def of_steps(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Factors (count,) of each step's time and length, two steps to a stride."""
        factors = (np.ones(count) if f is None else np.repeat(f, 2) for f in (self.time, self.length))
        time, length = (np.clip(f, 1.0 / LARGEST_FACTOR, LARGEST_FACTOR) for f in factors)
        return time, length

    def of_foot(self, side: Side, strides: int) -> FootChanges:
        return self.feet.get(side) or FootChanges(*(np.zeros(strides) for _ in range(3)))


NO_CHANGES = StepChanges()


def draw_changes(settings: WalkerSettings, number: int, strapping: int, walk: Walk) -> StepChanges:
    """All that differs in the strides of recording `number`, worn with the straps of recording `strapping`."""
    variation = settings.variation
    both = StrideSeries(settings, number, strapping, walk, len(Side))
    feet = {}
    for k, side in enumerate(Side):
        series = StrideSeries(settings, number, strapping, walk, k)
        is_changed = walk.changed_side in (None, side)
        change = walk.change if is_changed else NO_CHANGE
        feet[side] = FootChanges(
            # a strapping changes what sensors report of a joint, not the joint
            knee_deg=series.of("knee_deg", change.knee_deg, 0.0),
            ankle_deg=series.of("ankle_deg", change.ankle_deg, 0.0),
            stance_percent=series.of("stance_percent", change.stance_percent, variation.strappings.stance_percent),
        )
    time = 1.0 + both.of("time", walk.change.time, variation.strappings.time)
    length = 1.0 + both.of("length", walk.change.length, variation.strappings.length)
    return StepChanges(feet, time, length)


class StrideSeries:
    """Draws one series per quantity, with a stream of chance for each, so that none depends on what else varies."""

    def __init__(self, settings: WalkerSettings, number: int, strapping: int, walk: Walk, who: int) -> None:
        self._settings = settings
        self._keys = (number, strapping, who)
        self._walk = walk

    def of(self, name: str, change: float, strapping_sd: float) -> FloatArray:
        """A constant, a drift and chance that remembers the stride before, summed: (strides,)."""
        number, strapping, who = self._keys
        what = list(GaitChange.__dataclass_fields__).index(name)
        variation, n = self._settings.variation, self._walk.strides
        rng = np.random.default_rng([self._settings.seed, 10, number, who, what])
        of_strapping = np.random.default_rng([self._settings.seed, 11, strapping, who, what]).normal() * strapping_sd
        of_walk = rng.normal() * getattr(variation.walks, name)
        noise = rng.normal(size=n)
        for k in range(1, n):
            noise[k] = variation.correlation * noise[k - 1] + np.sqrt(1.0 - variation.correlation**2) * noise[k]
        total = getattr(self._walk.drift, name)
        drift = total * np.linspace(0.0, 1.0, n)
        if self._walk.is_drift_random:
            drift = total * np.cumsum(rng.normal(size=n)) / np.sqrt(n)
        return change + of_strapping + of_walk + drift + getattr(variation.strides, name) * noise


def draw_gain(settings: WalkerSettings, joint: Joint, strapping: int) -> float:
    """Draw by what share of the angle a joint's sensors read more (0.1 is 10 %), with that strapping."""
    who = list(Joint).index(joint)
    of_leg = np.random.default_rng([settings.body, 12, who]).normal()
    of_strap = np.random.default_rng([settings.seed, 13, who, strapping]).normal()
    sds = settings.variation.strappings
    if joint.is_knee:
        gain = settings.tissue_gain + settings.tissue_gain_sd * of_leg
        return float(gain + sds.knee_deg / KNEE_RANGE_DEG * of_strap)
    return float(sds.ankle_deg / ANKLE_RANGE_DEG * of_strap)


def follow_joint(leg: LegMotion, axis: FloatArray, joint: Joint, site: Site, gain: float) -> FloatArray | None:
    """Give the rotation (n, 3, 3) by which a thigh's sensor lags or a foot's leads; None without."""
    if gain == 0.0 or site is not (joint.proximal if joint.is_knee else joint.distal):
        return None
    return rotation_about(axis, -gain * leg.angles.knee if joint.is_knee else gain * leg.angles.ankle)
