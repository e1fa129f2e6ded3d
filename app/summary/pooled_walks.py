"""Which walks of a session are taken together: those of one condition, one strapping and one setting of the prosthesis.

A timed test and a walk towards a target on the patient's screen are walked otherwise than the walks around them, so
their strides are never among those of a condition. Nor are those of an alignment that the prosthesis was put back to:
what was shown of its first walks would change long after it was read.
"""

from collections.abc import Mapping, Sequence
from itertools import accumulate
from typing import NamedTuple

from app.summary.alignments import alignments_of
from app.wording.recordings import shown_names
from core.alignment import AlignmentChange, changed_between
from core.session import Recording, RecordingKind
from core.targets import tallies_of


class Pool(NamedTuple):
    """What walks share that are taken together.

    `condition` is a walk's own name where it has none, `attachment` how often the sensors were strapped on again
    before, `returns` how often the prosthesis was put back to the condition. `apart` is the timed test that the walks
    are, or the name of a walk towards a target; empty of all others.
    """

    condition: str
    attachment: int = 0
    returns: int = 0
    apart: str = ""


def pools_of(recordings: Sequence[Recording]) -> Mapping[str, Pool]:
    """Give each kept walk's pool by the walk's name, from one session's recordings in order of time."""
    strapped = accumulate(one.is_restrapped_before for one in recordings)
    changes = alignments_of(recordings)
    since: dict[tuple[str, int], list[str]] = {}  # the conditions walked since, by those walked before
    returns: dict[tuple[str, int], int] = {}
    found = {}
    for one, attachment in zip(recordings, strapped, strict=True):
        if one.kind is not RecordingKind.WALKING or not one.is_kept:
            continue
        condition = one.condition or one.name
        key = condition, attachment
        returns[key] = returns.get(key, 0) + _was_elsewhere(changes, condition, since.get(key, ()))
        for between in since.values():
            between.append(condition)
        since[key] = []
        found[one.name] = Pool(condition, attachment, returns[key], _apart(one))
    return found


def pool_letters(recordings: Sequence[Recording]) -> Mapping[Pool, str]:
    """Give what each pool is called in comparisons: as the first of its walks is, "A", or "A2"."""
    names = shown_names(recordings)
    found: dict[Pool, str] = {}
    for name, pool in pools_of(recordings).items():
        found.setdefault(pool, names[name].letter)
    return found


def _was_elsewhere(changes: Mapping[str, AlignmentChange | None], condition: str, between: Sequence[str]) -> bool:
    """Whether the prosthesis was in another alignment, by what was written down, in one of the walks between."""
    return any(changed_between(changes, other, condition) for other in between)


def _apart(recording: Recording) -> str:
    if recording.test is not None:
        return recording.test.protocol
    return recording.name if tallies_of(recording.note) else ""
