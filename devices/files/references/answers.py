"""What the limited process finds in a reference file, and how it is checked before anything is made of it."""

from collections.abc import Sequence

import numpy as np

from devices.files.answers import Array, BrokenAnswerError, Details, value_from
from devices.files.references.reading import READERS, SOURCES
from devices.files.references.trial import EVENTS, ReferenceFile, ReferenceTrial


def reference_from(details: Details, arrays: Sequence[Array]) -> ReferenceFile:
    """What a reader found, as `details_of` wrote it.

    Raises
    ------
    BrokenAnswerError
        It is something else.
    """
    file: ReferenceFile = value_from(ReferenceFile, details, arrays)
    if file.format not in READERS or file.source not in SOURCES:
        raise BrokenAnswerError("a reference of no format")
    for trial in file.trials:
        _refuse_strange(trial)
    return file


def _refuse_strange(trial: ReferenceTrial) -> None:
    for time_s, angle_rad in trial.angles.values():
        is_paired = time_s.ndim == 1 and time_s.shape == angle_rad.shape
        if not is_paired or not np.isfinite(time_s).all() or (np.diff(time_s) <= 0).any():
            raise BrokenAnswerError("an angle without ascending instants")
    for by_event in trial.events.values():
        if not by_event.keys() <= set(EVENTS) or any(time_s.ndim != 1 for time_s in by_event.values()):
            raise BrokenAnswerError("other events, or in another shape")
    if any(found.ndim != 2 or found.shape[1] != 3 for found in trial.strides.values()):
        raise BrokenAnswerError("strides of another shape")
