"""A patient who was recorded or simulated sends evenly, does what is asked, and fails on demand."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from core.samples import ImuBlock
from core.session import RecordingKind, Session
from devices.live import SourceLostError, SourceRefusedError
from devices.simulation.demonstration_patient import DemonstrationPatient
from devices.simulation.replay import (
    BUFFER_S,
    DEMONSTRATION_SESSION,
    SHAKE_RAD_S,
    ReplayFaults,
    ReplaySource,
)
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate

RATE_HZ = 100.0


class SteppedClock:
    def __init__(self) -> None:
        self.time_ns = 1_000_000_000_000

    def __call__(self) -> int:
        return self.time_ns

    def sleep(self, seconds: float) -> None:
        self.time_ns += round(seconds * 1e9)


@pytest.fixture(scope="module")
def session() -> Session:
    required = (Standing(), FreeMotion(duration_s=4.0), Walk("walk 1", strides=3), Walk("walk 2", 0.8, strides=3))
    return simulate(WalkerSettings(seed=1, tissue=Tissue.SOFT, recordings=required)).session


@pytest.fixture
def clock() -> SteppedClock:
    return SteppedClock()


Make = Callable[..., ReplaySource]


@pytest.fixture
def make(session: Session, clock: SteppedClock) -> Make:
    def make(faults: ReplayFaults = ReplayFaults(), **settings: float) -> ReplaySource:  # noqa: B008  # the default is frozen
        return ReplaySource(session, faults=faults, now_ns=clock, sleep=clock.sleep, **settings)  # type: ignore[arg-type]  # speed alone is given here

    return make


def listen(source: ReplaySource, clock: SteppedClock, seconds: float) -> dict[str, ImuBlock]:
    """All that comes within `seconds`, by sensor; without their orientation."""
    until_ns = clock.time_ns + round(seconds * 1e9)
    received: dict[str, list[ImuBlock]] = {name: [] for name in source.info.sensors}
    while clock.time_ns < until_ns:
        for block in source.read(lambda _: None):
            assert len(block) > 0
            assert block.time_s[-1] <= clock.time_ns / 1e9
            received[block.sensor].append(block)
    return {name: joined(blocks) for name, blocks in received.items() if blocks}


def joined(blocks: list[ImuBlock]) -> ImuBlock:
    return ImuBlock(
        sensor=blocks[0].sensor,
        time_s=np.concatenate([block.time_s for block in blocks]),
        gyr_rad_s=np.concatenate([block.gyr_rad_s for block in blocks]),
        acc_m_s2=np.concatenate([block.acc_m_s2 for block in blocks]),
    )


def is_even(block: ImuBlock) -> bool:
    return bool(np.allclose(np.diff(block.time_s), 1 / RATE_HZ, atol=1e-6))


def test_standing_is_played_over_and_over_without_a_seam_in_time(
    make: Make, clock: SteppedClock, session: Session
) -> None:
    source = make()
    source.open()
    received = listen(source, clock, 10.0)
    assert set(received) == set(source.info.sensors)
    standing = session.recordings[0].imu
    for (name, block), site in zip(received.items(), standing, strict=True):
        assert name == standing[site].sensor
        assert is_even(block)
        assert len(block) == pytest.approx(10.0 * RATE_HZ, abs=3)
        loop = len(standing[site])
        assert np.array_equal(block.gyr_rad_s[:loop], standing[site].gyr_rad_s)
        assert np.array_equal(block.acc_m_s2[loop : 2 * loop], standing[site].acc_m_s2)


def test_what_is_asked_is_done_at_once_and_then_the_patient_is(
    make: Make, clock: SteppedClock, session: Session
) -> None:
    source = make()
    source.open()
    name = source.info.sensors[0]
    listen(source, clock, 1.003)
    for kind, number in [
        (RecordingKind.WALKING, 2),
        (RecordingKind.WALKING, 3),
        (RecordingKind.WALKING, 2),
        (RecordingKind.FREE_MOTION, 1),
    ]:
        (played,) = (b for b in session.recordings[number].imu.values() if b.sensor == name)
        source.ask(kind)
        asked_s = clock.time_ns / 1e9
        received = listen(source, clock, len(played) / RATE_HZ + 1.0)[name]
        assert is_even(received)
        first = int(np.searchsorted(received.time_s, asked_s))
        assert first <= 2
        assert np.array_equal(received.gyr_rad_s[first : first + len(played)], played.gyr_rad_s)
        standing = next(b for b in session.recordings[0].imu.values() if b.sensor == name)
        after = received.gyr_rad_s[first + len(played) :]
        assert len(after) > 50
        assert np.array_equal(after, standing.gyr_rad_s[: len(after)])


def test_it_states_how_long_it_will_do_what_it_is_asked(make: Make, session: Session, clock: SteppedClock) -> None:
    source = make()
    assert source.ask(RecordingKind.WALKING) is None, "it is not open"
    source.open()
    walk = max(session.recordings[2].imu.values(), key=len)
    assert source.ask(RecordingKind.WALKING) == pytest.approx(len(walk) / RATE_HZ, abs=0.1)
    assert source.ask(None) is None
    walks_only = replace(session, recordings=session.recordings[2:3])
    source = ReplaySource(walks_only, now_ns=clock, sleep=clock.sleep)
    source.open()
    assert source.ask(RecordingKind.FREE_MOTION) == 0.0
    source = ReplaySource(session, finishes=True, now_ns=clock, sleep=clock.sleep)
    source.open()
    assert source.ask(RecordingKind.FREE_MOTION) is None, "over and over"


def test_asking_for_nothing_ends_a_walk(make: Make, clock: SteppedClock) -> None:
    source = make()
    source.open()
    source.ask(RecordingKind.WALKING)
    listen(source, clock, 2.0)
    source.ask(None)
    for block in listen(source, clock, 2.0).values():
        assert np.abs(block.gyr_rad_s[10:]).max() < 0.1
        assert is_even(block)


def test_who_finishes_walks_on_and_moves_freely_until_something_else_is_asked(
    session: Session, clock: SteppedClock
) -> None:
    source = ReplaySource(session, finishes=True, now_ns=clock, sleep=clock.sleep)
    source.open()
    name = source.info.sensors[0]
    free, walk, standing = (
        next(block.gyr_rad_s for block in session.recordings[k].imu.values() if block.sensor == name) for k in (1, 2, 0)
    )
    source.ask(RecordingKind.FREE_MOTION)
    received = listen(source, clock, 1.5 * len(free) / RATE_HZ)[name].gyr_rad_s
    assert np.array_equal(received[: len(free)], free)
    assert np.array_equal(received[len(free) :], free[: len(received) - len(free)])
    source.ask(RecordingKind.WALKING)
    rest = free[len(received) - len(free) :]
    received = listen(source, clock, (len(rest) + len(walk) + 100) / RATE_HZ)[name].gyr_rad_s
    played = np.concatenate([rest, walk, standing])
    assert np.array_equal(received, played[: len(received)])


def test_demonstration_patient_takes_the_same_pose_between_all_that_is_asked() -> None:
    few = replace(DEMONSTRATION_SESSION, recordings=(Standing(), FreeMotion(duration_s=6.0), Walk(strides=3)))
    source, truth = DemonstrationPatient(few), simulate(few).truth
    assert sorted(source.info.sensors) == list(source.info.sensors)
    assert {reported.serial for reported in source.details().values()} == set(source.info.sensors)
    for name, recording in truth.recordings.items():
        limit_deg = 6.0 if name.startswith("free motion") else 1.5  # a leg that hangs has its ankle at 0
        for joint in recording.joints.values():
            ends = np.array([joint.angle_rad[0], joint.angle_rad[-1]])
            np.testing.assert_allclose(ends, joint.standing_rad, atol=np.deg2rad(limit_deg))


def test_losses_a_lag_and_a_silence_are_as_reported(make: Make, clock: SteppedClock) -> None:
    names = make().info.sensors
    late, silent = names[1], names[2]
    source = make(ReplayFaults(loss_share=0.1, lag_s={late: 0.03}, silent_s={silent: (2.0, 5.0)}, seed=3))
    source.open()
    opened_ns = clock.time_ns
    opened_s = opened_ns / 1e9
    received = listen(source, clock, 20.0)
    whole = {name: len(block) / (20.0 * RATE_HZ) for name, block in received.items()}
    assert all(share == pytest.approx(0.9, abs=0.03) for name, share in whole.items() if name != silent)
    assert received[late].time_s[0] >= opened_s + 0.03
    since_s = received[silent].time_s - opened_s
    assert not np.any((since_s >= 2.0) & (since_s < 5.0))
    assert np.any(since_s < 2.0)
    assert np.any(since_s > 5.0)
    clock.time_ns = opened_ns
    again = make(ReplayFaults(loss_share=0.1, lag_s={late: 0.03}, silent_s={silent: (2.0, 5.0)}, seed=3))
    again.open()
    assert all(
        np.array_equal(block.time_s, received[name].time_s) for name, block in listen(again, clock, 20.0).items()
    )


def test_a_sensor_is_silenced_woken_and_shaken(make: Make, clock: SteppedClock) -> None:
    source = make()
    source.open()
    name, other = source.info.sensors[:2]
    source.silence(name)
    assert name not in listen(source, clock, 1.0)
    source.wake(name)
    assert name in listen(source, clock, 1.0)
    source.shake(name)
    received = listen(source, clock, 3.0)
    shaken = np.linalg.norm(received[name].gyr_rad_s, axis=1)
    assert shaken[:200].max() > 0.9 * SHAKE_RAD_S
    assert shaken[210:].max() < 0.1
    assert np.abs(received[other].gyr_rad_s).max() < 0.1


def test_a_source_that_vanishes_is_lost_and_does_not_open_until_it_is_back(make: Make, clock: SteppedClock) -> None:
    source = make()
    source.open()
    before = listen(source, clock, 1.0)
    source.vanish()
    with pytest.raises(SourceLostError):
        source.read(lambda _: None)
    source.close()
    with pytest.raises(SourceRefusedError, match="switched on"):
        source.open()
    clock.sleep(30.0)
    source.come_back()
    source.open()
    after = listen(source, clock, 1.0)
    for name, block in after.items():
        steps = (block.time_s[0] - before[name].time_s[-1]) * RATE_HZ
        assert steps > 2900
        assert steps == pytest.approx(round(steps), abs=1e-3)  # the sensors' clock ran on


def test_what_nobody_reads_for_long_is_lost_but_for_what_is_buffered(make: Make, clock: SteppedClock) -> None:
    source = make()
    source.open()
    listen(source, clock, 1.0)
    clock.sleep(0.8 * BUFFER_S)
    late = listen(source, clock, 0.1)
    assert all(is_even(block) and len(block) > 0.8 * BUFFER_S * RATE_HZ for block in late.values())
    clock.sleep(3600.0)  # the machine slept
    woken = listen(source, clock, 0.1)
    for name, block in woken.items():
        assert is_even(block)
        assert len(block) <= (BUFFER_S + 0.2) * RATE_HZ
        steps = (block.time_s[0] - late[name].time_s[-1]) * RATE_HZ
        assert steps == pytest.approx(round(steps), abs=1e-3)


def test_what_is_played_faster_is_buffered_for_as_long(make: Make, clock: SteppedClock) -> None:
    source = make(speed=20.0)
    source.open()
    clock.sleep(0.8 * BUFFER_S)
    received = [block for block in source.read(lambda _: None) if block.sensor == source.info.sensors[0]]
    assert sum(map(len, received)) > 20 * 0.8 * BUFFER_S * RATE_HZ


def test_time_runs_faster_where_it_is_asked_to(make: Make, clock: SteppedClock) -> None:
    source = make(speed=20.0)
    source.open()
    begin_ns = source.now_ns()
    clock.sleep(0.1)
    assert source.now_ns() - begin_ns == 2_000_000_000
    received = [block for _ in range(10) for block in source.read(lambda _: None)]
    assert sum(map(len, received)) / 6 == pytest.approx((0.1 + 10 * 0.015) * 20 * RATE_HZ, abs=5)


def test_the_demonstration_is_for_ten_seconds_and_moves_freely_for_six() -> None:
    kinds = (Standing, FreeMotion)
    lasts_s = [one.duration_s for one in DEMONSTRATION_SESSION.recordings if isinstance(one, kinds)]
    assert lasts_s == [10.0, *[6.0] * 6]
