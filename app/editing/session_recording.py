"""One recording of a visit at present: the one that goes on, those that have ended, and which of them count."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING
from uuid import UUID

from app.storage.stored import StoredRecording
from core.body import Side
from core.session import Recording

if TYPE_CHECKING:
    from app.acquisition.memory_fetching import Lack
    from core.signal.received import SamplesReceived
    from core.timed.protocols import PlannedTest


@dataclass(frozen=True, slots=True)
class Ongoing:
    """What is being recorded. `began_s` is on the acquisition's clock."""

    details: Recording
    began_s: float


@dataclass(frozen=True, slots=True)
class SessionRecording:
    """A recording that has ended. `read_back` holds what its journal holds; None until it has been read.

    `strides` are those counted live. `is_decided`: somebody has stated whether it is kept; until then it is. `lacks`:
    what could not be fetched from the sensors' memories. `received`: by sensor, of a recording of this visit alone.
    """

    stored: StoredRecording
    read_back: Recording | None = None
    strides: Mapping[Side, int] | None = None
    is_decided: bool = True
    lacks: "tuple[Lack, ...]" = ()
    received: "Mapping[str, SamplesReceived]" = field(default_factory=dict)

    @property
    def id(self) -> UUID:
        return self.stored.id

    @property
    def details(self) -> Recording:
        return self.stored.details


def counted(recordings: Sequence[SessionRecording]) -> tuple[Recording, ...]:
    """Give kept, read recordings in time order; a re-strapping before an omitted one passes to the next."""
    found = []
    is_restrapped = False
    for recording in recordings:
        is_restrapped |= recording.details.is_restrapped_before
        if recording.details.is_kept and recording.read_back is not None:
            reported = replace(recording.details, imu=recording.read_back.imu, is_restrapped_before=is_restrapped)
            found.append(replace(reported, test=_with_its_keys(reported.test, recording.read_back.test)))
            is_restrapped = False
    return tuple(found)


def _with_its_keys(reported: "PlannedTest | None", read: "PlannedTest | None") -> "PlannedTest | None":
    """The test as it was entered; a recovered recording's keys are in its journal alone."""
    if reported is None or read is None or read.protocol is not reported.protocol:
        return reported
    if (reported.start_key_s, reported.end_key_s) != (None, None):
        return reported
    return replace(reported, start_key_s=read.start_key_s, end_key_s=read.end_key_s)
