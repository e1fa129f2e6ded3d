"""Samples of one recording that were expected of each sensor, those that were received, and the longest gap."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from core.body import Site
from core.samples import ImuBlock
from core.session import Recording
from core.signal.reception import gaps_of, lost_percent
from core.signal.tracks import MAX_REPORTED_GAP_S, MIN_STRETCH_SAMPLES, is_received, nominal_step_s
from core.verdicts.gates import LIMITS

EDGE_S = 0.5  # sensors that start and end within less of each other miss nothing: their packets come at other times


@dataclass(frozen=True, slots=True)
class SamplesReceived:
    """`longest_gap_s`: 0 where no gap is longer than what the angles bridge without a report."""

    expected: int
    received: int
    longest_gap_s: float

    @property
    def lost_percent(self) -> float:
        return 100.0 * (1.0 - self.received / self.expected) if self.expected else 0.0

    @property
    def is_lossy(self) -> bool:
        """Whether strides may have suffered: more was lost than what the verdicts take as Good."""
        return self.longest_gap_s > MAX_REPORTED_GAP_S or self.lost_percent > LIMITS.lost_percent[0]


def samples_received(
    recording: Recording, nominal_hz: Mapping[Site, float | None], worn: Collection[Site] = ()
) -> dict[Site, SamplesReceived]:
    """Count by site; the time is that from the first to the last sample of all. Nothing where no sensor sent any.

    `nominal_hz`: as set; a site without has the rate of its stamps. `worn`: sites of sensors, also of silent ones.
    """
    blocks = {site: _received(block) for site, block in recording.imu.items()}
    filled = [block for block in blocks.values() if len(block) >= MIN_STRETCH_SAMPLES]
    if not filled:
        return {}
    begin_s = min(float(block.time_s[0]) for block in filled)
    end_s = max(float(block.time_s[-1]) for block in filled)
    usual_hz = max(1.0 / nominal_step_s(block.time_s) for block in filled)
    counts = {}
    for site in Site:
        block, rate_hz = blocks.get(site), nominal_hz.get(site)
        if block is not None and len(block) >= MIN_STRETCH_SAMPLES:
            counts[site] = _count(block, recording.imu[site], rate_hz, (begin_s, end_s))
        elif block is not None or site in worn:
            expected = round((end_s - begin_s) * (rate_hz or usual_hz)) + 1
            counts[site] = SamplesReceived(expected, len(block) if block is not None else 0, end_s - begin_s)
    return counts


def _received(block: ImuBlock) -> ImuBlock:
    return block.select(is_received(block.time_s, block.gyr_rad_s, block.acc_m_s2))


def _count(received: ImuBlock, whole: ImuBlock, rate_hz: float | None, span_s: tuple[float, float]) -> SamplesReceived:
    time_s = received.time_s
    edges_s = [float(time_s[0]) - span_s[0], span_s[1] - float(time_s[-1])]
    late_s = [edge_s for edge_s in edges_s if edge_s > EDGE_S]
    share = 1.0 - lost_percent(whole.time_s, time_s, rate_hz) / 100.0
    within = len(time_s) / share if share > 0.0 else len(time_s)
    expected = round(within + sum(late_s) * (rate_hz or 1.0 / nominal_step_s(time_s)))
    gaps_s = gaps_of(time_s)
    longest_s = max([0.0, *late_s, *(gaps_s[:, 1] - gaps_s[:, 0]).tolist()])
    return SamplesReceived(max(expected, len(time_s)), len(time_s), longest_s)
