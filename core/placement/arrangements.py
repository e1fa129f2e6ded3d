"""All ways to put the sensors on the sites, ranked by how well adjacent sensors share their joints."""

from collections.abc import Generator, Mapping
from dataclasses import dataclass
from itertools import combinations, permutations

import numpy as np

from core.body import LEG_JOINTS, Joint, Side, Site
from core.placement.links import link
from core.placement.smoothed_tracks import SmoothedTracks
from core.samples import FloatArray, IntArray

COST_FLOOR = 0.1  # two links that leave less than this are equally good

Arrangement = Mapping[Site, int]
"""Which sensor, by its number, sits at each site."""


@dataclass(frozen=True, slots=True)
class Adjacent:
    """What every two of s sensors show of a joint between them."""

    names: tuple[str, ...]  # (s,)
    cost: FloatArray  # (s, s): what they disagree on there, as a mean robust loss; symmetric
    height_m: FloatArray  # (s, s): how much higher the first sits than the second in standing, if they share one
    length_m: FloatArray  # (s, s): from the first to the joint and on to the second; symmetric


def adjacent_in_steps(
    smoothed: SmoothedTracks, standing: Mapping[str, FloatArray]
) -> Generator[None, None, Adjacent | None]:
    """Try a joint between every two sensors, a step each; None where two never gave samples together."""
    names = tuple(smoothed.sensors)
    ups = [standing.get(name, one.up) for name, one in smoothed.sensors.items()]
    ups = [up / np.linalg.norm(up) for up in ups]
    cost, height_m, length_m = np.zeros((3, len(names), len(names)))
    for a, b in combinations(range(len(names)), 2):
        found = link(smoothed.sensors[names[a]], smoothed.sensors[names[b]], smoothed.index, smoothed.window)
        if found is None:
            return None
        cost[a, b] = cost[b, a] = found.cost
        height_m[a, b] = found.centre_1_m @ ups[a] - found.centre_2_m @ ups[b]
        height_m[b, a] = -height_m[a, b]
        length_m[a, b] = length_m[b, a] = np.linalg.norm(found.centre_1_m) + np.linalg.norm(found.centre_2_m)
        yield
    return Adjacent(names, cost, height_m, length_m)


class Arrangements:
    """All ways to put the sensors on `sites`, each with what its joints cost together."""

    def __init__(self, sites: tuple[Site, ...], adjacent: Adjacent) -> None:
        self._sites = sites
        self._number = number = len(adjacent.names)
        ends = [(sites.index(j.proximal), sites.index(j.distal)) for j in joints_between(sites)]
        self._orders = orders = np.array(list(permutations(range(number))), dtype=np.int64)
        pairs = [(orders[:, a], orders[:, b]) for a, b in ends]
        self._cost = np.sum([np.log(adjacent.cost[pair] + COST_FLOOR) for pair in pairs], axis=0)
        # a bit for each two sensors that share a joint
        self._links: IntArray = np.sum([self._bit(*pair) for pair in pairs], axis=0)

    def _bit(self, one: IntArray, other: IntArray) -> IntArray:
        return np.int64(1) << (np.minimum(one, other) * self._number + np.maximum(one, other))

    def best(self) -> Arrangement:
        return self._arrangement(int(np.argmin(self._cost)))

    def alike(self, arrangement: Arrangement) -> list[Arrangement]:
        """Those with the same two sensors at every joint: legs read from the other end, left for right."""
        same = self._links == self._links[self._index(arrangement)]
        return [self._arrangement(k) for k in np.flatnonzero(same).tolist()]

    def margin(self, arrangement: Arrangement, joint: Joint | None = None) -> float:
        """Give the best rival's cost over this one's, infinite without one; rivals part the joint's sensors."""
        mine = self._index(arrangement)
        is_rival = self._links != self._links[mine]
        if joint is not None:
            ends = (np.array(arrangement[site]) for site in (joint.proximal, joint.distal))
            is_rival = (self._links & self._bit(*ends)) == 0
        return float(np.exp(self._cost[is_rival].min() - self._cost[mine])) if is_rival.any() else float("inf")

    def ratio(self, one: Arrangement, other: Arrangement) -> float:
        """Cost of one arrangement over that of another."""
        return float(np.exp(self._cost[self._index(one)] - self._cost[self._index(other)]))

    def _arrangement(self, index: int) -> Arrangement:
        return dict(zip(self._sites, self._orders[index].tolist(), strict=True))

    def _index(self, arrangement: Arrangement) -> int:
        order = [arrangement[site] for site in self._sites]
        return int(np.flatnonzero((self._orders == order).all(axis=1))[0])


def joints_between(sites: tuple[Site, ...]) -> list[Joint]:
    """The joints whose two sites are both among `sites`: knees and ankles, then hips."""
    every = (*LEG_JOINTS, *(joint for joint in Joint if joint.is_hip))
    return [joint for joint in every if joint.proximal in sites and joint.distal in sites]


@dataclass(frozen=True, slots=True)
class Stature:
    """How much higher a leg's thigh sensor sits than its last in standing, and how far it is along the joints, m."""

    height_m: float
    length_m: float

    @property
    def uprightness(self) -> float:
        """1 a leg that hangs straight down, -1 one whose first sensor is its lowest; 0 where no joint has a place."""
        return self.height_m / self.length_m if self.length_m > 0 else 0.0


def statures(arrangement: Arrangement, adjacent: Adjacent) -> dict[Side, Stature]:
    """The stature of every leg that has a joint."""
    found: dict[Side, Stature] = {}
    for joint in (joint for joint in joints_between(tuple(arrangement)) if not joint.is_hip):
        ends = arrangement[joint.proximal], arrangement[joint.distal]
        above = found.get(joint.side, Stature(0.0, 0.0))
        height_m, length_m = float(adjacent.height_m[ends]), float(adjacent.length_m[ends])
        found[joint.side] = Stature(above.height_m + height_m, above.length_m + length_m)
    return found
