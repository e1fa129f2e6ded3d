"""Simulated visits and their analyses for tests that are about something else: computed once and kept on the disk.

Both test workers and the next run find them there, until a line of `core` or `devices` or a library that computes
changes. Tests of the walker, of the analysis, or with a part of either patched call these themselves.
"""

import hashlib
import pickle
import platform
import shutil
from collections.abc import Callable, Mapping, Set
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace
from datetime import date
from enum import Enum
from importlib.metadata import version
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any, TypeVar

import numpy as np

from core.analysis import analyse
from core.body import Site
from core.results import Analysis
from core.session import Session
from core.signal.filters import FILTER
from devices.simulation.walker import (
    DEMONSTRATION,
    FreeMotion,
    SimulatedSession,
    Standing,
    Walk,
    WalkerSettings,
    simulate,
)
from devices.simulation.walker_body import Tissue

ROOT = Path(__file__).parents[1]
T = TypeVar("T")
OTHERS = 2

# Who walked, for tests that need no more of anybody; whoever needs more states it where it asks.
LONG_WALK = DEMONSTRATION
"""Fourteen strides after free motion, with tissue: enough for a spread, a summary, a report."""
SLOW_WALK = replace(DEMONSTRATION, recordings=(Standing(), FreeMotion(), Walk(strides=13, speed_m_s=0.95)))
"""The same slower than most healthy people: another reference, and speed is worth a word."""
TWO_WALKS = replace(DEMONSTRATION, recordings=(*SLOW_WALK.recordings, Walk("walk 2", strides=13)))
"""A slow walk and a usual one, to choose and to compare."""
THREE_WALKS = replace(
    DEMONSTRATION,
    tissue=Tissue.RIGID,
    recordings=(
        *(Standing(), FreeMotion(), Walk(strides=13), Walk("walk 2", strides=13)),
        Walk("walk 3", strides=13, speed_m_s=0.9),
    ),
)
"""Two alike and a slower one on rigid sensors, so that no strap seems to slip: conditions and their errors."""
EXACT_WALK = WalkerSettings(seed=2, recordings=(Standing(), FreeMotion(), Walk(strides=12)))
"""Twelve strides on rigid sensors: files are held to what they were made of."""
SHORT_VISIT = WalkerSettings(seed=5, recordings=(Standing(), FreeMotion(), Walk(strides=6)))
"""Standing, free motion and six strides, soon analysed: what is stored, exported and read back."""
SHORT_WALK = WalkerSettings(seed=4, recordings=(Standing(), Walk(strides=5)))
"""Five strides of both legs, soon analysed: every joint has angles, and none a spread."""
WALK_OF_ONE_LEG = replace(
    DEMONSTRATION,
    sites=(Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT),
    recordings=(Standing(duration_s=2.0), Walk(strides=12)),
)
"""Twelve strides of the left leg, the soonest analysed: a knee, an ankle and a spread of both."""


class Store:
    """What was computed from what; nothing is kept before `open`, as where scripts use these functions."""

    def __init__(self) -> None:
        self._folder: Path | None = None

    def open(self, place: Path) -> None:
        """Keep in a folder of `place` that is called after all that computes; of other code's the latest stay."""
        self._folder = place / code_digest(ROOT)
        self._folder.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):  # another worker was first
            others = sorted(set(place.iterdir()) - {self._folder}, key=lambda one: one.stat().st_mtime)
            for old in others[:-OTHERS]:  # the latest may be in use by a run that was begun before the code was changed
                shutil.rmtree(old, ignore_errors=True)

    def get(self, compute: Callable[..., T], *arguments: object) -> T:
        """What `compute` gives, of nobody else's: whoever changes it changes it for itself."""
        if self._folder is None:
            return compute(*arguments)
        file = self._folder / digest(compute.__name__, *arguments)
        with suppress(FileNotFoundError):
            found: T = pickle.loads(file.read_bytes())
            return found
        made = compute(*arguments)
        with suppress(FileNotFoundError):  # three runs of other code came meanwhile, and took the folder away
            with NamedTemporaryFile(dir=self._folder, delete=False) as written:
                pickle.dump(made, written, pickle.HIGHEST_PROTOCOL)
            Path(written.name).replace(file)  # another worker sees all of it or nothing
        return made


STORE = Store()


def simulation_of(settings: WalkerSettings) -> SimulatedSession:
    """What `simulate` gives, without how the recordings were moved: that is most of it."""
    return STORE.get(_simulate, settings)


def session_of(settings: WalkerSettings) -> Session:
    return simulation_of(settings).session


def analysis_of(session: Session) -> Analysis:
    return STORE.get(analyse, session)


def _simulate(settings: WalkerSettings) -> SimulatedSession:
    return replace(simulate(settings), moved=())


def code_digest(root: Path) -> str:
    """Of the sources and libraries that a result depends on."""
    found = hashlib.blake2b(Path(__file__).read_bytes(), digest_size=16)
    for file in sorted(file for folder in ("core", "devices") for file in (root / folder).rglob("*.py")):
        found.update(file.relative_to(root).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    found.update(
        repr([platform.machine(), platform.python_version(), *map(version, ("numpy", "scipy")), FILTER]).encode()
    )
    return found.hexdigest()


def digest(*values: object) -> str:
    """Of plain values, numbers, arrays and dataclasses of them: the same in every process."""
    found = hashlib.blake2b(digest_size=16)
    _add(found, values)
    return found.hexdigest()


def _add(found: hashlib.blake2b, value: Any) -> None:
    match value:
        case np.ndarray() if value.dtype != object:
            parts: tuple[Any, ...] = (value.dtype.str, value.shape, value.tobytes())
        case Mapping():
            parts = tuple(value.items())
        case Set():
            parts = tuple(sorted(value))
        case list() | tuple():
            parts = tuple(value)
        case _ if is_dataclass(value):
            parts = tuple((one.name, getattr(value, one.name)) for one in fields(value))
        case bytes():
            found.update(b"%d:" % len(value) + value)
            return
        case None | bool() | int() | float() | str() | date() | Enum() | np.generic():
            found.update(f"{type(value).__qualname__}{value!r};".encode())
            return
        case _:
            raise TypeError(f"{value!r} has no digest")
    found.update(f"{type(value).__qualname__}{len(parts)}:".encode())
    for part in parts:
        _add(found, part)
