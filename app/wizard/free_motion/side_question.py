"""Question of which leg it is, where the motion does not show it.

It is asked once; the answer is shown, can be undone, and is held to.
"""

from collections.abc import Mapping

from app.wording.body import side_name
from app.wording.translation import tr
from core.body import Side
from core.placement.chains import Chains

Words = tuple[str, str, tuple[str, ...]]
SILENT: Words = "", "", ()


class SideQuestion:
    """Asks which leg wears a sensor, while both began together or one alone wears sensors.

    `asked`: the sensor that is asked about; None while none is.
    `reported`: the sensor and the side that were understood; None before, and once that is undone.
    """

    def __init__(self) -> None:
        self.asked: str | None = None
        self.reported: tuple[str, Side] | None = None
        self._are_both = False
        self._earlier: dict[str, Side] = {}
        self._contradicted: Side | None = None
        self._is_undone = False

    @property
    def words(self) -> Words:
        """What is on the screen: a question, what was understood, or nothing."""
        if self.asked is not None:
            which = tr("Which leg has {sensor} on the shank?")
            if self._contradicted is not None:
                which = tr("{sensor} was on the {side} leg before. Which leg is it on now?")
            elif self._are_both:
                which = tr("Both legs moved at once. Which leg has {sensor} on the shank?")
            side = "" if self._contradicted is None else side_name(self._contradicted)
            return which.format(sensor=self.asked, side=side), "", (tr("Left"), tr("Right"))
        if self.reported is not None:
            sensor, side = self.reported
            understood = tr("{sensor} is now assigned to the {side} leg.").format(sensor=sensor, side=side_name(side))
            return understood, "", (tr("Undo"),)
        return SILENT

    def look(self, chains: Chains, earlier: Mapping[str, Side]) -> None:
        """Ask, unless one of these legs was asked about or answered. `earlier`: what was stated of sensors before."""
        self._earlier = dict(earlier)
        known = self.asked or (self.reported[0] if self.reported is not None else None)
        if any(known in leg.sensors for leg in chains.legs):
            return
        self.reported, self._contradicted = None, None
        self.asked = chains.legs[0].shank
        self._are_both = chains.lead_s is not None

    def answer(self, number: int) -> None:
        """Take the answer of this number, as `words` offers them; what contradicts an earlier one is asked again."""
        if self.asked is None:
            if self.reported is not None:  # undone
                self.asked, self.reported, self._is_undone = self.reported[0], None, True
            return
        sensor, side = self.asked, (Side.LEFT, Side.RIGHT)[number]
        before = self._earlier.get(sensor, side)
        if before is not side and self._contradicted is None and not self._is_undone:
            self._contradicted = before
            return
        self.asked, self._contradicted, self._is_undone = None, None, False
        self.reported = sensor, side

    def withdraw(self) -> None:
        """Ask no longer, for the motion has shown it itself; an answer that was undone is still required."""
        if not self._is_undone:
            self.asked, self._contradicted = None, None
