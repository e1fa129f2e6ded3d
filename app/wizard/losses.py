"""Silent sensors, what their silence costs, and which sensor is back.

The words are shown while a walk goes on and in between.
"""

import math
from collections.abc import Mapping, Sequence

from app.wording.body import name_of
from app.wording.translation import capitalised, tr, tr_n
from core.body import Joint, Segment, Side, Site

REPORTED_AFTER_S = 2.0
BACK_REPORTED_S = 6.0
TOGETHER_S = 2.0  # those that a receiver lost come back one after the other

Message = tuple[str, str]
NOTHING: Message = "", ""


class Losses:
    """Given how long each sensor has been silent, it remembers for how long one was that is back."""

    def __init__(self) -> None:
        self._silent_s: dict[Site, float] = {}
        self._worn = 0
        self._back: dict[Site, float] = {}  # for how long those were silent that are back
        self._back_s = -math.inf

    @property
    def silent(self) -> tuple[Site, ...]:
        """Those that have been silent for long enough to be reported."""
        return tuple(site for site in Site if site in self._silent_s)

    def update(self, silent_s: Mapping[Site, float], now_s: float) -> tuple[Site, ...]:
        """Take how long each worn sensor has been silent; returns those that are reported from now on."""
        news = []
        for site, seconds in silent_s.items():
            if seconds >= REPORTED_AFTER_S:
                if site not in self._silent_s:
                    news.append(site)
                self._silent_s[site] = seconds
            elif site in self._silent_s:
                if now_s - self._back_s > TOGETHER_S:
                    self._back = {}
                self._back[site], self._back_s = self._silent_s.pop(site), now_s
        for site in self._silent_s.keys() - silent_s.keys():  # worn no more
            del self._silent_s[site]
        self._worn = len(silent_s)
        return tuple(news)

    def message(self, is_recording: bool, joints: Sequence[Joint], now_s: float) -> Message:
        """Say it, and what it costs of `joints`, those that have a sensor on both sides."""
        if self._silent_s:
            return self._silent_message(is_recording, joints)
        if self._back and is_recording and now_s - self._back_s < BACK_REPORTED_S:
            is_all = 1 < len(self._back) == self._worn
            stated = (
                tr("All sensors: signal back after {seconds:.1f} s.")
                if is_all
                else tr("{sensor}: signal back after {seconds:.1f} s.")
            )
            names = ", ".join(name_of(site) for site in Site if site in self._back)
            what = capitalised(stated.format(sensor=names, seconds=max(self._back.values())))
            then = tr("Strides in between are excluded.")
            return what, tr("Only hip angles are missing in between.") if set(self._back) == {Site.PELVIS} else then
        return NOTHING

    def _silent_message(self, is_recording: bool, joints: Sequence[Joint]) -> Message:
        longest_s = int(max(self._silent_s.values()))
        if 1 < len(self._silent_s) == self._worn:  # it is not the sensors
            what = tr("No signal from any sensor for {seconds} s.").format(seconds=longest_s)
            then = tr(
                "Check that the receiver is plugged in and near the patient, and that the sensors are switched on."
            )
            return what, f"{tr('Recording continues.')} {then}" if is_recording else then
        names = ", ".join(name_of(site) for site in self.silent)
        count = len(self._silent_s)
        if self.silent == (Site.PELVIS,):
            what = tr("Pelvis: no signal for {seconds} s.").format(seconds=longest_s)
            goes_on = tr(
                "Recording continues, including knees and ankles. Hip angles are missing until the signal is back."
            )
            return what, goes_on if is_recording else tr(
                "Switch the pelvis sensor off and on, or continue without hip angles."
            )
        what = tr("{sensor}: no signal for {seconds} s.").format(sensor=names, seconds=longest_s)
        lost = [name_of(joint) for joint in joints if {joint.proximal, joint.distal} & self._silent_s.keys()]
        phases = {Side.LEFT: tr("left gait phases"), Side.RIGHT: tr("right gait phases")}
        feet = [phases[site.leg_side] for site in self.silent if site.segment is Segment.FOOT]
        if is_recording:
            missing = ", ".join([*lost, *feet])
            then = tr("Recording continues. Missing until the signal is back: {missing}.").format(missing=missing)
        elif lost:
            stated = tr_n(
                "Switch the sensor off and on, or continue without these angles: {joints}.",
                "Switch the sensors off and on, or continue without these angles: {joints}.",
                count,
            )
            then = stated.format(joints=", ".join(lost))
        else:
            then = tr_n(
                "Switch the sensor off and on, or continue without it.",
                "Switch the sensors off and on, or continue without them.",
                count,
            )
        return capitalised(what), then
