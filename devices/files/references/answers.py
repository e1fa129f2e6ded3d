"""What the limited process finds in a reference file, and how it is checked before anything is made of it."""

from collections.abc import Sequence

import numpy as np

from core.body import Joint, Side
from core.samples import FloatArray
from devices.files.answers import Array, BrokenAnswerError, Details
from devices.files.references.reading import READERS, SOURCES
from devices.files.references.trial import EVENTS, ReferenceFile, ReferenceTrial


def details_of_reference(file: ReferenceFile, arrays: list[Array]) -> Details:
    """What a reader found, its samples put into `arrays`."""

    def put(array: Array) -> int:
        arrays.append(array)
        return len(arrays) - 1

    return {
        "format": file.format,
        "source": file.source,
        "trials": [
            {
                "name": trial.name,
                "angles": {joint: [put(time_s), put(angle)] for joint, (time_s, angle) in trial.angles.items()},
                "events": {
                    side: {event: put(time_s) for event, time_s in by_event.items()}
                    for side, by_event in trial.events.items()
                },
                "strides": {side: put(strides) for side, strides in trial.strides.items()},
            }
            for trial in file.trials
        ],
    }


def reference_from(details: Details, arrays: Sequence[Array]) -> ReferenceFile:
    """What `details_of_reference` wrote, checked.

    Raises
    ------
    BrokenAnswerError
        It is something else.
    """
    try:
        name, source = details["format"], details["source"]
        if name not in READERS or source not in SOURCES:
            raise BrokenAnswerError("a reference of no format")
        return ReferenceFile(name, source, tuple(_trial(one, arrays) for one in details["trials"]))
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        raise BrokenAnswerError(f"an answer of another shape ({error})") from error


def _trial(details: Details, arrays: Sequence[Array]) -> ReferenceTrial:
    angles = {}
    for joint, (time, angle) in details["angles"].items():
        time_s, angle_rad = _numbers(arrays[time], 1), _numbers(arrays[angle], 1)
        if time_s.shape != angle_rad.shape or not np.isfinite(time_s).all() or (np.diff(time_s) <= 0).any():
            raise BrokenAnswerError("an angle without ascending instants")
        angles[Joint(joint)] = time_s, angle_rad
    events = {
        Side(side): {EVENTS[EVENTS.index(event)]: _numbers(arrays[k], 1) for event, k in by_event.items()}
        for side, by_event in details["events"].items()
    }
    strides = {Side(side): _numbers(arrays[k], 2) for side, k in details["strides"].items()}
    if any(found.shape[1] != 3 for found in strides.values()):
        raise BrokenAnswerError("strides of another shape")
    if not isinstance(details["name"], str):
        raise BrokenAnswerError("a trial without a name")
    return ReferenceTrial(details["name"], angles, events, strides)


def _numbers(array: Array, dimensions: int) -> FloatArray:
    if array.dtype != np.float64 or array.ndim != dimensions:
        raise BrokenAnswerError(f"numbers of {array.dtype} in {array.ndim} dimensions")
    return array.astype(np.float64, copy=False)
