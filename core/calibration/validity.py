"""Which recording calibrates which walk.

A joint takes the latest kept standing and the latest kept free motion before the walk that hold both its sites, else
the first after. Re-strapping ends validity: a calibration never reaches across it. (FORMATS, section 1.)
"""

from collections.abc import Callable
from dataclasses import dataclass

from core.body import Joint, Site
from core.session import Recording, RecordingKind, Session


@dataclass(frozen=True, slots=True)
class Basis:
    """The recordings (names) that one joint's calibration rests on."""

    joint: Joint
    standing: str | None
    free_motion: str | None
    walks: tuple[str, ...]
    is_from_after: bool


def spans_of_validity(session: Session) -> list[tuple[Recording, ...]]:
    """Kept recordings between two re-strappings, in order of time."""
    spans: list[list[Recording]] = [[]]
    for recording in session.recordings:
        if recording.is_restrapped_before and spans[-1]:
            spans.append([])
        if recording.is_kept:
            spans[-1].append(recording)
    return [tuple(span) for span in spans if span]


Holds = Callable[..., bool]
"""Whether a recording holds usable samples of all the sites that follow it: `Recording.holds`, or stricter."""


def in_force(
    span: tuple[Recording, ...], recording: Recording, kind: RecordingKind, sites: tuple[Site, ...], holds: Holds
) -> Recording | None:
    """The latest recording of a kind up to and including `recording` that holds all sites, else the first after."""
    position = span.index(recording)
    fitting = [k for k, other in enumerate(span) if other.kind is kind and holds(other, *sites)]
    before = [k for k in fitting if k <= position]
    if before:
        return span[before[-1]]
    return span[fitting[0]] if fitting else None


def basis_of(span: tuple[Recording, ...], recording: Recording, joint: Joint, holds: Holds = Recording.holds) -> Basis:
    """What calibrates `joint` in `recording`."""
    sites = (joint.proximal, joint.distal)
    standing = in_force(span, recording, RecordingKind.STANDING, sites, holds)
    free = in_force(span, recording, RecordingKind.FREE_MOTION, sites, holds)
    walks = tuple(r.name for r in span if r.kind is RecordingKind.WALKING and holds(r, *sites))
    position = span.index(recording)
    later = [r for r in (standing, free) if r is not None and span.index(r) > position]
    return Basis(
        joint=joint,
        standing=standing.name if standing else None,
        free_motion=free.name if free else None,
        walks=walks,
        is_from_after=bool(later),
    )
