"""Blocks of samples cut into shorter ones, as they arrive, and sessions some of whose blocks are spoilt."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from core.body import LEG_SITES, Site
from core.samples import ImuBlock
from core.session import Session

Change = Callable[[ImuBlock], ImuBlock]


def part_of(block: ImuBlock, from_s: float, to_s: float) -> ImuBlock:
    return block.select(slice(*np.searchsorted(block.time_s, [from_s, to_s]).tolist()))


def in_blocks(imu: Mapping[Site, ImuBlock], block_s: float) -> Iterator[dict[Site, ImuBlock]]:
    """As they arrive: each as many seconds of every site."""
    end_s = max(float(block.time_s[-1]) for block in imu.values())
    for a, b in pairwise(np.arange(0.0, end_s + 2 * block_s, block_s)):
        yield {site: part_of(block, a, b) for site, block in imu.items()}


def changed(session: Session, change: Change, sites: tuple[Site, ...] = LEG_SITES, *names: str) -> Session:
    """The session with the blocks of some sites (and of some recordings only) spoiled."""
    recordings = []
    for r in session.recordings:
        imu = {s: change(b) if s in sites and (not names or r.name in names) else b for s, b in r.imu.items()}
        recordings.append(replace(r, imu=imu))
    return replace(session, recordings=tuple(recordings))


def turned(block: ImuBlock, turn: Rotation, from_s: float = -np.inf) -> ImuBlock:
    """The sensor turned in its mounting, from an instant on."""
    late = (block.time_s >= from_s)[:, None]
    gyr, acc = (np.where(late, turn.apply(values), values) for values in (block.gyr_rad_s, block.acc_m_s2))
    return replace(block, gyr_rad_s=gyr, acc_m_s2=acc)


def about_the_vertical(standing: ImuBlock, angle_rad: float) -> Rotation:
    """A turn about what is up for a sensor at rest."""
    up = standing.acc_m_s2.mean(axis=0)
    return Rotation.from_rotvec(angle_rad * up / np.linalg.norm(up))


def first(n: int) -> Change:
    """Only so many samples of a block."""
    return lambda block: block.select(slice(n))
