"""Estimate how well the free motion shows the joints and whether the labels agree with it.

Where nobody stated the places of the sensors, those are estimated too.
"""

from collections.abc import Generator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from app.acquisition.chain_search import ChainSearch
from app.acquisition.motion_memory import KEPT_S, Looks, MotionMemory, tracks_in_steps
from core.body import Joint, Side, Site
from core.live.free_motion import FreeMotionState, LiveFreeMotion
from core.live.hip_heading import HipHeadingState
from core.live.sensors import LiveSensor
from core.placement.arrangements import joints_between
from core.placement.chains import LIFTED_RAD_S, Chains
from core.placement.labels import detected_in_steps
from core.samples import FloatArray, ImuBlock

LABELS_AFTER_S, LABELS_EVERY_S = 4.0, 2.5  # of motion, before labels are doubted; two looks have to agree
MOVED_S = 5.0  # of each leg
CAUGHT_UP_S = 1.0  # of what was held back, taken in one update


@dataclass(frozen=True, slots=True)
class FreeMotionView:
    """The free motion so far.

    `detected`: by the site that a sensor is stated to be at, the one where the motion puts it, in two looks that agree;
    empty where it contradicts nothing.
    `site_of`: by the sensor's name: as was stated, or as the motion has shown.
    `is_side_open`: the legs are certain, and which is left is not: both began together, or there is only one.
    `name_leg` of `UnplacedFreeMotionEstimator` settles it.
    """

    motion: FreeMotionState = field(default_factory=FreeMotionState)  # empty as long as nobody knows who is where
    elapsed_s: float = 0.0  # since the first sample, or since one leg alone began again
    repeated: Side | None = None  # the leg that is being repeated; the other's joints stay as they were
    detected: Mapping[Site, Site] = field(default_factory=dict)
    site_of: Mapping[str, Site] = field(default_factory=dict)
    chains: Chains | None = None  # what is known of the legs where the placement is left to the motion
    is_side_open: bool = False


class FreeMotionEstimator:
    """The motion of sensors whose sites are known. Their joints are watched leg by leg, so that one can begin again.

    Parameters
    ----------
    live_sensors
        By name. Sensors that are missing here, or in `site_of`, are not worn.
    standing
        Mean specific force (3,) in standing, by name, where it is known: it helps to judge the labels.
    """

    def __init__(
        self,
        site_of: Mapping[str, Site],
        live_sensors: Mapping[str, LiveSensor],
        prosthetic_joints: frozenset[Joint] = frozenset(),
        without_ankle: frozenset[Side] = frozenset(),
        standing: Mapping[str, FloatArray] | None = None,
    ) -> None:
        self._site_of = {name: site for name, site in site_of.items() if name in live_sensors}
        self._sensors = {site: live_sensors[name] for name, site in self._site_of.items()}
        self._prosthetic_joints, self._without_ankle = prosthetic_joints, without_ankle
        sides = [side for side in Side if any(site.side is side for site in self._sensors)]
        self._legs = {side: self._new_leg(side) for side in sides}
        self._states: dict[Side, FreeMotionState] = {}
        self._hips: dict[Joint, HipHeadingState] = {}  # known before their leg was repeated
        self._labels = _LabelCheck(self._sensors, {site_of[k]: v for k, v in (standing or {}).items() if k in site_of})
        self._first_s: float | None = None
        self._now_s = -np.inf
        self._repeated: Side | None = None
        self._wish: Side | None = None  # set by the screen, taken by the estimator
        self.state = FreeMotionView(site_of=self._site_of)

    def repeat(self, side: Side) -> None:
        """Begin this leg again at the next update, and leave the other as it is. From any thread."""
        self._wish = side

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        """Take new samples of some or all sensors; those that are not worn are passed over."""
        wish, self._wish = self._wish, None
        if wish in self._legs:
            self._legs[wish], self._repeated, self._first_s = self._new_leg(wish), wish, None
            before = self._states.pop(wish, FreeMotionState())
            self._hips |= {joint: hip for joint, hip in before.hips.items() if hip.is_sure}
        worn = {self._site_of[name]: block for name, block in blocks.items() if name in self._site_of and len(block)}
        if not worn:
            return
        first_s = min(float(block.time_s[0]) for block in worn.values())
        self._first_s = first_s if self._first_s is None else min(self._first_s, first_s)
        self._now_s = max(self._now_s, *(float(block.time_s[-1]) for block in worn.values()))
        for side, leg in self._legs.items():
            if self._repeated in (None, side):
                self._states[side] = leg.update({s: block for s, block in worn.items() if s.side in (side, None)})
        self._labels.update(worn)
        self.state = FreeMotionView(
            motion=_both(self._states, self._hips),
            elapsed_s=self._now_s - self._first_s,
            repeated=self._repeated,
            detected=self._labels.detected,
            site_of=self._site_of,
        )

    def _new_leg(self, side: Side) -> LiveFreeMotion:
        of_leg = {site: sensor for site, sensor in self._sensors.items() if site.side in (side, None)}
        return LiveFreeMotion(of_leg, self._prosthetic_joints, self._without_ankle)


class UnplacedFreeMotionEstimator:
    """The motion of sensors whose sites it has to show itself: it is held back until it has, and then made up for.

    Where both legs began together, or only one wears sensors, `name_leg` settles what the motion cannot show.

    Parameters
    ----------
    live_sensors
        By name, of all sensors that are worn.
    first_moved
        The leg that the patient was asked to move first; None: not asked.
    """

    def __init__(
        self,
        live_sensors: Mapping[str, LiveSensor],
        first_moved: Side | None,
        prosthetic_joints: frozenset[Joint] = frozenset(),
        without_ankle: frozenset[Side] = frozenset(),
        standing: Mapping[str, FloatArray] | None = None,
    ) -> None:
        self._sensors, self._first_moved, self._standing = live_sensors, first_moved, standing or {}
        self._prosthetic_joints, self._without_ankle = prosthetic_joints, without_ankle
        self._search = ChainSearch(live_sensors, live_sensors, standing)
        self._placed: FreeMotionEstimator | None = None
        self._held: list[dict[str, ImuBlock]] = []
        self._first_s, self._now_s = np.inf, -np.inf
        self._answer: tuple[str, Side] | None = None
        self._wish: Side | None = None
        self.state = FreeMotionView()

    def name_leg(self, reported: tuple[str, Side] | None) -> None:
        """Say which leg a sensor is worn on; it counts once the chains are certain. None: undone. From any thread."""
        self._answer = reported

    def repeat(self, side: Side) -> None:
        """As of `FreeMotionEstimator`; nothing before it is known who is where. From any thread."""
        self._wish = side

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        """Take new samples of some or all sensors; those that are not worn are passed over."""
        worn = {name: block for name, block in blocks.items() if name in self._sensors and len(block)}
        if not worn:
            return
        self._first_s = min(self._first_s, _begin_s(worn))
        self._now_s = max(self._now_s, *(float(block.time_s[-1]) for block in worn.values()))
        self._held.append(worn)
        if self._placed is None:
            self._look(worn)
        state = FreeMotionView() if self._placed is None else self._caught_up(self._placed)
        elapsed_s = self._now_s - self._first_s if state.repeated is None else state.elapsed_s
        is_side_open = self._placed is None and self._search.is_sure
        self.state = replace(state, elapsed_s=elapsed_s, chains=self._search.chains, is_side_open=is_side_open)

    def _caught_up(self, placed: FreeMotionEstimator) -> FreeMotionView:
        """Take a little of what was held back."""
        wish, self._wish = self._wish, None
        if wish is not None:
            self._held = self._held[-1:]  # what was before begins again, or stays as it is
            placed.repeat(wish)
        until_s = _begin_s(self._held[0]) + CAUGHT_UP_S
        while self._held and _begin_s(self._held[0]) < until_s:
            placed.update(self._held.pop(0))
        return placed.state

    def _look(self, worn: Mapping[str, ImuBlock]) -> None:
        """Whether the motion shows by now which sensor is where."""
        while _begin_s(self._held[0]) < self._now_s - KEPT_S and len(self._held) > 1:
            del self._held[0]
        self._search.update(worn)
        site_of = self._reported()
        if site_of:
            self._placed = FreeMotionEstimator(
                site_of, self._sensors, self._prosthetic_joints, self._without_ankle, self._standing
            )

    def _reported(self) -> dict[str, Site]:
        chains = self._search.chains
        if chains is None or not self._search.is_sure:
            return {}
        if self._answer is not None:
            sensor, side = self._answer
            if sensor in chains.legs[0].sensors:
                return chains.sites(side)
            if any(sensor in leg.sensors for leg in chains.legs[1:]):
                return chains.sites(side.other)
            return {}
        if self._first_moved is None or not chains.is_first_certain:  # never of a single leg: it has no other to lead
            return {}
        return chains.sites(self._first_moved)


class _LabelCheck:
    """Looks every LABELS_EVERY_S whether the motion contradicts the labels."""

    def __init__(self, sensors: Mapping[Site, LiveSensor], standing: Mapping[Site, FloatArray]) -> None:
        self._sensors = {str(site): sensor for site, sensor in sensors.items()}
        self._standing = {str(site): force for site, force in standing.items()}
        self._memory = MotionMemory(self._sensors)
        self._looks = Looks(self._memory, self._look, LABELS_EVERY_S, LABELS_AFTER_S)
        self._last: Mapping[Site, Site] = {}
        self.detected: Mapping[Site, Site] = {}

    def update(self, worn: Mapping[Site, ImuBlock]) -> None:
        self._looks.update({str(site): block for site, block in worn.items()})

    def _look(self, at_s: float) -> Generator[None, None, None]:
        blocks = self._memory.between(at_s - KEPT_S, at_s)
        ends = {end for joint in joints_between(tuple(map(Site, blocks))) for end in (joint.proximal, joint.distal)}
        yield
        joined = {site: block for site, block in blocks.items() if Site(site) in ends}
        moved_s = {Site(site).side: 0.0 for site in joined if Site(site) is not Site.PELVIS}
        for site, block in joined.items():
            if Site(site) is Site.PELVIS:  # it sways while the legs move
                continue
            is_moving = np.linalg.norm(block.gyr_rad_s, axis=1) > LIFTED_RAD_S
            seconds = float(np.count_nonzero(is_moving)) * self._sensors[site].step_s
            moved_s[Site(site).side] = max(moved_s[Site(site).side], seconds)
        if min(moved_s.values(), default=0.0) < MOVED_S:  # a leg that rests could belong anywhere
            return
        tracks = yield from tracks_in_steps(joined, self._sensors)
        found = yield from detected_in_steps(tracks, self._standing)
        self.detected = found if found == self._last else {}
        self._last = found


def _both(legs: Mapping[Side, FreeMotionState], known: Mapping[Joint, HipHeadingState]) -> FreeMotionState:
    """The state of both legs together; what was known of a hip holds until it is known again."""
    joints = {joint: state for leg in legs.values() for joint, state in leg.joints.items()}
    lags = {joint: state for leg in legs.values() for joint, state in leg.lags.items()}
    weakest = [leg.weakest for leg in legs.values() if leg.weakest is not None]
    hips = {joint: state for leg in legs.values() for joint, state in leg.hips.items()}
    hips |= {joint: state for joint, state in known.items() if joint in hips and not hips[joint].is_sure}
    return FreeMotionState(joints, lags, max(weakest, key=lambda joint: joints[joint].wanting, default=None), hips)


def _begin_s(worn: Mapping[str, ImuBlock]) -> float:
    return min(float(block.time_s[0]) for block in worn.values())
