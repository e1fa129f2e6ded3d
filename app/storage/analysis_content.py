"""Write an analysis so that what is read is what was computed, to the last bit.

A SHA-256 of all that follows; the length of the outline, 8 bytes, little-endian; the outline, JSON; the arrays' bytes
one after another. The outline names every class and array; nothing but the core's own values can come out of it.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from core.body import Joint, Side, Site
from core.findings import Finding, Severity
from core.gait.clocks import ClockTie, LegClocks
from core.gait.events import FootEvents
from core.gait.strides import Reason, Strides
from core.hip.results import ClockStatus, HipAngle, HipIdentification, LegClock, PelvisAngles, PelvisTurn
from core.results import (
    Analysis,
    AxisHalves,
    AxisSource,
    Calibration,
    JointAngle,
    JointCalibration,
    Method,
    RecordingAnalysis,
    SideGait,
    ZeroKind,
)
from core.session import RecordingKind
from core.signal.reception import Reception
from core.timed.found import (
    DistanceSource,
    NotMeasured,
    NotValid,
    PartOfUpAndGo,
    Rise,
    Silence,
    Sitting,
    StairStride,
    TimedPart,
    TimedTest,
    Turn,
    UpAndGoPart,
)
from core.timed.protocols import TimedProtocol
from core.verdicts.model import Assessment, GateReason, JointVerdicts, LegVerdicts, Verdict, Verdicts

FORMAT = "gaitwright-kept-analysis/7"
DIGEST, LENGTH = 32, 8
KINDS = "biuf"  # of arrays: truth and figures
VALUES: Mapping[str, type] = {
    kind.__name__: kind
    for kind in (
        *(Analysis, AxisHalves, Calibration, Finding, FootEvents, JointAngle, JointCalibration),
        *(Reception, RecordingAnalysis, SideGait, Strides),
        *(HipAngle, HipIdentification, LegClock, PelvisAngles, PelvisTurn),
        *(Assessment, GateReason, LegClocks, JointVerdicts, LegVerdicts, Verdicts),
        *(Rise, Silence, Sitting, StairStride, TimedPart, TimedTest, Turn, UpAndGoPart),
    )
}
WORDS: Mapping[str, type[StrEnum]] = {
    kind.__name__: kind
    for kind in (
        *(AxisSource, ClockStatus, ClockTie, DistanceSource, Joint, Method, NotMeasured, NotValid, PartOfUpAndGo),
        *(Reason, RecordingKind),
        *(Severity, Side, Site, TimedProtocol, Verdict, ZeroKind),
    )
}


class DamagedContentError(Exception):
    """This is no analysis, or not all of one."""


def packed(analysis: Analysis) -> bytes:
    """The same analysis gives the same bytes."""
    arrays: list[bytes] = []
    outline = json.dumps(_outline(analysis, arrays), separators=(",", ":")).encode()
    content = b"".join([len(outline).to_bytes(LENGTH, "little"), outline, *arrays])
    return hashlib.sha256(content).digest() + content


def unpacked(content: bytes) -> Analysis:
    """Unpack what `packed` was given; raises DamagedContentError also for an earlier version's."""
    inside = memoryview(content)[DIGEST:]
    if hashlib.sha256(inside).digest() != content[:DIGEST]:
        raise DamagedContentError
    end = LENGTH + int.from_bytes(inside[:LENGTH], "little")
    try:
        found = _value(json.loads(bytes(inside[LENGTH:end])), _Arrays(inside[end:]))
    except (KeyError, TypeError, ValueError) as error:
        raise DamagedContentError from error
    if not isinstance(found, Analysis):
        raise DamagedContentError
    return found


def _outline(value: Any, arrays: list[bytes]) -> Any:
    match value:
        case np.ndarray():
            if value.dtype.kind not in KINDS:
                raise TypeError(f"an analysis holds no array of {value.dtype}")
            together = value.copy(order="K")  # sums depend on the order in memory, if only in their last bit
            order = "C" if together.flags.c_contiguous else "F"
            arrays.append(together.tobytes(order="A"))
            return {"array": [value.dtype.str, list(value.shape), order]}
        case StrEnum():
            return {"word": [type(value).__name__, str(value)]}
        case np.generic():
            return value.item()
        case bool() | int() | float() | str() | None:
            return value
        case tuple():
            return [_outline(one, arrays) for one in value]
        case frozenset():
            return {"set": [_outline(one, arrays) for one in sorted(value)]}
        case Mapping():
            return {"map": [[_outline(key, arrays), _outline(one, arrays)] for key, one in value.items()]}
    if not is_dataclass(value) or type(value).__name__ not in VALUES:
        raise TypeError(f"an analysis holds no {type(value).__name__}")
    reported = [_outline(getattr(value, field.name), arrays) for field in fields(value)]
    return {"value": [type(value).__name__, reported]}


class _Arrays:
    """Hands out the arrays in the order in which they were written."""

    def __init__(self, content: memoryview) -> None:
        self._content, self._at = content, 0

    def next(self, kind: str, shape: list[int], order: str) -> Any:
        dtype = np.dtype(kind)
        if dtype.kind not in KINDS or order not in ("C", "F"):
            raise ValueError(kind)
        count = int(np.prod(shape, dtype=np.int64))
        start, self._at = self._at, self._at + count * dtype.itemsize
        flat = np.frombuffer(self._content[start : self._at], dtype, count).copy()  # our own, to be written to
        return flat.reshape(shape, order="F" if order == "F" else "C")


def _value(outline: Any, arrays: _Arrays) -> Any:
    if isinstance(outline, list):
        return tuple(_value(one, arrays) for one in outline)
    if not isinstance(outline, dict):
        return outline
    ((what, reported),) = outline.items()
    match what:
        case "array":
            return arrays.next(*reported)
        case "word":
            return WORDS[reported[0]](reported[1])
        case "set":
            return frozenset(_value(one, arrays) for one in reported)
        case "map":
            return {_value(key, arrays): _value(one, arrays) for key, one in reported}
        case "value":
            return VALUES[reported[0]](*(_value(one, arrays) for one in reported[1]))
    raise ValueError(what)
