"""Each sensor's samples without gyroscope bias, and its orientation: found once, shared by its two joints."""

from dataclasses import dataclass, field

import numpy as np

from core.body import Joint, Site
from core.calibration.rest import Rest, rest_of
from core.calibration.validity import in_force
from core.gait.foot import FootMotion, follow
from core.samples import FloatArray, RateKind
from core.session import Recording, RecordingKind, Session
from core.signal.orientation import oriented
from core.signal.pair import OrientedTrack, Pair
from core.signal.tracks import Block, blocks_of, even_tracks


@dataclass(frozen=True, slots=True)
class GyroBias:
    """Bias (3,) rad/s and the recording whose rest gave it; None and zero when no sensor ever lay still."""

    rad_s: FloatArray
    source: str | None


@dataclass(slots=True)
class SensorTracks:
    """Oriented tracks of one span of validity, remembered while they are small.

    `rate_kind` holds for sensors that do not name theirs. `pairs` of first blocks, the last few, by recording, joint
    and lag, are kept by `measure.pairs_of`.
    """

    session: Session
    span: tuple[Recording, ...]
    unusable: frozenset[tuple[str, Site]]
    rate_kind: RateKind
    pairs: dict[tuple[str, Joint, float], list[Pair]] = field(default_factory=dict)
    _tracks: dict[tuple[str, Site, int], list[OrientedTrack]] = field(default_factory=dict)
    _motions: dict[tuple[str, Site], list[FootMotion]] = field(default_factory=dict)
    _spans: dict[str, tuple[float, float]] = field(default_factory=dict)
    _rests: dict[tuple[str, Site], Rest | None] = field(default_factory=dict)

    def is_usable(self, recording: Recording, *sites: Site) -> bool:
        return recording.holds(*sites) and not any((recording.name, site) in self.unusable for site in sites)

    def rest(self, recording: Recording, site: Site) -> Rest | None:
        key = (recording.name, site)
        if key not in self._rests:
            self._rests[key] = rest_of(recording.imu[site]) if self.is_usable(recording, site) else None
        return self._rests[key]

    def gyro_bias(self, recording: Recording, site: Site) -> GyroBias:
        """From standing, else from still moments of the recording itself, else of any other."""
        standing = in_force(self.span, recording, RecordingKind.STANDING, (site,), self.is_usable)
        others = [r for r in self.span if r is not recording and r is not standing]
        for source in [standing, recording, *others]:
            if source is not None and source.holds(site):
                rest = self.rest(source, site)
                if rest is not None:
                    return GyroBias(rest.gyr_rad_s, source.name)
        return GyroBias(np.zeros(3), None)

    def span_of(self, recording: Recording) -> tuple[float, float]:
        """First and last stamp of the usable sites."""
        if recording.name not in self._spans:
            used = [b.time_s for s, b in recording.imu.items() if len(b) and (recording.name, s) not in self.unusable]
            first = min((float(t[0]) for t in used), default=0.0)
            self._spans[recording.name] = first, max((float(t[-1]) for t in used), default=first)
        return self._spans[recording.name]

    def blocks(self, recording: Recording) -> list[Block]:
        return list(blocks_of(*self.span_of(recording)))

    def oriented(self, recording: Recording, site: Site, block: Block) -> list[OrientedTrack]:
        """Tracks of one block of a recording; only first blocks, which identify the joints, are remembered for long."""
        key = (recording.name, site, block.number)
        if key not in self._tracks:
            for old in [k for k in self._tracks if k[2] > 0 and k[2] != block.number]:
                del self._tracks[old]
            bias = self.gyro_bias(recording, site).rad_s
            info = self.session.sensors.get(site)
            kind = (info.rate_kind if info else None) or self.rate_kind
            if recording.imu[site].is_rate_derived:
                kind = RateKind.INSTANTANEOUS
            tracks = even_tracks(recording.imu[site], block.from_s, block.to_s)
            self._tracks[key] = [oriented(track, kind, bias) for track in tracks]
        return self._tracks[key]

    def foot_motions(self, recording: Recording, site: Site, block: Block) -> list[FootMotion]:
        """How a foot travels over each of its tracks in one block; of first blocks remembered."""
        key = (recording.name, site)
        if block.number or key not in self._motions:
            motions = [follow(foot) for foot in self.oriented(recording, site, block)]
            if block.number:
                return motions
            self._motions[key] = motions
        return self._motions[key]
