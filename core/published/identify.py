"""The paper's identification of one joint, from axes to centres, in its own order.

Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, sections 3.1.1 to 3.1.3. It knows no lag, no bias of the
accelerometers and no certainty; on people walking its axes can be far off, which is why it is shown beside the robust
identification and not instead of it.
"""

from dataclasses import dataclass

import numpy as np

from core.published.joint_axis import constraint, identify_axes
from core.published.joint_centre import identify_centres
from core.published.signs import signs_match
from core.samples import FloatArray
from core.signal.datasets import Datasets, moving_indices
from core.signal.pair import Pair
from core.signal.robust import robust_sd

DATA_SET_STEP_S = 0.1  # "about every tenth of a second" (eq 2)


@dataclass(frozen=True, slots=True)
class PublishedIdentification:
    """Axes and centres (3,) in sensor axes; `pairing_ratio`: congruence of Fig. 4 against its mirror."""

    axis_1: FloatArray
    axis_2: FloatArray
    centre_1_m: FloatArray
    centre_2_m: FloatArray
    pairing_ratio: float
    residual_rad_s: float


def data_sets(data: Datasets) -> Datasets:
    """One sample every tenth of a second."""
    keep = np.zeros(len(data), dtype=bool)
    for s, pair in enumerate(data.pairs):
        mine = np.flatnonzero(data.stretch == s)
        keep[mine[:: max(1, round(DATA_SET_STEP_S / pair.step_s))]] = True
    return data.only(keep)


def identify_as_published(axis_data: Datasets, centre_data: Datasets) -> PublishedIdentification:
    """Identify axes from one motion and centres from another: for the ankle, walks and circling.

    Returns
    -------
    PublishedIdentification
        In sensor axes. Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, eqs 3 to 8.
    """
    sets = data_sets(axis_data)
    j1, j2 = identify_axes(sets.g1, sets.g2)
    is_match, clarity = _vote(axis_data.pairs, j1, j2)
    if not is_match:
        j2 = -j2
    at = data_sets(centre_data)
    o1, o2 = identify_centres(at.a1, at.a2, at.g1, at.g2, at.dg1, at.dg2)
    return PublishedIdentification(
        axis_1=j1,
        axis_2=j2,
        centre_1_m=o1,
        centre_2_m=o2,
        pairing_ratio=(1 + clarity) / max(1 - clarity, 1e-3),
        residual_rad_s=robust_sd(constraint(sets.g1, sets.g2, j1, j2)),
    )


def _vote(pairs: tuple[Pair, ...], j1: FloatArray, j2: FloatArray) -> tuple[bool, float]:
    """The congruence of every stretch, weighted by how clear it is and how long it lasts."""
    total = weight = 0.0
    for pair in pairs:
        index = moving_indices(pair)
        if len(index):
            part = slice(int(index[0]), int(index[-1]) + 1)
            is_match, clarity = signs_match(pair.g1[part], pair.g2[part], j1, j2, pair.step_s)
            total += (clarity if is_match else -clarity) * len(index)
            weight += len(index)
    return total >= 0, abs(total) / max(weight, 1.0)
