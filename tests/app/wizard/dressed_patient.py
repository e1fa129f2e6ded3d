"""A simulated patient whose sensors have names, and streams cut into blocks of any size."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from core.body import LEG_SITES, Joint, Site
from core.calibration.rest import Rest, rest_of
from core.live.sensors import LiveSensor
from core.results import JointCalibration
from core.samples import ImuBlock
from core.session import Recording
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings
from tests.core.cut_blocks import part_of
from tests.simulated import analysis_of, session_of

Blocks = Mapping[str, ImuBlock]

BEGIN_S = 40.0  # the acquisition has been running for a while


@dataclass(frozen=True, slots=True)
class Worn:
    """A patient's recordings by the sensors' names, all of them beginning at BEGIN_S."""

    site_of: Mapping[str, Site]
    rests: Mapping[str, Rest]
    live_sensors: Mapping[str, LiveSensor]
    standing: Blocks
    free_motion: Blocks
    walk: Blocks
    calibration: Mapping[Joint, JointCalibration]

    def name_at(self, site: Site) -> str:
        return next(name for name, one in self.site_of.items() if one is site)


def dressed_patient() -> Worn:
    """Six sensors at 100 Hz; the left leg is moved first in the free motion, then the right one."""
    recordings = (
        Standing(duration_s=5.0),
        FreeMotion(duration_s=11.0, is_in_turn=True),
        Walk(strides=14, standing_after_s=3.0),
    )
    session = session_of(WalkerSettings(seed=3, tissue=Tissue.SOFT, recordings=recordings))
    site_of = {f"0A{number:02d}": site for number, site in enumerate((*LEG_SITES[3:], *LEG_SITES[:3]))}
    standing, free_motion, walk = (_by_name(recording, site_of) for recording in session.recordings)
    rests = {name: rest for name, block in standing.items() if (rest := rest_of(block)) is not None}
    assert set(rests) == set(site_of)
    return Worn(
        site_of=site_of,
        rests=rests,
        live_sensors={name: LiveSensor(100.0, rest.gyr_rad_s) for name, rest in rests.items()},
        standing=standing,
        free_motion=free_motion,
        walk=walk,
        calibration=analysis_of(session).calibrations[-1].joints,
    )


def in_blocks(streams: Blocks, block_s: float) -> Iterator[dict[str, ImuBlock]]:
    """Cut streams into blocks of so many seconds; sensors that sent nothing are missing."""
    first_s = min(float(block.time_s[0]) for block in streams.values())
    last_s = max(float(block.time_s[-1]) for block in streams.values())
    for from_s, to_s in pairwise(np.arange(first_s, last_s + 2 * block_s, block_s).tolist()):
        parts = {name: part_of(block, from_s, to_s) for name, block in streams.items()}
        yield {name: part for name, part in parts.items() if len(part)}


def without(block: ImuBlock, from_s: float, to_s: float) -> ImuBlock:
    """What a sensor sent that was silent between two instants."""
    kept = (block.time_s < from_s) | (block.time_s >= to_s)
    return ImuBlock(block.sensor, block.time_s[kept], block.gyr_rad_s[kept], block.acc_m_s2[kept])


def _by_name(recording: Recording, site_of: Mapping[str, Site]) -> dict[str, ImuBlock]:
    blocks = {name: recording.imu[site] for name, site in site_of.items()}
    return {name: replace(block, sensor=name, time_s=block.time_s + BEGIN_S) for name, block in blocks.items()}
