"""Tests of work in the thread of the links. It is waited for, reported, and ended when nobody waits any more."""

import asyncio
import threading

import pytest

from devices.transport.bluetooth import Radio

radio = Radio()
"""One for all: its thread lasts as long as the process, as the application's does."""


async def answered(after_s: float) -> int:
    await asyncio.sleep(after_s)
    return 7


def test_what_is_done_is_waited_for_and_reported_of() -> None:
    ticks: list[int] = []
    assert radio.run(answered(0.0)) == 7
    assert radio.run(answered(0.5), lambda: ticks.append(1)) == 7
    assert 1 <= len(ticks) <= 3


def test_what_fails_is_raised_where_it_is_waited_for() -> None:
    async def failing() -> None:
        raise ValueError("so")

    for tick in (None, lambda: None):
        with pytest.raises(ValueError, match="so"):
            radio.run(failing(), tick)


def test_whoever_waits_no_more_ends_it_and_its_clean_up_is_waited_for() -> None:
    cleaned = threading.Event()

    async def long() -> None:
        try:
            await asyncio.sleep(60.0)
        finally:
            await asyncio.sleep(0.1)
            cleaned.set()

    def tick() -> None:
        raise InterruptedError

    with pytest.raises(InterruptedError):
        radio.run(long(), tick)
    assert cleaned.is_set()
