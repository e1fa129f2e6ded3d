"""Stamps of sensors that share one clock: one line to the host's clock for all of them.

How late a sensor's samples arrive at the least is its own link's affair and cannot be seen. Where sensors are stamped
one by one they lie apart by what their links differ; by one line they lie as their common clock shows.

What was fetched from memories has no arrivals. When each was asked to begin and to end bounds by how much the host's
clock is ahead of theirs; all of them together bound it best.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from core.samples import FloatArray
from devices.clocks.clock import fit_clock
from devices.source import DecodedSensor, SharedClock

APART_S = 0.1  # links do not differ by more: a sensor further off does not run by the clock that it names

Named = tuple[str, DecodedSensor]


def tied(found: Sequence[Named]) -> list[Named]:
    """Stamp sensors that share a clock by one line; all others stay as they are, also one that only claims to."""
    every = list(found)
    for is_fetched, together_by in ((False, _stamped), (True, _bounded)):
        for places in _together(found, is_fetched):
            stamped = together_by([found[place][1] for place in places])
            for place, one in zip(places, stamped, strict=True):
                every[place] = found[place][0], one
    return every


def _together(found: Sequence[Named], is_fetched: bool) -> list[list[int]]:
    """Which of them name the same clock, streamed or fetched."""
    places: dict[str, list[int]] = {}
    for place, (_, one) in enumerate(found):
        if one.clock is not None and len(one.block) and (one.clock.ahead_s is not None) is is_fetched:
            places.setdefault(one.clock.name, []).append(place)
    return list(places.values())


def _stamped(sensors: Sequence[DecodedSensor]) -> list[DecodedSensor]:
    """Those that say they share one clock, each with samples."""
    device_s = _on_one_turn(sensors)
    offsets_s = [float(np.median(one.block.time_s - at_s)) for one, at_s in zip(sensors, device_s, strict=True)]
    middle_s = float(np.median(offsets_s))
    is_near = [abs(offset_s - middle_s) < APART_S for offset_s in offsets_s]
    if sum(is_near) < 2:
        return [replace(one, clock=None) for one in sensors]
    near = [place for place, is_one in enumerate(is_near) if is_one]
    arrived_s = [_clock(sensors[place]).arrived_s for place in near]
    line = fit_clock(np.concatenate([device_s[place] for place in near]), np.concatenate(arrived_s))
    return _moved(sensors, device_s, is_near, line.host_s)


def _bounded(sensors: Sequence[DecodedSensor]) -> list[DecodedSensor]:
    """Fetched ones that say they share one clock: those whose bounds have an instant in common do."""
    device_s = _on_one_turn(sensors)
    bounds = []
    for one, at_s in zip(sensors, device_s, strict=True):
        clock = _clock(one)
        assert clock.ahead_s is not None  # only such are gathered
        by_turns_s = float(at_s[0] - clock.device_s[0])
        bounds.append((clock.ahead_s[0] - by_turns_s, clock.ahead_s[1] - by_turns_s))
    together = max(([other for other in bounds if other[0] <= low <= other[1]] for low, _ in bounds), key=len)
    ahead_s = (max(low for low, _ in together) + min(high for _, high in together)) / 2
    is_near = [low <= ahead_s <= high for low, high in bounds]
    if sum(is_near) < 2:
        return [replace(one, clock=None) for one in sensors]
    return _moved(sensors, device_s, is_near, lambda at_s: at_s + ahead_s)


def _moved(
    sensors: Sequence[DecodedSensor],
    device_s: Sequence[FloatArray],
    is_near: Sequence[bool],
    host_s: Callable[[FloatArray], FloatArray],
) -> list[DecodedSensor]:
    return [
        replace(one, block=replace(one.block, time_s=host_s(at_s))) if is_one else replace(one, clock=None)
        for one, at_s, is_one in zip(sensors, device_s, is_near, strict=True)
    ]


def _on_one_turn(sensors: Sequence[DecodedSensor]) -> list[FloatArray]:
    """The shared clock's seconds (n,) of each, moved by whole turns."""
    # one first received after the clock began again cannot show by how many
    first = sensors[0]
    reference_s = float(first.block.time_s[0] - _clock(first).device_s[0])
    moved_s = []
    for one in sensors:
        clock = _clock(one)
        if not clock.turn_s:
            moved_s.append(clock.device_s)
            continue
        off_s = one.block.time_s - clock.device_s - reference_s
        moved_s.append(clock.device_s + np.round(off_s / clock.turn_s) * clock.turn_s)
    return moved_s


def _clock(one: DecodedSensor) -> SharedClock:
    assert one.clock is not None  # only such are gathered
    return one.clock
