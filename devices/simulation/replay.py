"""A recorded or simulated patient who sends now, in real time, and who does what is asked."""

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count

import numpy as np

from core.body import LEG_SITES, Site
from core.samples import BoolArray, ImuBlock, SensorInfo
from core.session import Recording, RecordingKind, Session
from devices.clocks.host_clock import host_time_ns
from devices.live import Keep, SensorDetails, SourceLostError, SourceRefusedError
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Motion, Standing, Walk, WalkerSettings, simulate
from devices.source import SourceInfo

DRIVER, VERSION = "replay", "1"
POLL_S = 0.015
PATIENCE_S = 30.0  # for a movement to be finished that nobody asks for any more
BUFFER_S = 5.0  # what a sensor or a port holds for a program that does not read; older samples are lost
SHAKE_S, SHAKE_HZ, SHAKE_RAD_S, SHAKE_M_S2 = 2.0, 4.0, 6.0, 15.0
SHAKEN_ALONG = np.array([0.8, 0.5, 0.3])
SEAM_S = 1e-4  # more than rounding, less than any sampling interval
DEMONSTRATION_TIMES = range(1, 7)
# none but the patient's pose while standing joins them: each begins and ends with it
DEMONSTRATION_SESSION = replace(
    DEMONSTRATION,
    recordings=(
        Standing(duration_s=10.0),
        *(FreeMotion(name=f"free motion {number}", duration_s=6.0) for number in DEMONSTRATION_TIMES),
        *(Walk(name=f"walk {number}", strides=14, standing_before_s=2.0) for number in DEMONSTRATION_TIMES),
    ),
)
# With a seventh sensor: two lunges come first, for circling legs do not show the hips, and walks go there and back.
DEMONSTRATION_WITH_PELVIS = replace(
    DEMONSTRATION,
    sites=(*LEG_SITES, Site.PELVIS),
    recordings=(
        Standing(duration_s=10.0),
        FreeMotion(name="free motion 1", duration_s=6.8, motion=Motion.LUNGES),
        *(FreeMotion(name=f"free motion {number}", duration_s=6.0) for number in (2, 3, 4)),
        *(Walk(name=f"walk {number}", strides=20, turn_rad=np.pi, standing_before_s=2.0) for number in (1, 2, 3)),
    ),
)
# as on a label, so that a name does not say where the sensor is worn
DEMONSTRATION_NAMES = {
    Site.LEFT_THIGH: "DEMO-09",
    Site.LEFT_SHANK: "DEMO-31",
    Site.LEFT_FOOT: "DEMO-2C",
    Site.RIGHT_THIGH: "DEMO-17",
    Site.RIGHT_SHANK: "DEMO-1B",
    Site.RIGHT_FOOT: "DEMO-22",
    Site.PELVIS: "DEMO-3E",
}


@dataclass(frozen=True, slots=True)
class ReplayFaults:
    """What goes wrong on the way, by sensor.

    `lag_s`: by how much later a sensor's samples come and are stamped than they were taken.
    `silent_s`: from when to when a sensor sends nothing, since the source was first opened.
    """

    loss_share: float = 0.0  # of all samples, each by chance
    lag_s: Mapping[str, float] = field(default_factory=dict)
    silent_s: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    seed: int = 0


NO_FAULTS = ReplayFaults()


@dataclass(frozen=True, slots=True)
class _Clip:
    """A recording that is being played: what it recorded at `first_s` is sent at `start_s` on the source's clock."""

    start_s: float
    first_s: float
    length_s: float
    imu: Mapping[str, ImuBlock]
    is_idle: bool

    @property
    def end_s(self) -> float:
        return self.start_s + self.length_s


class ReplaySource:
    """Plays a session's recordings as if its sensors sent them now, and standing, over and over, in between.

    Where a session has no standing, its first recording is played instead. What is played is simulated, whoever was
    recorded: it is nobody's visit of today.

    Parameters
    ----------
    speed
        Above 1, time runs faster: for what listens too, if it is given this source's `now_ns`.
    finishes
        The patient ends a movement before the next one, and moves freely until something else is asked; else a
        recording is cut short at once, and its last pose jumps to the next one's.
    """

    has_bytes = False
    sent: Sequence[bytes] = ()

    def __init__(
        self,
        session: Session,
        *,
        faults: ReplayFaults = NO_FAULTS,
        speed: float = 1.0,
        finishes: bool = False,
        name: str = "demonstration",
        now_ns: Callable[[], int] = host_time_ns,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        if not session.recordings or not all(any(map(len, recording.imu.values())) for recording in session.recordings):
            raise ValueError("a recording without samples cannot be played")
        self.now_ns = now_ns if speed == 1.0 else _faster(now_ns, speed)
        self._sleep, self._faults, self._finishes = sleep, faults, finishes
        self._buffer_s = BUFFER_S * speed  # whoever reads is no faster
        self._names = names_of(session)
        self._by_kind = {kind: [r for r in session.recordings if r.kind is kind] for kind in RecordingKind}
        self._turns = {kind: count() for kind in RecordingKind}
        self._idle = (self._by_kind[RecordingKind.STANDING] or list(session.recordings))[0]
        self._details = {
            name: _details(session.sensors.get(site, SensorInfo()), name, _longest(session, site))
            for site, name in self._names.items()
        }
        self._steps_s = {name: 1.0 / details.rate_hz for name, details in self._details.items() if details.rate_hz}
        self.info = SourceInfo(DRIVER, VERSION, name, tuple(self._names.values()), is_simulated=True)
        self._chance = {name: np.random.default_rng([faults.seed, k]) for k, name in enumerate(self._details)}
        self._lock = threading.Lock()  # of all below, which is changed from any thread
        self._clips: list[_Clip] = []
        self._asked: RecordingKind | None = None  # and not begun yet
        self._ordered: Recording | None = None  # to be played for it
        self._read_to_s = self._opened_s = 0.0
        self.is_open = self._is_away = False
        self._silenced: frozenset[str] = frozenset()
        self._shaken_s: dict[str, float] = {}

    def open(self) -> None:
        with self._lock:
            if self._is_away:
                raise SourceRefusedError("The sensors do not respond", "Check that they are switched on and in range")
            now_s = self._now_s()
            if not self._clips:
                self._opened_s = now_s
                self._clips = [self._clip(self._idle, now_s)]
            self._read_to_s = now_s
            self.is_open = True

    def read(self, keep: Keep) -> Sequence[ImuBlock]:
        self._sleep(POLL_S)
        with self._lock:
            if self._is_away or not self.is_open:
                raise SourceLostError("the simulated sensors went away")
            now_s = self._now_s()
            from_s = max(self._read_to_s, now_s - self._buffer_s)
            self._play_on(now_s)
            blocks = [block for name in self._details for block in self._sent(name, from_s, now_s)]
            oldest_s = min(from_s, now_s) - max(self._faults.lag_s.values(), default=0.0)
            self._clips = [clip for clip in self._clips if clip.end_s > oldest_s]
            self._read_to_s = now_s
            return [block for block in blocks if len(block)]

    def close(self) -> None:
        with self._lock:
            self.is_open = False

    def details(self) -> Mapping[str, SensorDetails]:
        return self._details

    def identify(self, sensor: str) -> bool:
        """Shake it: nobody sees a light on it."""
        self.shake(sensor)
        return True

    def ask(self, kind: RecordingKind | None) -> float | None:
        """Begin with the next recording of this kind, at once or after the present one; then stand.

        What would go on for longer than `PATIENCE_S` is broken off, whether or not the patient finishes.
        """
        return self._begin(kind, None)

    def play(self, recording: Recording) -> None:
        """Begin with this recording, as with one of its kind that was asked for."""
        self._begin(recording.kind, recording)

    def _begin(self, kind: RecordingKind | None, ordered: Recording | None) -> float | None:
        with self._lock:
            if not self._clips:
                return None
            now_s = self._now_s()
            self._play_on(now_s)
            self._asked, self._ordered = kind, ordered
            playing = self._clips[-1]
            if self._finishes and not playing.is_idle and playing.end_s - now_s < PATIENCE_S:
                return None
            at_s = min(self._next_tick_s(playing.start_s, now_s), playing.end_s)
            self._clips[-1] = replace(playing, length_s=at_s - playing.start_s)
            self._clips.append(self._next_clip(at_s))
            if self._finishes or kind is None:
                return None
            return self._clips[-1].end_s - now_s if self._by_kind[kind] else 0.0

    def _next_clip(self, start_s: float) -> _Clip:
        recording, self._ordered = self._ordered or self._next(self._asked), None
        if not (self._finishes and self._asked is RecordingKind.FREE_MOTION):
            self._asked = None
        return self._clip(recording, start_s)

    def _next(self, kind: RecordingKind | None) -> Recording:
        if kind is None or not self._by_kind[kind]:
            return self._idle
        return self._by_kind[kind][next(self._turns[kind]) % len(self._by_kind[kind])]

    # what goes wrong on demand

    def silence(self, sensor: str) -> None:
        """Let one sensor send nothing more."""
        with self._lock:
            self._silenced |= {sensor}

    def wake(self, sensor: str) -> None:
        """Let a silenced sensor send again."""
        with self._lock:
            self._silenced -= {sensor}

    def vanish(self) -> None:
        """Unplug the whole source: it is lost, and does not open again."""
        with self._lock:
            self._is_away = True

    def come_back(self) -> None:
        """Plug it in again; what was measured meanwhile is lost."""
        with self._lock:
            self._is_away = False

    def shake(self, sensor: str) -> None:
        """Shake one sensor for two seconds."""
        with self._lock:
            self._shaken_s[sensor] = self._now_s()

    def _now_s(self) -> float:
        return self.now_ns() / 1e9

    def _clip(self, recording: Recording, start_s: float) -> _Clip:
        imu = {self._names[site]: block for site, block in recording.imu.items() if len(block)}
        first_s = min(block.time_s[0] for block in imu.values())
        # one step longer than from the first stamp to the last: there the next recording's first sample follows
        ends = [block.time_s[-1] + self._steps_s[name] for name, block in imu.items()]
        return _Clip(start_s, float(first_s), float(max(ends) - first_s), imu, recording is self._idle)

    def _play_on(self, to_s: float) -> None:
        if to_s - self._clips[-1].end_s > self._buffer_s:  # the machine slept
            self._clips = [self._clip(self._idle, self._next_tick_s(self._clips[-1].end_s, to_s - self._buffer_s))]
        while self._clips[-1].end_s <= to_s:
            self._clips.append(self._next_clip(self._clips[-1].end_s))

    def _next_tick_s(self, since_s: float, at_s: float) -> float:
        """The next instant of the sensors' clock that ticked at `since_s`: they go on as evenly as before."""
        step_s = max(self._steps_s.values())
        return since_s + float(np.ceil((at_s - since_s) / step_s)) * step_s

    def _sent(self, name: str, from_s: float, to_s: float) -> list[ImuBlock]:
        """What a sensor sends of what it measured from..to; a piece of each recording that was played."""
        lag_s = self._faults.lag_s.get(name, 0.0)
        pieces = [_piece(clip, name, from_s - lag_s, to_s - lag_s, lag_s) for clip in self._clips if name in clip.imu]
        return [self._shaken(self._kept(piece)) for piece in pieces if len(piece)]

    def _kept(self, block: ImuBlock) -> ImuBlock:
        """Without what is lost on the way."""
        if self._faults is NO_FAULTS and not self._silenced:
            return block
        name, since_opened_s = block.sensor, block.time_s - self._opened_s
        is_sent = self._chance[name].random(len(block)) >= self._faults.loss_share
        silent_from_s, silent_to_s = self._faults.silent_s.get(name, (0.0, 0.0))
        is_sent &= (since_opened_s < silent_from_s) | (since_opened_s >= silent_to_s)
        if name in self._silenced:
            is_sent[:] = False
        return _rows(block, is_sent, name, 0.0)

    def _shaken(self, block: ImuBlock) -> ImuBlock:
        if block.sensor not in self._shaken_s:
            return block
        since_s = block.time_s - self._shaken_s[block.sensor]
        strength = np.where((since_s >= 0) & (since_s < SHAKE_S), np.sin(2 * np.pi * SHAKE_HZ * since_s), 0.0)
        along = strength[:, None] * SHAKEN_ALONG
        return replace(
            block, gyr_rad_s=block.gyr_rad_s + SHAKE_RAD_S * along, acc_m_s2=block.acc_m_s2 + SHAKE_M_S2 * along
        )


def moved(settings: WalkerSettings) -> Session:
    """What the demonstration's sensors send of a walker."""
    return labelled(simulate(settings).session)


def labelled(session: Session) -> Session:
    """The walker's session with the names that the demonstration's sensors have wherever they are shown."""
    recordings = tuple(replace(recording, imu=_renamed(recording.imu)) for recording in session.recordings)
    sensors = {site: replace(info, serial=DEMONSTRATION_NAMES[site]) for site, info in session.sensors.items()}
    return replace(session, recordings=recordings, sensors=sensors)


def names_of(session: Session) -> dict[Site, str]:
    """What each site's sensor is called while a session is played: each name once."""
    names: dict[Site, str] = {}
    for recording in session.recordings:
        for site, block in recording.imu.items():
            if site not in names:
                names[site] = f"{block.sensor} ({site})" if block.sensor in names.values() else block.sensor
    return names


def _renamed(imu: Mapping[Site, ImuBlock]) -> dict[Site, ImuBlock]:
    by_name = sorted(imu, key=lambda site: DEMONSTRATION_NAMES[site])
    return {site: replace(imu[site], sensor=DEMONSTRATION_NAMES[site]) for site in by_name}


def _longest(session: Session, site: Site) -> ImuBlock:
    return max((recording.imu[site] for recording in session.recordings if site in recording.imu), key=len)


def _details(info: SensorInfo, name: str, block: ImuBlock) -> SensorDetails:
    rate_hz = info.rate_hz or (float(1.0 / np.median(np.diff(block.time_s))) if len(block) > 1 else 1.0)
    return SensorDetails(info.model, info.serial or name, info.firmware, rate_hz, info.rate_kind)


def _faster(now_ns: Callable[[], int], speed: float) -> Callable[[], int]:
    begin_ns = now_ns()
    return lambda: begin_ns + round((now_ns() - begin_ns) * speed)


def _piece(clip: _Clip, name: str, from_s: float, to_s: float, lag_s: float) -> ImuBlock:
    """What a clip holds of from <= t < to, stamped with when it is sent."""
    block, moved_s = clip.imu[name], clip.start_s - clip.first_s
    before_s = min(to_s, clip.end_s - SEAM_S) - moved_s
    first, last = block.time_s.searchsorted((from_s - moved_s, before_s))
    return _rows(block, slice(int(first), int(last)), name, moved_s + lag_s)


def _rows(block: ImuBlock, rows: slice | BoolArray, name: str, moved_s: float) -> ImuBlock:
    part = block.select(rows)
    return replace(part, sensor=name, time_s=part.time_s + moved_s, unknown={})
