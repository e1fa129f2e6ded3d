"""Emulated DOTs with every fault at once. Check for samples lost without a report, dead ends and anything erased.

    python -m tests.safety.dot_faults --runs 500 [--bumble]

Each run synchronises two to six sensors, streams from them for some seconds, lets them record in their memory, fetches
and erases, while links are lost at any operation, notifications are lost, doubled, cut and damaged, sensors are busy,
full, switched off, out of reach, or only say that they are synchronised. Seconds pass at once (`VirtualRadio`), and who
waits for what never comes is an error. What a sensor took and recorded, and when, is given by itself, float for float.
With `--bumble` the links go through Bumble's virtual radio, which has advertisements, ATT and subscriptions of its own.
"""

import argparse
import random
import traceback
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from app.acquisition.memory_fetching import MemoryFetching
from app.acquisition.sensor_memory import MemoryRecording
from app.storage.journal.decoding import decode
from app.storage.journal.writer import JournalWriter
from core.samples import ImuBlock
from devices.decoders import DECODERS
from devices.dot.memory import MemoryFullError
from devices.dot.sensor import DotRefusedError
from devices.emulators.dot import EmulatedDot
from devices.emulators.dot_faults import DotFaults
from devices.live import SourceLostError, SourceRefusedError
from devices.source import DecodedSensor
from tests.devices.dot.virtual_time import VirtualRadio
from tests.devices.dot.worn_dots import RAD, Through, WornDots, behind_bleak, not_there
from tests.driver import Found, drive
from tests.safety.journal_material import ID, KEY, NO_ROOM_ASKED

TRIES = 12  # of a user who does what is stated
LIVE_S, RECORDED_S = 6.0, 5.0
STAMPED_MS = 50.0  # the least latency of a link, which nobody can see, and what its clock is off by
SHARED_MS = 2.0
ORDERED_S = 1.0  # how long an order may take, and what is known of when it was done
UTC_S = 1_700_000_000


def some_faults(rng: random.Random) -> DotFaults:
    """Of one sensor; half of what may go wrong does not."""

    def perhaps(value: float) -> float:
        return value if rng.random() < 0.5 else 0.0

    return DotFaults(
        loss=perhaps(rng.uniform(0.0, 0.08)),
        doubles=perhaps(0.03),
        cut=perhaps(0.01),
        damaged=perhaps(rng.uniform(0.0, 0.02)),
        silent=perhaps(rng.uniform(0.0, 0.02)),
        sync_results=[rng.choice([0, 5, 7, 8, 9]) for _ in range(rng.randrange(3))] if rng.random() < 0.2 else [],
        stale_s=rng.choice([-2.0, 0.5, 30.0]) if rng.random() < 0.03 else 0.0,
        has_26=rng.random() < 0.8,
        again=rng.random() < 0.6,
        busy=rng.choice([0, 0, 1, 3]),
        stale_answers=rng.choice([0, 0, 1, 4]),
        ends_after_s=perhaps(rng.uniform(0.0, 8.0)),
        full_by_notice=rng.random() < 0.5,
        echoes=rng.random() < 0.5,
        drops_after=[rng.randrange(1, 60) for _ in range(rng.randrange(4))],
        drops_export_after=[rng.randrange(1, 700) for _ in range(rng.randrange(4))],
    )


def run_often(runs: int, seed: int, folder: Path, through: Through = behind_bleak) -> Found:
    """So many runs, each reported by its number."""
    every = Found(Counter(runs=runs))
    for number in range(runs):
        rng, radio = random.Random(seed + number), VirtualRadio()
        try:
            place = folder / str(number)
            place.mkdir()
            every.faults += [f"run {seed + number}: {fault}" for fault in _run(rng, radio, place, every.count, through)]
        except Exception:  # what nobody was given to expect is a fault of this run
            every.faults.append(f"run {seed + number}: {traceback.format_exc()}")
        finally:
            radio.close()
    return every


def _run(rng: random.Random, radio: VirtualRadio, folder: Path, seen: Counter[str], through: Through) -> list[str]:
    wearing = WornDots(radio, [some_faults(rng) for _ in range(rng.randrange(2, 7))], through=through)
    if not _opened(wearing, seen):
        return ["dead end: never opened"]
    faults = _live(rng, wearing, seen)
    for source in wearing.sources:
        source.close()
    return faults + _memory(rng, wearing, folder, seen)


def _opened(wearing: WornDots, seen: Counter[str]) -> bool:
    for attempt in range(TRIES):
        try:
            wearing.open()
        except (SourceRefusedError, SourceLostError):
            seen["openings refused"] += 1
            for source in wearing.sources:
                source.close()
            if attempt == TRIES // 2:  # switched off and on, as the refusal states
                for dot in wearing.dots:
                    wearing.air.drop(dot)
                    dot.restart()
                    dot.faults.stale_s = 0.0
            continue
        seen["sensors synchronised"] += sum(bool(wearing.group.clock_of(one.name)) for one in wearing.group.sensors)
        return True
    return False


def _live(rng: random.Random, wearing: WornDots, seen: Counter[str]) -> list[str]:
    """Stream while links are lost; hold what was decoded against what was taken."""
    restarted = set()
    for _ in range(3):
        wearing.measure(LIVE_S / 3)
        number = rng.randrange(len(wearing.dots))
        dot = wearing.dots[number]
        match rng.choice(["nothing", "drop", "away", "off"]):
            case "drop":
                wearing.air.drop(dot)
            case "away":
                dot.stay_away(rng.uniform(0.1, 4.0))
                wearing.air.drop(dot)
            case "off":
                wearing.air.drop(dot)
                dot.restart()
                restarted.add(number)
    wearing.measure(6.0)
    faults = [] if all(wearing.is_open) else ["dead end: a source never came back"]
    for number, one in enumerate(wearing.decoded()):
        held = _held_live(wearing, number, one, number in restarted, seen)
        faults += [f"sensor {number}: {fault}" for fault in held]
    return faults


def _held_live(
    wearing: WornDots, number: int, one: DecodedSensor, was_restarted: bool, seen: Counter[str]
) -> list[str]:
    found = _taken_rows(wearing.dots[number], one.block)
    seen["samples streamed"] += len(one.block)
    seen["samples lost live, and told"] += one.counts.lost
    rows = [row for row in found if row is not None]
    if len(set(rows)) != len(found):
        return ["a sample that was never taken, or twice"]
    faults, lacking = [], not_there(rows)
    is_reported = one.counts.lost >= lacking if was_restarted else one.counts.lost == lacking
    if not is_reported:
        faults.append(f"{lacking} samples lost, {one.counts.lost} told")
    off_ms = 1e3 * float(np.abs(one.block.time_s - wearing.truth(number)[1][rows]).max())
    seen["ms is the furthest stamp off"] = max(seen["ms is the furthest stamp off"], round(off_ms))
    if off_ms > STAMPED_MS:
        faults.append(f"a stamp is {off_ms:.0f} ms off")
    return faults


def _taken_rows(dot: EmulatedDot, block: ImuBlock) -> list[int | None]:
    taken = {np.array([*_rates(one[1]), *one[1][4:7]]).tobytes(): row for row, one in enumerate(dot.sent)}
    return [taken.get(row.tobytes()) for row in np.hstack([block.gyr_rad_s, block.acc_m_s2])]


def _rates(values: tuple[float, ...]) -> list[float]:
    return [value * RAD for value in values[7:]]


def _memory(rng: random.Random, wearing: WornDots, folder: Path, seen: Counter[str]) -> list[str]:
    """Record, fetch, look into the journal, erase; as often as it takes."""
    memory, radio = MemoryRecording(wearing.group), wearing.radio
    for dot in wearing.dots:
        dot.memory.room = rng.choice([10**6, 10**6, 10**6, 400, 0])
    if not _made_ready(wearing, seen):
        return ["dead end: never made ready to record"]
    if rng.random() < 0.1:
        off = rng.choice(wearing.dots)
        wearing.air.drop(off)
        off.restart()
    if not _begun(memory, wearing, seen):
        return ["dead end: never recorded"]
    radio.pass_s(RECORDED_S)
    for dot in wearing.dots:
        if rng.random() < 0.1:
            wearing.air.drop(dot)
            dot.restart()
        if rng.random() < 0.02:
            dot.memory.unreadable = {rng.randrange(500)}
    if not any(not memory.end() for _ in range(TRIES)):
        return ["dead end: a recording goes on"]
    writer = JournalWriter.create(folder, ID, KEY, room=NO_ROOM_ASKED, now_ns=radio.now_ns)
    fetching = memory.fetching
    assert fetching is not None  # all have ended
    failed: Mapping[str, Exception] = {}
    for _ in range(TRIES):
        failed = _fetched(rng, fetching, writer, seen)
        seen["fetches refused"] += len(failed)
        if not failed and fetching.is_done:
            break
    opened_s, path = writer.header.opened_ns / 1e9, writer.stop().path
    kept = fetching.look_into((path,), KEY)
    faults = [f"dead end: {name} was never fetched: {problem}" for name, problem in failed.items()]
    sensors = decode((path,), KEY, DECODERS).sensors
    blocks = {name: one.block for name, one in sensors.items()}
    faults += [fault for dot in wearing.dots for fault in _held_against(dot, fetching, blocks, seen)]
    faults += _stamped(wearing, sensors, opened_s, seen)
    return faults + _erased(rng, wearing, memory, kept, blocks, seen)


class LeftOffError(Exception):
    """The user wants to go on with the fetching later."""


def _fetched(
    rng: random.Random, fetching: MemoryFetching, writer: JournalWriter, seen: Counter[str]
) -> Mapping[str, Exception]:
    left = rng.choice([0, 0, 0, rng.randrange(1, 3000)])

    def progress(_sensor: str, _done: int, _of: int) -> None:
        nonlocal left
        left -= 1
        if left == 0:
            raise LeftOffError

    try:
        return fetching.fetch(writer, progress)
    except LeftOffError:
        seen["fetches left off, and gone on with"] += 1
        return {}


def _made_ready(wearing: WornDots, seen: Counter[str]) -> bool:
    for attempt in range(TRIES):
        try:
            wearing.group.make_ready_to_record()
        except (SourceRefusedError, SourceLostError):
            seen["readiness refused"] += 1
            if attempt == TRIES // 2:
                for dot in wearing.dots:
                    wearing.air.drop(dot)
                    dot.restart()
                    dot.faults.stale_s = 0.0
            continue
        return True
    return False


def _stamped(wearing: WornDots, sensors: Mapping[str, DecodedSensor], opened_s: float, seen: Counter[str]) -> list[str]:
    """Hold the stamps of what was fetched against when it was taken: of one clock to 2 ms, of any to its orders."""
    off_s: dict[str, float] = {}
    for dot, sensor in zip(wearing.dots, wearing.group.sensors, strict=True):
        one = sensors.get(sensor.name)
        if one is None or not len(one.block):
            continue
        values = {row.tobytes(): at for at, row in enumerate(np.array(_values(dot)))}
        first = values[np.hstack([one.block.gyr_rad_s[0], one.block.acc_m_s2[0]]).tobytes()]
        taken_s = _taken_s(dot)[first] - opened_s
        off_s[sensor.name] = float(one.block.time_s[0]) - taken_s
    shared = [value for name, value in off_s.items() if sensors[name].clock is not None]
    seen["files stamped by a common clock"] += len(shared)
    apart_ms = 1e3 * (max(shared, default=0.0) - min(shared, default=0.0))
    seen["ms apart are fetched stamps of one clock at most"] = max(
        seen["ms apart are fetched stamps of one clock at most"], round(apart_ms)
    )
    faults = [f"fetched stamps of one clock are {apart_ms:.1f} ms apart"] if apart_ms > SHARED_MS else []
    furthest_s = max(map(abs, off_s.values()), default=0.0)
    return faults + ([f"a fetched stamp is {furthest_s:.2f} s off"] if furthest_s > ORDERED_S else [])


def _taken_s(dot: EmulatedDot) -> list[float]:
    return [one_s for file in dot.memory.files for one_s in file.taken_s]


def _values(dot: EmulatedDot) -> list[list[float]]:
    return [[*_rates(tuple(one)), *one[4:7]] for file in dot.memory.files for one in file.values]


def _begun(memory: MemoryRecording, wearing: WornDots, seen: Counter[str]) -> bool:
    for attempt in range(TRIES):
        try:
            memory.begin(UTC_S + attempt)
        except (SourceRefusedError, SourceLostError) as refused:
            seen["recordings refused"] += 1
            if isinstance(refused, MemoryFullError):
                for dot in wearing.dots:
                    dot.memory.room = 10**6  # fetched and erased, as the refusal states
            elif "clock" in str(refused):
                seen["synchronised again, for one was switched off"] += 1
                _made_ready(wearing, seen)
        else:
            return True
    return False


def _held_against(
    dot: EmulatedDot, fetching: MemoryFetching, blocks: Mapping[str, ImuBlock], seen: Counter[str]
) -> list[str]:
    name = f"DOT {dot.mac[4]:02X}{dot.mac[5]:02X}"
    result = fetching.results.get(name)
    if result is None:
        return []
    file = next(one for one in dot.memory.files if one.utc_s == result.file.started_utc_s)
    faults = [f"{name}: its file was cut by what was written to it"] if dot.memory.cut_recordings else []
    count, block = len(file.ticks), blocks.get(name)
    seen["files fetched"] += 1
    seen["files complete"] += result.is_complete
    seen["samples fetched"] += result.samples
    seen["samples that could not be had, and told"] += result.lost
    if result.is_complete and result.samples != count:
        faults.append(f"{name}: called complete with {result.samples} of {count} samples")
    if result.is_end_known and result.samples + result.lost != count:
        faults.append(f"{name}: {count - result.samples - result.lost} samples lost untold")
    gone = {number for gap in result.missing for number in gap}
    there = [number for number in range(result.samples + result.lost) if number not in gone]
    values = np.array(file.values).reshape(-1, 10)[there]
    if block is None or not np.array_equal(block.gyr_rad_s, values[:, 7:] * RAD):
        faults.append(f"{name}: the journal holds other rates than were recorded")
    elif not np.array_equal(block.acc_m_s2, values[:, 4:7]):
        faults.append(f"{name}: the journal holds other forces than were recorded")
    return faults


def _erased(
    rng: random.Random,
    wearing: WornDots,
    memory: MemoryRecording,
    kept: Mapping[str, bool],
    blocks: Mapping[str, ImuBlock],
    seen: Counter[str],
) -> list[str]:
    faults, fetching = [], memory.fetching
    assert fetching is not None  # as above
    for dot, sensor in zip(wearing.dots, wearing.group.sensors, strict=True):
        name, before = sensor.name, len(dot.memory.files)
        is_confirmed = rng.random() < 0.8
        for _ in range(3):
            try:
                fetching.erase(name, UTC_S + 100, is_confirmed=is_confirmed, others=sorted(memory.given_up))
                break
            except DotRefusedError:
                seen["erasures refused"] += 1
            except SourceLostError:
                continue
        if not dot.memory.erased:
            continue
        seen["memories erased"] += 1
        begun_s = fetching.results[name].file.started_utc_s
        samples = sum(len(file.ticks) for file in dot.memory.erased if file.utc_s >= begun_s)
        if not is_confirmed or not kept[name] or len(blocks[name]) != samples:
            faults.append(f"{name}: {samples} samples of {before} files erased, {len(blocks[name])} kept")
    return faults


def run(asked: argparse.Namespace, folder: Path) -> Found:
    through: Through = behind_bleak
    if asked.bumble:
        from tests.devices.dot.by_bumble import by_bumble

        through = by_bumble
    return run_often(asked.runs, asked.seed, folder, through)


if __name__ == "__main__":
    drive(
        __doc__,
        run,
        runs=500,
        seed=0,
        bumble=(False, "through Bumble's virtual radio"),
    )
