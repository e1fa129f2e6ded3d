"""The samples that identify a joint: the sets S(i) of eq 2, from any number of stretches and recordings."""

from dataclasses import dataclass, replace

import numpy as np

from core.samples import BoolArray, FloatArray, IntArray
from core.signal.pair import Pair

KNOT_SPACING_S = 10.0  # relative heading is linear between knots this far apart
HEADING_WALK_RAD = np.deg2rad(0.3)  # per square root of a second: drift of two gyroscopes' headings


@dataclass(frozen=True, slots=True)
class Datasets:
    """Samples of both sensors at chosen instants of several stretches, each stretch with heading knots of its own.

    Signals as in `Pair`, all (n, ...); `index` (n,) is the sample's index in its pair, `stretch` (n,) which pair.
    `knot_left` (n,) and `knot_share` (n,): the heading at a sample is (1 - share) knot[left] + share knot[left + 1].
    """

    pairs: tuple[Pair, ...]
    stretch: IntArray
    index: IntArray
    time_s: FloatArray
    g1: FloatArray
    g2: FloatArray
    a1: FloatArray
    a2: FloatArray
    dg1: FloatArray
    dg2: FloatArray
    earth_from_1: FloatArray
    earth_from_2: FloatArray
    knot_left: IntArray
    knot_share: FloatArray
    knot_spacing_s: FloatArray  # (knots - 1,), NaN between two stretches

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def knots(self) -> int:
        return len(self.knot_spacing_s) + 1

    def heading(self, knots_rad: FloatArray) -> FloatArray:
        """Headings (..., n) at the samples from knots (..., k)."""
        left = knots_rad[..., self.knot_left]
        right = knots_rad[..., np.minimum(self.knot_left + 1, self.knots - 1)]
        return left + self.knot_share * (right - left)

    def only(self, keep: BoolArray | IntArray) -> "Datasets":
        """The samples where `keep` (n,) holds, or of those numbers, with all knots."""
        index = np.flatnonzero(keep) if keep.dtype == np.bool_ else keep
        mine = {name: getattr(self, name).take(index, axis=0) for name in _PER_SAMPLE}
        return replace(self, **mine)

    def thinned(self, count: int) -> "Datasets":
        """About `count` of the samples, evenly spread."""
        if count >= len(self):
            return self
        return self.only(np.linspace(0, len(self) - 1, count).astype(np.int64))


_SIGNALS = ("time_s", "g1", "g2", "a1", "a2", "dg1", "dg2", "earth_from_1", "earth_from_2")
_PER_SAMPLE = (*_SIGNALS, "stretch", "index", "knot_left", "knot_share")


def moving_indices(pair: Pair, max_rate_rad_s: float = np.inf) -> IntArray:
    """Give indices (m,) of the known samples from first to last movement, both sensors below a rate."""
    moving = np.flatnonzero(pair.is_moving)
    if len(moving) == 0:
        return np.empty(0, dtype=np.int64)
    is_used = pair.is_known.copy()
    is_used[: moving[0]] = is_used[moving[-1] + 1 :] = False
    index: IntArray = np.flatnonzero(is_used)
    return slow_ones(pair, index, max_rate_rad_s) if np.isfinite(max_rate_rad_s) else index


def slow_ones(pair: Pair, index: IntArray, max_rate_rad_s: float) -> IntArray:
    """Give those of `index` (m,) at which both sensors turn more slowly than the rate."""
    squares = [np.einsum("ni,ni->n", rate, rate) for rate in (pair.g1, pair.g2)]
    return index[(np.maximum(*squares) < max_rate_rad_s**2)[index]]


def united(parts: list[Datasets]) -> Datasets:
    """All samples of several data sets."""
    pairs = tuple(pair for part in parts for pair in part.pairs)
    return gather(pairs, [part.index[part.stretch == s] for part in parts for s in range(len(part.pairs))])


def knot_positions(pair: Pair) -> tuple[int, FloatArray]:
    """Give the number of intervals between heading knots, and each sample's position (n,) in intervals."""
    intervals = max(1, round(pair.duration_s / KNOT_SPACING_S))
    return intervals, (pair.time_s - pair.time_s[0]) / pair.duration_s * intervals


def knot_sums(left: IntArray, share: FloatArray, values: FloatArray, knots: int) -> FloatArray:
    """Sum values (n,) to knots (k,), shared between the knot to the left and the next, `share` of it (0 to 1)."""
    sums = np.bincount(left, (1 - share) * values, knots) + np.bincount(left + 1, share * values, knots)
    return sums.astype(np.float64)


def knot_products(left: IntArray, share: FloatArray, weight: FloatArray, knots: int) -> FloatArray:
    """Give S' diag(weight) S (k, k), with S (n, k) the knots' shares; `share` is the next knot's, 0 to 1."""
    product = np.zeros((knots, knots))
    own = np.bincount(left, (1 - share) ** 2 * weight, knots) + np.bincount(left + 1, share**2 * weight, knots)
    mixed = np.bincount(left, share * (1 - share) * weight, knots)[: knots - 1]
    row = np.arange(knots)
    product[row, row] = own
    product[row[:-1], row[1:]] = product[row[1:], row[:-1]] = mixed
    return product


def gather(pairs: tuple[Pair, ...], indices: list[IntArray]) -> Datasets:
    """Join the samples at each pair's ascending indices, in the order of the pairs."""
    left, share, spacing, stretch = [], [], [], []
    first_knot = 0
    for s, (pair, index) in enumerate(zip(pairs, indices, strict=True)):
        intervals, position = knot_positions(pair)
        whole = np.minimum(position[index].astype(int), intervals - 1)
        left.append(first_knot + whole)
        share.append(position[index] - whole)
        if s:
            spacing.append([np.nan])
        spacing.append([pair.duration_s / intervals] * intervals)
        stretch.append(np.full(len(index), s))
        first_knot += intervals + 1

    signals = {
        name: np.concatenate(
            [getattr(pair, name).take(index, axis=0) for pair, index in zip(pairs, indices, strict=True)]
        )
        for name in _SIGNALS
    }
    return Datasets(
        pairs=pairs,
        stretch=np.concatenate(stretch),
        index=np.concatenate(indices),
        knot_left=np.concatenate(left),
        knot_share=np.concatenate(share),
        knot_spacing_s=np.concatenate(spacing),
        **signals,
    )
