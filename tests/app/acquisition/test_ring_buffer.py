"""The last seconds of a sensor are there, in order, however they came."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.acquisition.ring_buffer import RingBuffer


def add(ring: RingBuffer, first: int, count: int) -> None:
    number = np.arange(first, first + count, dtype=float)
    ring.add(number, np.stack([number] * 3, axis=1), -np.stack([number] * 3, axis=1))


@given(st.lists(st.integers(0, 25), max_size=40))
def test_the_newest_samples_are_held_in_order(sizes: list[int]) -> None:
    ring, total = RingBuffer("one", 10), 0
    for size in sizes:
        add(ring, total, size)
        total += size
    held = ring.newest(10)
    expected = np.arange(max(total - 10, 0), total)
    assert ring.total == total
    assert held.time_s.tolist() == expected.tolist()
    assert held.gyr_rad_s[:, 2].tolist() == expected.tolist()
    assert held.acc_m_s2[:, 0].tolist() == (-expected).tolist()
    assert ring.since(total - 3).time_s.tolist() == expected[-3:].tolist()
    assert ring.newest(2).time_s.tolist() == expected[-2:].tolist()
    assert len(ring.newest(0)) == 0


def test_what_was_handed_out_does_not_change() -> None:
    ring = RingBuffer("one", 4)
    add(ring, 0, 4)
    block = ring.newest(4)
    add(ring, 4, 20)
    assert block.time_s.tolist() == [0, 1, 2, 3]
