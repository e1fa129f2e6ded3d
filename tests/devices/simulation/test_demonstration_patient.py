"""The demonstration's patient performs every timed test that is asked for, and breaks off what nobody waits for."""

import threading

import numpy as np
import pytest

from core.body import Site
from core.samples import FloatArray, ImuBlock
from core.session import RecordingKind
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.demonstration_patient import DemonstrationPatient
from devices.simulation.replay import DEMONSTRATION_NAMES, PATIENCE_S
from devices.simulation.walker import FreeMotion, Standing, Tissue, WalkerSettings

RATE_HZ = 100.0
SEATED_DEG, STANDING_DEG = 60.0, 25.0
SITES = (Site.LEFT_THIGH, Site.LEFT_FOOT)
LEFT_THIGH, LEFT_FOOT = (DEMONSTRATION_NAMES[site] for site in SITES)
EACH_NS = 100_000_000  # passes between two reads: fewer of them, as many samples


class ReadClock:
    def __init__(self) -> None:
        self.time_ns = 1_000_000_000_000

    def __call__(self) -> int:
        return self.time_ns


class Watched(DemonstrationPatient):
    """A patient on a clock that goes on with each read, and whose walks are made before anybody goes on."""

    def __init__(self) -> None:
        self.clock = ReadClock()
        few = (Standing(duration_s=4.0), FreeMotion(duration_s=6.0))
        super().__init__(WalkerSettings(seed=1, tissue=Tissue.SOFT, recordings=few, sites=SITES), now_ns=self.clock)
        self._sleep = self._pass_by
        self.open()

    def perform(self, planned: PlannedTest) -> None:
        super().perform(planned)
        for thread in [one for one in threading.enumerate() if one.name == "simulated walk"]:
            thread.join()

    def received(self, seconds: float) -> dict[str, ImuBlock]:
        """All that is sent within so many seconds, by sensor."""
        until_ns, blocks = self.clock.time_ns + round(seconds * 1e9), dict[str, list[ImuBlock]]()
        while self.clock.time_ns < until_ns:
            for block in self.read(lambda *_: None):
                blocks.setdefault(block.sensor, []).append(block)
        return {name: _whole(name, parts) for name, parts in blocks.items()}

    def _pass_by(self, seconds: float) -> None:
        self.clock.time_ns += max(EACH_NS, round(seconds * 1e9))


def _whole(name: str, parts: list[ImuBlock]) -> ImuBlock:
    time_s, gyr_rad_s, acc_m_s2 = (
        np.concatenate([getattr(part, column) for part in parts]) for column in ("time_s", "gyr_rad_s", "acc_m_s2")
    )
    return ImuBlock(name, time_s, gyr_rad_s, acc_m_s2)


def tilt_deg(thigh: ImuBlock, upright: FloatArray) -> FloatArray:
    """How far a thigh is tilted from standing, by the mean of its acceleration over half a second."""
    width = round(0.5 * RATE_HZ)
    up = np.stack([np.convolve(axis, np.ones(width) / width, mode="same") for axis in thigh.acc_m_s2.T], axis=-1)
    return np.rad2deg(np.arccos(np.clip(up @ upright / np.linalg.norm(up, axis=1), -1.0, 1.0)))


def rises(tilt: FloatArray) -> int:
    """How often the thigh came from the seat to standing."""
    states = np.where(tilt > SEATED_DEG, 1, np.where(tilt < STANDING_DEG, 0, -1))
    known = states[states >= 0]
    return int(np.sum(np.diff(known) < 0))


def swings(foot: ImuBlock) -> int:
    """How often a foot swung: it turns fastest as it leaves the floor."""
    fast = np.linalg.norm(foot.gyr_rad_s, axis=1) > 3.0
    begins = np.flatnonzero(np.diff(fast.astype(int)) > 0)
    return int(np.sum(np.diff(begins, prepend=-1000) > 0.5 * RATE_HZ))


@pytest.fixture
def patient() -> Watched:
    return Watched()


@pytest.fixture
def upright(patient: Watched) -> FloatArray:
    mean = patient.received(2.0)[LEFT_THIGH].acc_m_s2.mean(axis=0)
    return np.asarray(mean / np.linalg.norm(mean))


@pytest.mark.parametrize(
    ("protocol", "lasts_s", "risen", "least_swings"),
    [
        (TimedProtocol.TEN_METRES, 25.0, 0, 6),
        (TimedProtocol.UP_AND_GO, 40.0, 2, 6),  # rises for the test, and at last to stand again
        (TimedProtocol.SIT_TO_STAND, 30.0, 5, 0),
        (TimedProtocol.STAIRS, 60.0, 0, 20),
    ],
)
def test_every_test_is_performed_from_standing_to_standing(
    patient: Watched, upright: FloatArray, protocol: TimedProtocol, lasts_s: float, risen: int, least_swings: int
) -> None:
    assert_performed(patient, upright, protocol, lasts_s, risen, least_swings)


def assert_performed(
    patient: Watched, upright: FloatArray, protocol: TimedProtocol, lasts_s: float, risen: int, least_swings: int
) -> None:
    patient.perform(PlannedTest(protocol))
    received = patient.received(lasts_s)
    tilt = tilt_deg(received[LEFT_THIGH], upright)
    assert rises(tilt[: round((lasts_s - 1.0) * RATE_HZ)]) == risen
    assert tilt[round(0.5 * RATE_HZ)] < STANDING_DEG
    assert swings(received[LEFT_FOOT]) >= least_swings
    step_s = np.diff(received[LEFT_FOOT].time_s)
    assert np.allclose(step_s, 1.0 / RATE_HZ, atol=2e-3), "the sensors go on evenly from standing to test and back"


def test_the_walk_between_two_tapes_is_as_long_as_the_course_that_was_entered(patient: Watched) -> None:
    walked_m = []
    for course_m in (4.0, None, 20.0):
        patient.perform(PlannedTest(TimedProtocol.TEN_METRES, course_m=course_m))
        foot = patient.received(40.0)[LEFT_FOOT]
        moving_s = foot.time_s[np.linalg.norm(foot.gyr_rad_s, axis=1) > 3.0]
        walked_m.append(patient.course_speed_m_s * np.ptp(moving_s))
    np.testing.assert_allclose(walked_m, [9.0, 15.0, 25.0], atol=2.0)


def test_attempts_differ(patient: Watched) -> None:
    found = []
    for _ in range(2):
        patient.perform(PlannedTest(TimedProtocol.SIT_TO_STAND))
        found.append(patient.received(25.0)[LEFT_THIGH].gyr_rad_s[:2000])
        patient.received(15.0)
    assert not np.allclose(found[0], found[1], atol=0.5)


def test_a_long_walk_is_broken_off_and_a_short_one_is_finished(patient: Watched, upright: FloatArray) -> None:
    assert_performed(patient, upright, TimedProtocol.TWO_MINUTES, 60.0, 0, 25)
    patient.ask(None)
    assert swings(patient.received(PATIENCE_S)[LEFT_FOOT]) == 0
    patient.perform(PlannedTest(TimedProtocol.TEN_METRES))
    patient.received(6.0)
    patient.ask(None)
    assert swings(patient.received(10.0)[LEFT_FOOT]) > 3


def test_who_was_asked_for_something_else_meanwhile_performs_no_test(patient: Watched) -> None:
    DemonstrationPatient.perform(patient, PlannedTest(TimedProtocol.STAIRS))
    patient.ask(None)
    for thread in [one for one in threading.enumerate() if one.name == "simulated walk"]:
        thread.join()
    assert swings(patient.received(10.0)[LEFT_FOOT]) == 0
    patient.ask(RecordingKind.FREE_MOTION)
    assert swings(patient.received(6.0)[LEFT_FOOT]) > 0, "and then does what is asked"
