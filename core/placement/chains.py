"""Sensors arranged to legs without any label: which make up one, which end is up, which leg moved first."""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from core.body import LEG_SEGMENTS, LEG_SITES, Segment, Side, Site, ankle_of, knee_of
from core.placement.arrangements import Adjacent, Arrangement, Arrangements, Stature, adjacent_in_steps, statures
from core.placement.smoothed_tracks import Tracks, smoothed_in_steps
from core.placement.steps import at_once
from core.samples import FloatArray
from core.signal.pair import MOVING_WINDOW_S, OrientedTrack, moving_mean

MIN_MARGIN = 1.7  # wrong sensors at a joint had 1.5 at most, in motions of two seconds; right ones seldom under 2
MIN_UPRIGHTNESS = 0.5  # flatter, the patient lay, and the vertical does not show which end is up
LIFTED_RAD_S = 0.7  # the leg that bears the weight sways less
MIN_LEAD_S = 0.5

# What a number of sensors is worn as: whole legs first, then a knee; a seventh on the pelvis.
USUAL_SITES = {
    2: (Site.LEFT_THIGH, Site.LEFT_SHANK),
    3: (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT),
    4: (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.RIGHT_THIGH, Site.RIGHT_SHANK),
    5: (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT, Site.RIGHT_THIGH, Site.RIGHT_SHANK),
    6: LEG_SITES,
    7: (*LEG_SITES, Site.PELVIS),
}


@dataclass(frozen=True, slots=True)
class Chain:
    """The sensors of one leg by name. `foot` None: a knee alone.

    `knee_margin`, `ankle_margin`: cost of the best arrangement without this joint over the cost of the best; infinite
    where there is no other.
    `stature`: how much higher the thigh's sensor sits than the last one in standing, as the joints' places show.
    """

    thigh: str
    shank: str
    foot: str | None
    knee_margin: float
    ankle_margin: float | None
    stature: Stature
    moved_at_s: float | None  # when the leg was lifted first, None where it never was

    @property
    def sensors(self) -> tuple[str, ...]:
        return (self.thigh, self.shank) if self.foot is None else (self.thigh, self.shank, self.foot)

    @property
    def is_direction_certain(self) -> bool:
        return self.stature.uprightness > MIN_UPRIGHTNESS


@dataclass(frozen=True, slots=True)
class Chains:
    """The legs in the order in which they were lifted. Left and right are not in the motion: one hint names them.

    `lead_s`: how much earlier the first leg was lifted than the second; None where one of them never was or is not
    there.
    """

    legs: tuple[Chain, ...]
    margin: float  # cost of the best rival arrangement over the cost of this one; infinite where there is no rival
    lead_s: float | None
    pelvis: str | None = None  # the sensor that both thighs hang from; None where there are two to six

    @property
    def is_certain(self) -> bool:
        """Whether the sensors may be named without asking, but for left and right."""
        return self.margin > MIN_MARGIN and all(leg.is_direction_certain for leg in self.legs)

    @property
    def is_first_certain(self) -> bool:
        return self.lead_s is not None and self.lead_s > MIN_LEAD_S

    def sites(self, first_moved: Side) -> dict[str, Site]:
        """Name every sensor's site, given the side of the leg that was lifted first."""
        named = {} if self.pelvis is None else {self.pelvis: Site.PELVIS}
        for side, leg in zip((first_moved, first_moved.other), self.legs, strict=False):
            for segment in LEG_SEGMENTS:
                sensor = getattr(leg, segment.value)
                if sensor is not None:
                    named[sensor] = Site(f"{side}_{segment}")
        return named


def find_chains(tracks: Tracks, standing: Mapping[str, FloatArray] | None = None) -> Chains | None:
    """Arrange 2 to 7 sensors to legs, None without common samples; no `standing`: the motion's mean vertical."""
    return at_once(chains_in_steps(tracks, standing))


def chains_in_steps(
    tracks: Tracks, standing: Mapping[str, FloatArray] | None = None
) -> Generator[None, None, Chains | None]:
    """Arrange sensors as `find_chains` does, in steps; `standing` in m/s2 and sensor axes."""
    if len(tracks) not in USUAL_SITES:
        raise ValueError(f"{len(tracks)} sensors, expected 2 to 7")
    smoothed = yield from smoothed_in_steps(tracks)
    adjacent = (yield from adjacent_in_steps(smoothed, standing or {})) if smoothed else None
    if adjacent is None:
        return None
    arrangements = Arrangements(USUAL_SITES[len(tracks)], adjacent)
    best = arrangements.best()
    arrangement = max(
        arrangements.alike(best), key=lambda one: sum(leg.height_m for leg in statures(one, adjacent).values())
    )
    legs = [
        _chain(side, arrangement, arrangements, adjacent, tracks)
        for side in Side
        if Site(f"{side}_thigh") in arrangement
    ]
    legs.sort(key=lambda leg: np.inf if leg.moved_at_s is None else leg.moved_at_s)
    at_s = [leg.moved_at_s for leg in legs]
    lead_s = None if len(at_s) < 2 or at_s[0] is None or at_s[1] is None else at_s[1] - at_s[0]
    pelvis = adjacent.names[arrangement[Site.PELVIS]] if Site.PELVIS in arrangement else None
    return Chains(tuple(legs), arrangements.margin(best), lead_s, pelvis)


def _chain(
    side: Side, arrangement: Arrangement, arrangements: Arrangements, adjacent: Adjacent, tracks: Tracks
) -> Chain:
    sensors = {site.segment: adjacent.names[sensor] for site, sensor in arrangement.items() if site.side is side}
    has_foot = Segment.FOOT in sensors
    moved = [at_s for name in sensors.values() if (at_s := _lifted_at_s(tracks[name])) is not None]
    return Chain(
        thigh=sensors[Segment.THIGH],
        shank=sensors[Segment.SHANK],
        foot=sensors.get(Segment.FOOT),
        knee_margin=arrangements.margin(arrangement, knee_of(side)),
        ankle_margin=arrangements.margin(arrangement, ankle_of(side)) if has_foot else None,
        stature=statures(arrangement, adjacent)[side],
        moved_at_s=min(moved, default=None),
    )


def _lifted_at_s(stretches: Sequence[OrientedTrack]) -> float | None:
    for track in sorted((one.track for one in stretches), key=lambda track: track.start_s):
        speed = np.linalg.norm(track.gyr_rad_s, axis=1)
        is_lifted = moving_mean(speed, max(1, round(MOVING_WINDOW_S / track.step_s))) > LIFTED_RAD_S
        if is_lifted.any():
            return float(track.time_s[np.argmax(is_lifted)])
    return None
