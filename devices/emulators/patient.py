"""A patient who is not there wears emulated sensors, and does what is asked.

The motion is that of `simulation/walker.py`; each sensor measures it at the times of its own clock. The truth is
known.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from core.body import LEG_SITES, Joint, Site
from core.samples import G_M_S2, FloatArray, ImuBlock
from core.session import Recording, RecordingKind
from devices.clocks.host_clock import host_time_ns
from devices.drivers.shimmer3 import EMULATED as SHIMMER3
from devices.drivers.shimmer3 import calibrating
from devices.drivers.witmotion import EMULATED as WITMOTION
from devices.drivers.ximu3 import EMULATED as XIMU3
from devices.drivers.xsens_mti import EMULATED as XSENS_MTI
from devices.emulators.csv_lines import LineVoice
from devices.emulators.shimmer3 import ACC_CALIBRATION, GYR_CALIBRATION, Shimmer3Voice
from devices.emulators.transports import Voice
from devices.emulators.witmotion import WitVoice
from devices.emulators.ximu3 import Ximu3Voice
from devices.emulators.xsens_mti import MtiVoice
from devices.simulation.walker import FreeMotion, Motion, SimulatedSession, Standing, Walk, WalkerSettings, simulate

KINDS = ("ximu3", "witmotion", "csv", "xsens-mti", "shimmer3")
AVERAGING, AVERAGED_OVER = frozenset({"xsens-mti"}), 6  # sensors that report how far they turned since the last sample
CONSENSYS_TICKS_HZ = 32_000  # it calls 102.4 Hz what others call 100, and 204.8 what they call 200
FINE_HZ = 500.0  # of the table that sensors measure from: between its rows the motion is straight to a thousandth
MOST_DEG_S, MOST_G, MOST_RAW = 1999.0, 15.9, 32767
# each begins and ends with the patient's pose while standing, so that one goes on where the one before has ended
SESSION = WalkerSettings(
    seed=8,
    rate_hz=FINE_HZ,
    recordings=(
        Standing(duration_s=10.0),
        *(FreeMotion(name=f"free motion {number}", duration_s=6.0) for number in (1, 2, 3)),
        *(Walk(name=f"walk {number}", strides=14, standing_before_s=2.0) for number in (1, 2, 3)),
    ),
)
# a seventh sensor is worn on the pelvis: lunges, and walks there and back, show the hips
SESSION_WITH_PELVIS = replace(
    SESSION,
    sites=(*LEG_SITES, Site.PELVIS),
    recordings=(
        Standing(duration_s=10.0),
        FreeMotion(name="free motion 1", duration_s=6.8, motion=Motion.LUNGES),
        *(FreeMotion(name=f"free motion {number}", duration_s=6.0) for number in (2, 3)),
        *(Walk(name=f"walk {number}", strides=20, turn_rad=np.pi, standing_before_s=2.0) for number in (1, 2, 3)),
    ),
)


def session_for(sensors: int) -> WalkerSettings:
    """What a patient who wears so many sensors does."""
    return SESSION if sensors <= len(LEG_SITES) else SESSION_WITH_PELVIS


@dataclass(frozen=True, slots=True)
class Excerpt:
    """A recording that is performed: its time 0 is at `start_ns` of the host's clock."""

    recording: Recording
    start_ns: int
    end_ns: int


class EmulatedPatient:
    """Is standing, and performs the next recording of the kind that is asked for. One thread asks, any measure.

    Noise is added to each sample as a sensor of that rate has it; bias and scale are those of the walker.
    """

    def __init__(self, settings: WalkerSettings = SESSION, now_ns: Callable[[], int] = host_time_ns) -> None:
        self._errors, self._now_ns = settings.errors, now_ns
        self.sites = tuple(site for site in Site if site in settings.sites)
        quiet = replace(settings.errors, gyro_noise_rad_s=0.0, acc_noise_m_s2=0.0)
        self.simulated: SimulatedSession = simulate(replace(settings, errors=quiet))
        recordings = self.simulated.session.recordings
        self._tables = {
            (recording.name, site): _table(recording.imu[site]) for recording in recordings for site in recording.imu
        }
        self._waiting = list(recordings)
        self._standing = next(one for one in recordings if one.kind is RecordingKind.STANDING)
        self.clips = [self._clip(self._standing, now_ns())]

    def ask(self, kind: RecordingKind) -> Excerpt:
        """Perform the next recording of this kind, once the present one has ended; then stand."""
        required = next(one for one in self._waiting if one.kind is kind)
        self._waiting.remove(required)
        self._waiting.append(required)
        present = self.clips[-1]
        start_ns = self._now_ns()
        if present.recording.kind is not RecordingKind.STANDING:
            start_ns = max(start_ns, present.end_ns)
        self.clips = [*self.clips, self._clip(required, start_ns)]  # others are looking at the old ones
        return self.clips[-1]

    def measured(
        self, site: Site, at_ns: float, rate_hz: float, chance: np.random.Generator, is_averaged: bool = False
    ) -> FloatArray:
        """Rate in rad/s and force in m/s2 (6,) of a sample taken then; the rate of the whole interval, or of now."""
        value = self._at(site, at_ns)
        if is_averaged:
            steps_ns = np.linspace(0.0, 1e9 / rate_hz, AVERAGED_OVER + 1).tolist()
            rates = np.array([self._at(site, at_ns - step_ns)[:3] for step_ns in steps_ns])
            value = np.concatenate([(rates[1:] + rates[:-1]).mean(axis=0) / 2, value[3:]])
        density = np.repeat([self._errors.gyro_noise_rad_s, self._errors.acc_noise_m_s2], 3)
        noisy: FloatArray = value + density * np.sqrt(0.5 * rate_hz) * chance.normal(size=6)
        return noisy

    def angle_rad(self, joint: Joint, at_ns: float) -> float:
        """The truth: how far the joint is bent then, 0 in the anatomical neutral position."""
        recording, passed_ns = self._performed(at_ns)
        return float(_between(self.simulated.truth.recordings[recording.name].joints[joint].angle_rad, passed_ns))

    def _at(self, site: Site, at_ns: float) -> FloatArray:
        recording, passed_ns = self._performed(at_ns)
        return _between(self._tables[recording.name, site], passed_ns)

    def _performed(self, at_ns: float) -> tuple[Recording, float]:
        """Which recording is performed then, and for how long already; the standing over and over in between."""
        clip = next((one for one in reversed(self.clips) if one.start_ns <= at_ns), self.clips[0])
        if at_ns < clip.end_ns:
            return clip.recording, at_ns - clip.start_ns
        return self._standing, at_ns - clip.end_ns

    def _clip(self, recording: Recording, start_ns: int) -> Excerpt:
        length_s = min((len(block) - 1) / FINE_HZ for block in recording.imu.values())
        return Excerpt(recording, start_ns, start_ns + round(length_s * 1e9))


class EmulatedSensor:
    """One sensor that the patient wears.

    Parameters
    ----------
    rate_hz
        As its owner set it, until a driver sets it to another.
    states_so
        Answers whoever asks that it is emulated, so that what is recorded of it counts as simulated.

    Attributes
    ----------
    sent, sent_ns
        What it measured, sample by sample: rate in rad/s and force in m/s2 (6,); and when, by the host's clock.
    """

    def __init__(
        self, patient: EmulatedPatient, kind: str, number: int, rate_hz: int = 100, *, states_so: bool = True
    ) -> None:
        self.site = patient.sites[number % len(patient.sites)]
        self.sent: list[FloatArray] = []
        self.sent_ns: list[float] = []
        self._patient, self._kind, self._rate_hz = patient, kind, rate_hz
        self._chance = np.random.default_rng(number)
        self.voice: EmulatedVoice = self._voice(number, states_so)

    def _voice(self, number: int, states_so: bool) -> "EmulatedVoice":
        rate_hz = self._rate_hz
        match self._kind:
            case "ximu3":
                name = XIMU3 if states_so else "x-IMU3"
                return Ximu3Voice(f"EMU{number + 1:05d}", self._in_degrees, rate_hz=rate_hz, name=name)
            case "witmotion":
                return WitVoice(
                    f"{number + 1:04d}", self._in_degrees, rate_hz=rate_hz, name=WITMOTION if states_so else "WT"
                )
            case "csv":
                return LineVoice(self._in_degrees, rate_hz=rate_hz)
            case "xsens-mti":
                product = XSENS_MTI if states_so else "MTi-3"
                return MtiVoice(
                    f"028000{number + 1:02X}",
                    lambda at: self._measured(at).tolist(),
                    rate_hz=rate_hz,
                    has_orientation=False,
                    product=product,
                )
            case "shimmer3":
                period = CONSENSYS_TICKS_HZ // rate_hz
                name = f"{SHIMMER3 if states_so else 'Shimmer3'} {number + 1:04X}"
                return Shimmer3Voice(self._raw, period=period, name=name)
        raise ValueError(f"{self._kind} is none of {KINDS}")

    def _measured(self, number: int) -> FloatArray:
        at_ns = self.voice.sampled_ns(number)
        is_averaged = self._kind in AVERAGING
        row = self._patient.measured(self.site, at_ns, self.voice.rate_hz, self._chance, is_averaged)
        self.sent.append(row)
        self.sent_ns.append(at_ns)
        return row

    def _in_degrees(self, number: int) -> Sequence[float]:
        row = self._measured(number)
        rate = np.degrees(row[:3]).clip(-MOST_DEG_S, MOST_DEG_S)
        return [*rate.tolist(), *(row[3:] / G_M_S2).clip(-MOST_G, MOST_G).tolist()]

    def _raw(self, number: int) -> Sequence[int]:
        row = self._measured(number)
        parts = zip((row[:3], row[3:]), RAW, strict=True)
        raw = [matrix @ values + offset for values, (matrix, offset) in parts]
        whole: list[int] = np.concatenate(raw).round().clip(-MOST_RAW, MOST_RAW).astype(int).tolist()
        return whole


class EmulatedVoice(Voice, Protocol):
    """Knows when its samples are taken."""

    @property
    def rate_hz(self) -> float: ...

    def sampled_ns(self, number: int) -> float: ...


def _uncalibrating(block: bytes, scale: float) -> tuple[FloatArray, FloatArray]:
    """Matrix and offset that make raw numbers: the other way round than `calibrating`."""
    offset, matrix = calibrating(block, scale)
    return np.linalg.inv(matrix), offset


RAW = (_uncalibrating(GYR_CALIBRATION, 100.0 * np.pi / 180), _uncalibrating(ACC_CALIBRATION, 1.0))


def _between(table: FloatArray, passed_ns: float) -> FloatArray:
    """The value of a table (n, ...) at a moment; it begins again after its end."""
    at = passed_ns / 1e9 * FINE_HZ % (len(table) - 1)
    row = int(at)
    value: FloatArray = table[row] + (at - row) * (table[row + 1] - table[row])
    return value


def _table(block: ImuBlock) -> FloatArray:
    """Rate and force (n, 6), one row every `1 / FINE_HZ`; the walker loses none."""
    return np.hstack([block.gyr_rad_s, block.acc_m_s2])
