"""Worn DOTs whose links go through Bumble's virtual radio."""

from collections.abc import Sequence
from functools import partial

from devices.emulators.bluetooth import MTU
from devices.emulators.dot import EmulatedDot
from devices.emulators.dot_faults import DotFaults
from tests.devices.bumble_air import ReachedByBumble
from tests.devices.dot.virtual_time import VirtualRadio, turning
from tests.devices.dot.worn_dots import Through


def by_bumble(
    radio: VirtualRadio, faults: Sequence[DotFaults], mtu: int = MTU
) -> tuple[ReachedByBumble, list[EmulatedDot]]:
    dots = [
        EmulatedDot(number, turning, radio.now_ns, fault, skew=(-1) ** number * 20e-6 * number)
        for number, fault in enumerate(faults)
    ]
    EmulatedDot.meet(dots)
    return ReachedByBumble(radio, dots, mtu), dots


def through(mtu: int = MTU) -> Through:
    return partial(by_bumble, mtu=mtu)
