"""Stamps of sensors that share one clock: one line to the host's clock for all of them.

How late a sensor's samples arrive at the least is its own link's affair and cannot be seen. Where sensors are stamped
one by one they lie apart by what their links differ; by one line they lie as their common clock says.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.samples import FloatArray
from devices.clock import fit_clock
from devices.source import DecodedSensor, SharedClock

APART_S = 0.1  # links do not differ by more: a sensor further off does not run by the clock that it names

Named = tuple[str, DecodedSensor]


def tied(found: Sequence[Named]) -> list[Named]:
    """Stamp sensors that share a clock by one line; all others stay as they are, and so does one that only says so."""
    places: dict[str, list[int]] = {}
    for place, (_, one) in enumerate(found):
        if one.clock is not None and len(one.block):
            places.setdefault(one.clock.name, []).append(place)
    every = list(found)
    for together in places.values():
        stamped = _stamped([found[place][1] for place in together])
        for place, one in zip(together, stamped, strict=True):
            every[place] = found[place][0], one
    return every


def _stamped(sensors: Sequence[DecodedSensor]) -> list[DecodedSensor]:
    """Those that say they share one clock, each with samples."""
    first = sensors[0]
    assert first.clock is not None
    reference_s = float(first.block.time_s[0] - first.clock.device_s[0])
    device_s = [_on_one_turn(one, reference_s) for one in sensors]
    offsets_s = [float(np.median(one.block.time_s - at_s)) for one, at_s in zip(sensors, device_s, strict=True)]
    middle_s = float(np.median(offsets_s))
    is_near = [abs(offset_s - middle_s) < APART_S for offset_s in offsets_s]
    if sum(is_near) < 2:
        return [replace(one, clock=None) for one in sensors]
    near = [(at_s, _arrived_s(one)) for one, at_s, is_one in zip(sensors, device_s, is_near, strict=True) if is_one]
    line = fit_clock(np.concatenate([at_s for at_s, _ in near]), np.concatenate([come_s for _, come_s in near]))
    return [
        replace(one, block=replace(one.block, time_s=line.host_s(at_s))) if is_one else replace(one, clock=None)
        for one, at_s, is_one in zip(sensors, device_s, is_near, strict=True)
    ]


def _on_one_turn(one: DecodedSensor, reference_s: float) -> FloatArray:
    """The shared clock's seconds (n,), moved by whole turns: who heard it first after it began anew cannot know."""
    clock: SharedClock | None = one.clock
    assert clock is not None
    if not clock.turn_s:
        return clock.device_s
    off_s = one.block.time_s - clock.device_s - reference_s
    moved_s: FloatArray = clock.device_s + np.round(off_s / clock.turn_s) * clock.turn_s
    return moved_s


def _arrived_s(one: DecodedSensor) -> FloatArray:
    assert one.clock is not None
    return one.clock.arrived_s
