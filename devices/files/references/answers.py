"""What the limited process finds in a reference file, and how it is checked before anything is made of it."""

from collections.abc import Sequence

import numpy as np

from devices.files.answers import Array, BrokenAnswerError, Details, unpacked
from devices.files.references.reading import READERS, SOURCES
from devices.files.references.trial import EVENTS, ReferenceFile


def reference_from(details: Details, arrays: Sequence[Array]) -> ReferenceFile:
    """What was packed of a reference, checked.

    Raises
    ------
    BrokenAnswerError
        Something else.
    """
    file = unpacked(ReferenceFile, details, arrays)
    if file.format not in READERS or file.source not in SOURCES:
        raise BrokenAnswerError("a reference of no format")
    for trial in file.trials:
        for time_s, angle_rad in trial.angles.values():
            is_plain = time_s.ndim == 1 and time_s.shape == angle_rad.shape and np.isfinite(time_s).all()
            if not is_plain or (np.diff(time_s) <= 0).any():
                raise BrokenAnswerError("an angle without ascending instants")
        events = [event for by_event in trial.events.values() for event in by_event.items()]
        if any(name not in EVENTS or time_s.ndim != 1 for name, time_s in events):
            raise BrokenAnswerError("events of another name or shape")
        if any(found.ndim != 2 or found.shape[1] != 3 for found in trial.strides.values()):
            raise BrokenAnswerError("strides of another shape")
    return file
