"""Which sensors are silent, what does that cost, and which is back? In words, while a walk goes on and in between."""

from collections.abc import Mapping, Sequence

from app.wording import name_of, tr
from core.body import Joint, Segment, Side, Site

TOLD_AFTER_S = 2.0
BACK_TOLD_S = 6.0

Message = tuple[str, str]
NOTHING: Message = "", ""


class Losses:
    """Told how long each sensor has been silent, it remembers for how long one was that is back."""

    def __init__(self) -> None:
        self._silent_s: dict[Site, float] = {}
        self._back: tuple[Site, float, float] | None = None

    @property
    def silent(self) -> tuple[Site, ...]:
        """Those that have been silent for long enough to be told."""
        return tuple(site for site in Site if site in self._silent_s)

    def update(self, silent_s: Mapping[Site, float], now_s: float) -> tuple[Site, ...]:
        """Take how long each worn sensor has been silent; returns those that are told from now on."""
        news = []
        for site, seconds in silent_s.items():
            if seconds >= TOLD_AFTER_S:
                if site not in self._silent_s:
                    news.append(site)
                self._silent_s[site] = seconds
            elif site in self._silent_s:
                self._back = site, self._silent_s.pop(site), now_s
        for site in self._silent_s.keys() - silent_s.keys():  # worn no more
            del self._silent_s[site]
        return tuple(news)

    def message(self, is_recording: bool, joints: Sequence[Joint], now_s: float) -> Message:
        """Say it, and what it costs of `joints`, those that have a sensor on both sides."""
        if self._silent_s:
            return self._silent_message(is_recording, joints)
        if self._back is not None and is_recording and now_s - self._back[2] < BACK_TOLD_S:
            site, seconds, _ = self._back
            what = tr("{sensor} is back after {seconds:.1f} s.").format(sensor=name_of(site), seconds=seconds)
            return what, tr("The strides in between are left out.")
        return NOTHING

    def _silent_message(self, is_recording: bool, joints: Sequence[Joint]) -> Message:
        longest_s = int(max(self._silent_s.values()))
        names = ", ".join(name_of(site) for site in self.silent)
        said = tr("{sensor} has been silent for {seconds} s.")
        if len(self._silent_s) > 1:
            said = tr("{sensor} have been silent for {seconds} s.")
        lost = [name_of(joint) for joint in joints if {joint.proximal, joint.distal} & self._silent_s.keys()]
        phases = {Side.LEFT: tr("left phases"), Side.RIGHT: tr("right phases")}
        feet = [phases[site.side] for site in self.silent if site.segment is Segment.FOOT]
        if is_recording:
            missing = ", ".join([*lost, *feet])
            then = tr("Recording goes on. Missing until it is back: {missing}.").format(missing=missing)
        elif lost:
            then = tr("Switch it off and on, or go on without these angles: {joints}.").format(joints=", ".join(lost))
        else:
            then = tr("Switch it off and on, or go on without it.")
        return said.format(sensor=names, seconds=longest_s), then
