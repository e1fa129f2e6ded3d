"""Both hips as they move: what their sensors feel, the heading that this shows, and the angles."""

from collections.abc import Mapping
from dataclasses import dataclass

from core.body import Joint, Side, Site, hip_of
from core.hip.results import HipIdentification
from core.live.angle import AngleSamples
from core.live.hip import LiveHip
from core.live.hip_heading import HipHeading, HipHeadingState
from core.live.joint_force import LiveJointForce
from core.live.orientation import NOTHING, OrientedSamples, joined
from core.live.sensors import LiveSensor

TOGETHER_S = 0.09  # so much is taken at once: three of a screen's frames, which halves what the angles cost


@dataclass(frozen=True, slots=True)
class HipReported:
    """What is new of one hip; `is_provisional` as of `LiveHip`."""

    samples: AngleSamples
    is_provisional: bool


class LiveHips:
    """The hips of those legs whose thigh wears a sensor, where the pelvis wears one; else none.

    Parameters
    ----------
    found
        Of the hips whose angles are required; headings are followed of all.
    """

    def __init__(
        self, sensors: Mapping[Site, LiveSensor], found: Mapping[Joint, HipIdentification] | None = None
    ) -> None:
        self._steps_s = {site: sensor.step_s for site, sensor in sensors.items()}
        worn = [hip_of(side) for side in Side] if Site.PELVIS in sensors else []
        self._worn = [joint for joint in worn if joint.distal in sensors]
        self._pelvis = LiveJointForce(self._steps_s[Site.PELVIS]) if self._worn else None
        self._thighs = {joint: LiveJointForce(self._steps_s[joint.distal]) for joint in self._worn}
        self._headings = {joint: HipHeading() for joint in self._worn}
        self._angles: dict[Joint, LiveHip] = {}
        self._held: list[Mapping[Site, OrientedSamples]] = []
        self._held_s = 0.0
        self.find(found or {})

    def find(self, found: Mapping[Joint, HipIdentification]) -> None:
        """Show hips that were not known before, and go over to other frames of those that were, without a jump."""
        for joint in (joint for joint in self._worn if joint in found):
            lag_s = found[joint].lag_s
            if lag_s != self._thighs[joint].lag_s:  # what both felt until now was not of the same instants
                self._thighs[joint] = LiveJointForce(self._steps_s[joint.distal], lag_s)
                self._headings[joint] = HipHeading()
            if joint in self._angles:
                self._angles[joint].recalibrate(found[joint])
            else:
                steps_s = self._steps_s[Site.PELVIS], self._steps_s[joint.distal]
                self._angles[joint] = LiveHip(found[joint], *steps_s)
                self._angles[joint].expect([self._headings[joint].state])

    def update(self, turned: Mapping[Site, OrientedSamples]) -> dict[Joint, HipReported]:
        """Take what is new of all sensors; returns what is new of the hips that are shown, now and then nothing."""
        self.follow(turned)
        if not self._angles:
            return {}
        self._held.append(turned)
        self._held_s += max((len(new) * self._steps_s[site] for site, new in turned.items()), default=0.0)
        if self._held_s < TOGETHER_S:
            return {}
        held, self._held, self._held_s = self._held, [], 0.0
        pelvis = joined([new[Site.PELVIS] for new in held if Site.PELVIS in new])
        reported = {}
        for joint, angle in self._angles.items():
            thigh = joined([new[joint.distal] for new in held if joint.distal in new])
            reported[joint] = HipReported(angle.update(pelvis, thigh), angle.is_provisional)
        return reported

    def follow(self, turned: Mapping[Site, OrientedSamples]) -> dict[Joint, HipHeadingState]:
        """Take what is new of all sensors; returns what is known of each hip's heading by now."""
        if self._pelvis is None:
            return {}
        pelvis = self._pelvis.update(turned.get(Site.PELVIS, NOTHING))
        for joint, heading in self._headings.items():
            states = heading.update(pelvis, self._thighs[joint].update(turned.get(joint.distal, NOTHING)))
            if states and joint in self._angles:
                self._angles[joint].expect(states)
        return {joint: heading.state for joint, heading in self._headings.items()}
