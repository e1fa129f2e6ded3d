"""A search in steps of some ten milliseconds: who has to keep up with sensors takes one at a time, others all at once.

A generator yields after every step and returns what it has found.
"""

from collections.abc import Generator
from typing import TypeVar

Found = TypeVar("Found")


def at_once(steps: Generator[None, None, Found]) -> Found:
    """What a search finds, without a pause."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            found: Found = end.value
            return found
