"""A file format in a package of its own: the card of the sum sensor.

A file begins with `SUM1`, and its rows are a counter at 100 Hz as uint32, three rates and three forces as little-endian
int16 (0.01 rad/s, 0.01 m/s2). It is read in a process that may open this file and no other. What is wrong with it is a
`FileRefusedError`: what, where, what to do.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from gaitwright.core import ImuBlock, RateKind, SensorInfo
from gaitwright.devices import FileFormat, FileRefusedError, ImportedSensor, ImportedTrial

MARK, RATE_HZ, UNIT = b"SUM1", 100.0, 0.01
ROW = np.dtype([("counter", "<u4"), ("rate", "<i2", 3), ("force", "<i2", 3)])


def is_card(path: Path, head: bytes) -> bool:
    """By what is in the file, never by its name."""
    return head.startswith(MARK)


def card_trial(files: Sequence[Path], rate_hz: float | None) -> ImportedTrial:
    """One sensor of each file, called as the file is."""
    return ImportedTrial("sum-card", tuple(_sensor(path) for path in files))


def _sensor(path: Path) -> ImportedSensor:
    content = path.read_bytes()[len(MARK) :]
    if len(content) % ROW.itemsize:
        raise FileRefusedError(path.name, "the last row is cut off", "Copy the file from the card again")
    rows = np.frombuffer(content, ROW)
    block = ImuBlock(path.stem, rows["counter"] / RATE_HZ, UNIT * rows["rate"], UNIT * rows["force"])
    info = SensorInfo(model="sum sensor", rate_hz=RATE_HZ, rate_kind=RateKind.INSTANTANEOUS)
    return ImportedSensor(path.stem, (path.stem,), str(path), block, info)


FORMAT = FileFormat(is_card, card_trial, is_one_sensor=True)
