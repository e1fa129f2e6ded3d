"""Cost of the live estimator, and whether it stays as small as it began.

    python -m tests.benchmarks.live_speed                      CPU beside VQF, on the same stream
    python -m tests.benchmarks.live_speed --hours 8            memory, fed as fast as it goes
    python -m tests.benchmarks.live_speed --seven              CPU with a sensor on the pelvis over CPU without it

Six sensors at 200 Hz, four joints, both feet, in blocks of 33 ms: the walking estimator with angles, certainty, phases
and straps, and the free motion with excitation and lags. VQF (doi 10.1016/j.inffus.2022.10.014) is fed the same blocks,
one filter per sensor, which the estimator needs anyway. The two take turns, minute by minute.
"""

import resource
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from vqf import VQF

from core.analysis import analyse
from core.body import LEG_SITES, Side, Site
from core.calibration.rest import rest_of
from core.live.free_motion import LiveFreeMotion
from core.live.sensors import LiveSensor
from core.live.walking import LiveWalk
from core.samples import ImuBlock
from core.session import Session
from devices.simulation.walker import FreeMotion as FreeMotionRecording
from devices.simulation.walker import Standing, Tissue, Walk, WalkerSettings, simulate
from tests.core.cut_blocks import part_of
from tests.driver import options

RATE_HZ = 200.0
BLOCK_S = 0.033
MINUTE_S = 60.0
WARM_MINUTES = 3  # until what is computed once, and caches, is behind

Blocks = list[dict[Site, ImuBlock]]


def make_session(seed: int = 0) -> Session:
    """Standing, a minute of free motion, a minute of walking with soft tissue."""
    recordings = (Standing(), FreeMotionRecording(duration_s=MINUTE_S), Walk("walk 1", strides=54))
    settings = WalkerSettings(seed=seed, recordings=recordings, tissue=Tissue.SOFT, rate_hz=RATE_HZ)
    return simulate(settings).session


def sensors_of(session: Session) -> dict[Site, LiveSensor]:
    found = {}
    for site, block in session.recordings[0].imu.items():
        rest = rest_of(block)
        assert rest is not None, site
        found[site] = LiveSensor(RATE_HZ, rest.gyr_rad_s)
    return found


def in_blocks(imu: Mapping[Site, ImuBlock], block_s: float = BLOCK_S) -> Blocks:
    end_s = max(float(block.time_s[-1]) for block in imu.values())
    edges = np.arange(0.0, end_s + block_s, block_s)
    return [{site: part_of(block, a, b) for site, block in imu.items()} for a, b in pairwise(edges)]


def later(blocks: Blocks, by_s: float) -> Iterator[dict[Site, ImuBlock]]:
    for block in blocks:
        yield {site: replace(samples, time_s=samples.time_s + by_s) for site, samples in block.items()}


def costs_s(update: Callable[[Mapping[Site, ImuBlock]], object], blocks: Iterator[dict[Site, ImuBlock]]) -> list[float]:
    """CPU seconds of each block."""
    spent = []
    for block in blocks:
        start_s = time.process_time()
        update(block)
        spent.append(time.process_time() - start_s)
    return spent


def compare(minutes: int) -> None:
    session = make_session()
    sensors, calibration = sensors_of(session), analyse(session).calibrations[-1].joints
    stages = {
        "walking": (LiveWalk(sensors, calibration).update, in_blocks(session.recordings[2].imu)),
        "free motion": (LiveFreeMotion(sensors).update, in_blocks(session.recordings[1].imu)),
    }
    print("| stage | of one core, % | p50, p99, worst block, ms | of six VQF |")
    print("|---|---|---|---|")
    for name, (update, blocks) in stages.items():
        filters = {site: VQF(1 / RATE_HZ) for site in sensors}

        def filtered(block: Mapping[Site, ImuBlock], filters: dict[Site, VQF] = filters) -> None:
            for site, samples in block.items():
                if len(samples):
                    gyr, acc = (np.ascontiguousarray(v) for v in (samples.gyr_rad_s, samples.acc_m_s2))
                    filters[site].updateBatch(gyr, acc)

        length_s = len(blocks) * BLOCK_S
        ours: list[float] = []
        theirs: list[float] = []
        ratios = []
        for minute in range(minutes):
            mine = costs_s(update, later(blocks, minute * length_s))
            peer = costs_s(filtered, later(blocks, minute * length_s))
            ours, theirs = ours + mine, theirs + peer
            ratios.append(sum(mine) / sum(peer))
        share = 100 * sum(ours) / (minutes * length_s)
        p50, p99, worst = (1000 * np.quantile(ours, q) for q in (0.5, 0.99, 1.0))
        print(f"| {name} | {share:.1f} | {p50:.2f}, {p99:.2f}, {worst:.1f} | {np.median(ratios):.1f} |")


def compare_seven(minutes: int) -> None:
    """The same walk and free motion with and without the pelvis, minute by minute in turn, after three of each."""
    recordings = (Standing(), Walk("walk 1", strides=54, turn_rad=np.pi), FreeMotionRecording(duration_s=MINUTE_S))
    made = WalkerSettings(seed=0, sites=tuple(Site), recordings=recordings, tissue=Tissue.SOFT, rate_hz=RATE_HZ)
    session = simulate(made).session
    analysis, sensors = analyse(session), sensors_of(session)
    hips = {joint: hip.identification for joint, hip in analysis.recordings[0].hips.items()}
    assert len(hips) == len(Side)
    legs: dict[Site, LiveSensor] = {site: sensors[site] for site in LEG_SITES}
    calibration = analysis.calibrations[-1].joints
    print("| stage | of one core, %, six and seven sensors | seven over six: median, least, most of the minutes |")
    print("|---|---|---|")
    stages = (
        ("walking", LiveWalk(legs, calibration), LiveWalk(sensors, calibration, hips), 1),
        ("free motion", LiveFreeMotion(legs), LiveFreeMotion(sensors), 2),
    )
    for name, six, seven, recording in stages:
        blocks = in_blocks(session.recordings[recording].imu)
        of_legs: Blocks = [{site: one for site, one in block.items() if site in LEG_SITES} for block in blocks]
        length_s = len(blocks) * BLOCK_S
        spent = []
        for minute in range(minutes + WARM_MINUTES):
            of_six = sum(costs_s(six.update, later(of_legs, minute * length_s)))
            of_seven = sum(costs_s(seven.update, later(blocks, minute * length_s)))
            spent.append((of_six, of_seven))
        spent = spent[WARM_MINUTES:]
        shares = [100 * sum(one) / (minutes * length_s) for one in zip(*spent, strict=True)]
        ratios = [of_seven / of_six for of_six, of_seven in spent]
        reported = f"{np.median(ratios):.2f}, {min(ratios):.2f}, {max(ratios):.2f}"
        print(f"| {name} | {shares[0]:.1f}, {shares[1]:.1f} | {reported} |")


def memory_kib() -> int:
    """What the process holds now."""
    with Path("/proc/self/statm").open() as file:
        return int(file.read().split()[1]) * resource.getpagesize() // 1024


def long_stream(hours: float) -> Iterator[tuple[float, int]]:
    """Hours of walking as fast as it goes: stream time (h) and memory held (KiB), about twenty times on the way."""
    session = make_session()
    walking = LiveWalk(sensors_of(session), analyse(session).calibrations[-1].joints)
    blocks = in_blocks(session.recordings[2].imu)
    length_s = len(blocks) * BLOCK_S
    rounds = max(2, round(hours * 3600 / length_s))
    for k in range(rounds):
        for block in later(blocks, k * length_s):
            walking.update(block)
        if k == 0 or k % max(1, rounds // 20) == 0 or k == rounds - 1:
            yield (k + 1) * length_s / 3600, memory_kib()


def main() -> None:
    asked = options(
        __doc__,
        minutes=(3, "of each stage"),
        hours={"type": float, "help": "of one stream, instead"},
        seven=(False, "with a sensor on the pelvis, instead"),
    )
    if asked.seven:
        compare_seven(asked.minutes)
        return
    if asked.hours is None:
        compare(asked.minutes)
        return
    for hour, kib in long_stream(asked.hours):
        print(f"{hour:6.2f} h  {kib / 1024:8.1f} MiB", flush=True)


if __name__ == "__main__":
    main()
