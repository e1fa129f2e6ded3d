"""Labels that contradict the motion, and which sensors seem to have been exchanged."""

from collections.abc import Generator, Mapping
from dataclasses import dataclass

from core.body import Site
from core.findings import Finding, Severity
from core.placement.arrangements import (
    Adjacent,
    Arrangement,
    Arrangements,
    adjacent_in_steps,
    joints_between,
    statures,
)
from core.placement.chains import MIN_MARGIN, MIN_UPRIGHTNESS
from core.placement.smoothed_tracks import Tracks, smoothed_in_steps
from core.placement.steps import at_once
from core.samples import FloatArray
from core.session import Recording, RecordingKind
from core.signal.sensors import SensorTracks

SHARED_COST = 0.2  # two sensors that disagree on less may share a joint, though in a small motion others may as well


@dataclass(frozen=True, slots=True)
class DoubtedLabels:
    """Groups of sites whose sensors seem exchanged, and the name of the recording that shows it; often none."""

    recording: str
    groups: tuple[tuple[Site, ...], ...]

    @property
    def sites(self) -> frozenset[Site]:
        """All sites of the groups: their sensors are of other segments, as the motion has it."""
        return frozenset(site for group in self.groups for site in group)

    @property
    def findings(self) -> list[Finding]:
        """One for every group."""
        return [
            Finding(
                "labels_look_swapped" if len(group) == 2 else "labels_look_mixed",
                Severity.WARNING,
                ", ".join([self.recording, *group]),
            )
            for group in self.groups
        ]


def doubted_labels(tracks: SensorTracks) -> DoubtedLabels:
    """The groups of sites whose sensors seem exchanged, from the free motion, else from a walk."""
    recording = _telling(tracks)
    if recording is None:
        return DoubtedLabels("", ())
    block = tracks.blocks(recording)[0]
    sites = _joined_sites(tracks, recording)
    by_site = {str(site): tracks.oriented(recording, site, block) for site in sites}
    standing = {str(site): force for site in sites if (force := _standing_force(tracks, site)) is not None}
    return DoubtedLabels(recording.name, tuple(exchanged_sites(by_site, standing)))


def _telling(tracks: SensorTracks) -> Recording | None:
    """The recording with the most joints; free motion where that does not decide."""
    moving = [r for r in tracks.span if r.kind is not RecordingKind.STANDING and _joined_sites(tracks, r)]
    is_free = RecordingKind.FREE_MOTION
    return max(moving, key=lambda r: (len(_joined_sites(tracks, r)), r.kind is is_free), default=None)


def _joined_sites(tracks: SensorTracks, recording: Recording) -> list[Site]:
    worn = tuple(site for site in Site if tracks.is_usable(recording, site))
    return [site for site in worn if any(site in (j.proximal, j.distal) for j in joints_between(worn))]


def _standing_force(tracks: SensorTracks, site: Site) -> FloatArray | None:
    for recording in tracks.span:
        if recording.kind is RecordingKind.STANDING and (rest := tracks.rest(recording, site)) is not None:
            return rest.acc_m_s2
    return None


def exchanged_sites(tracks: Tracks, standing: Mapping[str, FloatArray]) -> list[tuple[Site, ...]]:
    """Give groups of sites whose sensors the motion wants exchanged; two exchanged whole legs are not found."""
    return groups_of(at_once(detected_in_steps(tracks, standing)))


def detected_in_steps(tracks: Tracks, standing: Mapping[str, FloatArray]) -> Generator[None, None, dict[Site, Site]]:
    """Give, in steps, the site detected for each declared site that `exchanged_sites` doubts."""
    smoothed = (yield from smoothed_in_steps(tracks)) if tracks else None
    adjacent = (yield from adjacent_in_steps(smoothed, standing)) if smoothed else None
    if adjacent is None:
        return {}
    labelled = {Site(name): sensor for sensor, name in enumerate(adjacent.names)}
    arrangements = Arrangements(tuple(labelled), adjacent)
    best = arrangements.best()
    if arrangements.ratio(labelled, best) < MIN_MARGIN or _has_every_joint(labelled, adjacent):
        best = labelled
    upright = [
        one
        for one in arrangements.alike(best)
        if all(leg.uprightness >= -MIN_UPRIGHTNESS for leg in statures(one, adjacent).values())
    ]
    nearest = min(upright, key=lambda one: _changes(one, labelled), default=labelled)
    site_of = {sensor: site for site, sensor in nearest.items()}
    return {site: site_of[sensor] for site, sensor in labelled.items() if site_of[sensor] is not site}


def groups_of(detected: Mapping[Site, Site]) -> list[tuple[Site, ...]]:
    """The cycles in which the sensors change places."""
    groups: list[tuple[Site, ...]] = []
    left = [site for site in Site if site in detected]
    while left:
        group, site = [], left[0]
        while site in left:
            left.remove(site)
            group.append(site)
            site = detected[site]
        groups.append(tuple(sorted(group, key=list(Site).index)))
    return groups


def _has_every_joint(labelled: Arrangement, adjacent: Adjacent) -> bool:
    ends = [(labelled[joint.proximal], labelled[joint.distal]) for joint in joints_between(tuple(labelled))]
    return all(adjacent.cost[pair] < SHARED_COST for pair in ends)


def _changes(one: Arrangement, other: Arrangement) -> int:
    return sum(one[site] != other[site] for site in one)
