"""What becomes of a stream when much goes wrong at once: long runs of damage, lost, swapped and repeated blocks, leaps.

Single messages that are changed or cut are `tests/safety/device_fuzz.py`.
"""

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

BLOCK = (5, 80)  # messages
HURT_SHARE = 1 / 4  # of the blocks
MOST_NOISE = 6000  # bytes
LEAPS = (-100_000, 1_000_000)  # samples that the sensor's clock goes back or ahead
NEAR = (-600, 600)  # and as far as a clock may go on its own
FIRST = 200_000  # so that it can go back


@dataclass(frozen=True, slots=True)
class Sent:
    """Bytes that reach whoever listens.

    Attributes
    ----------
    number
        Of the sample that they report whole, by the sensor's clock; None of what is no whole message.
    index
        Which sample of the stream it is; None where none was taken then.
    """

    data: bytes
    number: int | None = None
    index: int | None = None


def in_bursts(sample: Callable[[int], bytes], count: int, chance: random.Random) -> Iterator[Sent]:
    """Send `count` samples, whose numbers `sample` turns into messages; a quarter of the blocks is hurt."""
    number, index = FIRST, 0
    while index < count:
        length = min(chance.randint(*BLOCK), count - index)
        is_hurt = chance.random() < HURT_SHARE
        if is_hurt and chance.random() < 0.25:
            number = max(0, number + chance.randint(*LEAPS))  # switched off and on, or a stamp that was read wrongly
        block = [Sent(sample(number + k), number + k, index + k) for k in range(length)]
        number, index = number + length, index + length
        yield from _hurt(block, sample, chance) if is_hurt else block


def _hurt(block: Sequence[Sent], sample: Callable[[int], bytes], chance: random.Random) -> list[Sent]:
    stated = b"".join(one.data for one in block)
    k = chance.randrange(len(block))
    match chance.randrange(9):
        case 0:
            return [Sent(_changed(stated, chance))]
        case 1:
            return []
        case 2:
            return [*block[k:], *block[:k]]
        case 3:
            return [*block, *block]
        case 4:
            at = chance.randrange(len(stated))
            return [Sent(stated[:at] + stated[at + chance.randint(1, len(stated)) :])]
        case 5:
            return [*block[:k], Sent(chance.randbytes(chance.randint(1, MOST_NOISE))), *block[k:]]
        case 6:
            return list(reversed(block))
        case 7:
            return [Sent(bytes([chance.randrange(256)]) * chance.randint(1, MOST_NOISE)), *block]
        case _:  # stamps that leap and come back; no sample was taken then
            about, leap = (FIRST, LEAPS) if chance.random() < 0.5 else (block[k].number or FIRST, NEAR)
            wild = [max(0, about + chance.randint(*leap)) for _ in range(chance.randint(1, 10))]
            return [*block[:k], *(Sent(sample(number), number) for number in wild), *block[k:]]


def _changed(stated: bytes, chance: random.Random) -> bytes:
    """The same bytes, a share of them others."""
    data, share = bytearray(stated), chance.random() ** 3
    for at in range(len(data)):
        if chance.random() < share:
            data[at] = chance.randrange(256)
    return bytes(data)
