"""Stamps of samples: counters without their turns, and which stamps repeat one before them or step back."""

import numpy as np

from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray
from devices.files.orientation_rates import Numbers
from devices.files.refusal import FileRefusedError
from devices.files.tables import CORRECT_IT, Table


def is_later(stamps: FloatArray | Numbers) -> BoolArray:
    """Which stamps are later than all before them.

    Parameters
    ----------
    stamps : (n,)
        In any unit; NaN where there is none.

    Returns
    -------
    (n,)
        False where there is none.
    """
    is_there = np.isfinite(stamps)
    if not is_there.all():
        stamps = np.where(is_there, stamps, -np.inf)
    latest = np.maximum.accumulate(stamps)
    is_first = np.ones(len(stamps[:1]), dtype=bool)
    return is_there & np.concatenate([is_first, stamps[1:] > latest[:-1]])


def doubled(count: int) -> list[Finding]:
    """What is said of so many samples that were left out; nothing of none."""
    return [Finding("doubled_stamps", Severity.WARNING, "", {"count": count})] if count else []


def unwrapped(table: Table, name: str, turns_at: int, where: str) -> Numbers:
    """A sensor's counter or clock without its turns, ascending.

    Parameters
    ----------
    name
        Of its column.
    turns_at
        The first number that it does not reach.

    Returns
    -------
    (n,)
        From the first one on.

    Raises
    ------
    FileRefusedError
        What is no such number, or steps back.
    """
    raw = table.numbers[name]
    is_count = (raw >= 0) & (raw < turns_at) & (raw == np.floor(raw))
    if not is_count.all():
        raise FileRefusedError(
            f"{where}, {table.place(int(np.argmin(is_count)))}",
            "{name} is not a whole number from 0 to {most}",
            CORRECT_IT,
            name=name,
            most=turns_at - 1,
        )
    count: Numbers = raw.astype(np.int64)
    step: Numbers = np.diff(count) % np.int64(turns_at)
    back = np.flatnonzero(step >= turns_at // 2)
    if len(back):
        row = int(back[0]) + 1
        raise FileRefusedError(
            f"{where}, {table.place(row)}",
            "{name} steps back from {before} to {after}",
            CORRECT_IT,
            name=name,
            before=f"{raw[row - 1]:.0f}",
            after=f"{raw[row]:.0f}",
        )
    first = count[:1]
    return np.concatenate([first, first + np.cumsum(step)])
