"""How well a free motion shows all joints of both legs while it lasts, and what is missing."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from core.body import LEG_JOINTS, Joint, Side, Site
from core.live.excitation import HUMAN, PROSTHESIS, Excitation, ExcitationState
from core.live.hip_heading import HipHeadingState
from core.live.hips import LiveHips
from core.live.lag import LagState, LiveLag
from core.live.orientation import NOTHING, OrientedSamples, joined
from core.live.pairing import MAX_WAIT_S
from core.live.sensors import LiveSensor, LiveSensors
from core.samples import ImuBlock

LOOK_S = 5.0  # how often a lag is looked for


@dataclass(frozen=True, slots=True)
class FreeMotionState:
    """Excitation and lag of every joint whose two sensors are worn; a lag appears once it has been looked for.

    `weakest`: the joint whose `missing` motion helps most now; None when all are as good as they get.
    `hips`: what is known of the heading of each hip whose sensors are worn. Walking shows it as well, so nothing waits
    for it.
    """

    joints: Mapping[Joint, ExcitationState] = field(default_factory=dict)
    lags: Mapping[Joint, LagState] = field(default_factory=dict)
    weakest: Joint | None = None
    hips: Mapping[Joint, HipHeadingState] = field(default_factory=dict)

    @property
    def is_done(self) -> bool:
        """Whether every knee and ankle is closed, or as good as this motion gives."""
        return bool(self.joints) and self.weakest is None


class LiveFreeMotion:
    """Both legs while they are moved freely, block by block; of any size, and in any order of sites.

    Parameters
    ----------
    prosthetic_joints
        Those that can be had more exactly, and are asked for.
    without_ankle
        Sides whose prosthetic foot has no ankle joint: nothing can show it, and nothing asks for it.
    """

    def __init__(
        self,
        sensors: Mapping[Site, LiveSensor],
        prosthetic_joints: frozenset[Joint] = frozenset(),
        without_ankle: frozenset[Side] = frozenset(),
    ) -> None:
        self._sensors = LiveSensors(sensors)
        worn = [joint for joint in LEG_JOINTS if joint.proximal in sensors and joint.distal in sensors]
        asked = [joint for joint in worn if joint.is_knee or joint.side not in without_ankle]
        self._joints = {
            joint: _JointMotion(
                Excitation(joint, PROSTHESIS if joint in prosthetic_joints else HUMAN),
                LiveLag(sensors[joint.proximal].step_s, sensors[joint.distal].step_s),
                LEG_JOINTS.index(joint) * LOOK_S / len(LEG_JOINTS),
            )
            for joint in asked
        }
        self._hips = LiveHips(sensors)

    def update(self, blocks: Mapping[Site, ImuBlock]) -> FreeMotionState:
        """Take new samples of some or all sites; KeyError for a site not announced."""
        turned = self._sensors.update(blocks)
        for joint, motion in self._joints.items():
            motion.update(turned.get(joint.proximal, NOTHING), turned.get(joint.distal, NOTHING))
        joints = {joint: motion.excitation.state for joint, motion in self._joints.items()}
        lags = {joint: motion.lag for joint, motion in self._joints.items() if motion.lag is not None}
        is_open = [joint for joint, state in joints.items() if not (state.is_closed or state.is_plateau)]
        weakest = max(is_open, key=lambda joint: joints[joint].wanting, default=None)
        return FreeMotionState(joints, lags, weakest, self._hips.follow(turned))

    @property
    def late(self) -> dict[Site, int]:
        """Samples of each site that came too late, or twice, and were dropped."""
        return self._sensors.late


class _JointMotion:
    """One joint's excitation and lag, looked for `later_s` after both sensors passed a multiple of LOOK_S."""

    def __init__(self, excitation: Excitation, lag: LiveLag, later_s: float) -> None:
        self.excitation = excitation
        self._later_s = later_s
        self.lag: LagState | None = None
        self._lag = lag
        self._one, self._two = NOTHING, NOTHING
        self._next_look_s: float | None = None

    def update(self, proximal: OrientedSamples, distal: OrientedSamples) -> None:
        if not len(proximal) and not len(distal):
            return
        if self._next_look_s is None and len(proximal):
            since_s = float(proximal.time_s[0]) - self._later_s
            self._next_look_s = LOOK_S * (np.floor(since_s / LOOK_S) + 1) + self._later_s
        self._one, self._two = joined([self._one, proximal]), joined([self._two, distal])
        while self._next_look_s is not None:
            one, self._one = _cut(self._one, self._next_look_s)
            two, self._two = _cut(self._two, self._next_look_s)
            self.excitation.update(one, two)
            self._lag.feed(one, two)
            waits_s = max((held.time_s[-1] - held.time_s[0] for held in (self._one, self._two) if len(held)), default=0)
            if not (len(self._one) and len(self._two)) and waits_s < MAX_WAIT_S:
                return
            self._next_look_s += LOOK_S
            heading_rad = self.excitation.heading_rad
            found = None if heading_rad is None else self._lag.look(heading_rad)
            self.lag = found or self.lag


def _cut(samples: OrientedSamples, at_s: float) -> tuple[OrientedSamples, OrientedSamples]:
    if not len(samples) or samples.time_s[-1] < at_s:
        return samples, NOTHING
    first = int(np.searchsorted(samples.time_s, at_s))
    return samples.part(slice(0, first)), samples.part(slice(first, None))
