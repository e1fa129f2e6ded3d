"""What a file format is: how it is recognised, and how the files of a trial are read."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from devices.files.trial import ImportedTrial


@dataclass(frozen=True, slots=True)
class FileFormat:
    """`is_it`: whether a file, whose first bytes are given, is of this format; a folder has none.

    `trial`: what the files of one trial hold, with the samples per second where they give none. `is_one_sensor`: a
    file holds one sensor, and a trial has several; else it holds all of them. `trial_name`: what the names of all files
    of a trial have in common, where the format itself states how they are called.
    """

    is_it: Callable[[Path, bytes], bool]
    trial: Callable[[Sequence[Path], float | None], ImportedTrial]
    is_one_sensor: bool = False
    trial_name: Callable[[Path], str] | None = None
