"""Tests that what looks at a whole motion waits for the sensors that are behind, and no longer than it has to."""

import numpy as np
import pytest

from app.acquisition.motion_memory import WAIT_S, MotionMemory
from core.samples import ImuBlock


def block(sensor: str, from_s: float, to_s: float) -> ImuBlock:
    time_s = np.arange(from_s, to_s, 0.01)
    return ImuBlock(sensor, time_s, np.zeros((len(time_s), 3)), np.zeros((len(time_s), 3)))


def test_a_look_waits_for_a_sensor_that_is_behind_until_it_is_left_out() -> None:
    memory = MotionMemory(["thigh", "shank", "foot"])  # the foot is never received
    memory.feed({"thigh": block("thigh", 0.0, 2.0), "shank": block("shank", 0.0, 1.0)})
    assert memory.has_passed(0.9)
    assert not memory.has_passed(1.5)
    memory.feed({"thigh": block("thigh", 2.0, 1.5 + WAIT_S + 0.02)})
    assert memory.has_passed(1.5)
    parts = memory.between(0.5, 1.5)
    assert {name: len(part) for name, part in parts.items()} == {"thigh": 100, "shank": 50}
    assert parts["thigh"].time_s[[0, -1]] == pytest.approx([0.5, 1.49])


def test_what_is_long_past_is_let_go() -> None:
    memory = MotionMemory(["thigh"])
    for second in range(4):
        memory.feed({"thigh": block("thigh", float(second), second + 1.0)})
    memory.forget_before(2.5)
    assert memory.between(0.0, 9.0)["thigh"].time_s[0] == pytest.approx(2.0)
