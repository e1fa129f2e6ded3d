"""Formats of other packages, loaded in the process that reads a stranger's file, and in no other.

They are asked for a file that is none of ours. What they raise leaves them out, or refuses the file by their name.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from devices.files.answers import Array, details_of, value_from
from devices.files.file_format import FileFormat
from devices.files.refusal import FileRefusedError
from devices.files.trial import PROGRAMS, ImportedTrial
from devices.other_packages import IMPORTERS, BrokenOfferError, Offer, offers


def offered_formats() -> tuple[Offer, ...]:
    """Find the formats that installed packages offer, without importing them."""
    return offers(IMPORTERS, PROGRAMS)


@cache
def other_formats() -> Mapping[str, FileFormat]:
    """Import every format that other packages offer and that can be used, by name."""
    found = {}
    for offer in offered_formats():
        with suppress(BrokenOfferError):  # `gaitwright devices` states why
            found[offer.name] = usable_format(offer)
    return found


def usable_format(offer: Offer) -> FileFormat:
    """Import one format; raises BrokenOfferError where it cannot be used."""
    own = offer.load(FileFormat)
    of_trial = own.trial_name
    if not callable(own.is_it) or not callable(own.trial) or not (of_trial is None or callable(of_trial)):
        raise BrokenOfferError("not as a FileFormat has it")

    def is_it(path: Path, head: bytes) -> bool:
        with suppress(Exception):  # the edge to a stranger's reader
            return own.is_it(path, head) is True
        return False

    def trial(files: Sequence[Path], rate_hz: float | None) -> ImportedTrial:
        try:
            arrays: list[Array] = []
            # as who asked will understand it, so that what is of another shape is refused by its package's name
            found: ImportedTrial = value_from(ImportedTrial, details_of(own.trial(files, rate_hz), arrays), arrays)
            _check(found)
        except (FileRefusedError, OSError, MemoryError):  # what a reader may say
            raise
        except Exception as error:  # the edge to a stranger's reader
            raise FileRefusedError(
                files[0].name,
                "the importer {name} of the package {package} {version} stopped with an error ({error})",
                "Install a newer version of {package}",
                name=offer.name,
                package=offer.package,
                version=offer.version,
                error=type(error).__name__,
            ) from error
        return replace(found, format=offer.name)

    def trial_name(path: Path) -> str:
        with suppress(Exception):  # the edge to a stranger's reader
            if of_trial is not None and isinstance(name := of_trial(path), str):
                return name
        return path.stem

    return FileFormat(is_it, trial, own.is_one_sensor is True, None if of_trial is None else trial_name)


def _check(found: ImportedTrial) -> None:
    """Raise ValueError for what no reader of ours gives."""
    names = [sensor.name for sensor in found.sensors]
    if not names or len(set(names)) < len(names):
        raise ValueError("no sensor, or two of one name")
    for sensor in found.sensors:
        time_s = sensor.block.time_s
        if not np.isfinite(time_s).all() or not (np.diff(time_s) > 0.0).all():
            raise ValueError("stamps that do not ascend")
