"""Whether a walk can be started; where it cannot, what is missing for one, in a sentence."""

from typing import TYPE_CHECKING

from app.wizard.walking.memory_control import MemoryControl
from app.wizard.walking.timed_chooser import LONGEST_M, SHORTEST_M
from app.wizard.walking.timed_control import TimedControl
from app.wording.translation import figure_text, tr

if TYPE_CHECKING:
    from app.wizard.visit import Visit


class WalkStart:
    """Of the visit as it is at each call."""

    def __init__(self, visit: "Visit", memory: MemoryControl, timed: TimedControl) -> None:
        self._visit, self._memory, self._timed = visit, memory, timed

    @property
    def is_possible(self) -> bool:
        return self._visit.session is not None and not self._visit.recordings.is_recording and not self.missing_now

    @property
    def missing(self) -> str:
        """What is missing for walks at all; empty where nothing is."""
        sensors = self._visit.sensors
        if sensors.acquisition is None:
            return tr("Choose the sensor source first.")
        if self._visit.cannot_record:
            return self._visit.cannot_record
        if not sensors.site_of:
            return tr("Set the sensor positions first.")
        if sensors.are_silent:
            return tr("No signal from any sensor. Switch the sensors on, or move the receiver closer.")
        if self._visit.recordings.must_move:
            return tr("The sensors were reattached. Repeat standing still and free motion first.")
        return ""

    @property
    def missing_now(self) -> str:
        """As `missing`, and what the sensors' memories are missing still."""
        missing = self.missing or self._memory.cannot_start
        if not missing and self._visit.sensors.are_in_memory and self._timed.planned is not None:
            return tr("Timed tests need live data. Choose no test, or record walks live.")
        if not missing and self._timed.is_course_wrong:
            asked = tr("Enter the length of the course in metres, {shortest} to {longest}.")
            return asked.format(shortest=figure_text(SHORTEST_M, "g"), longest=figure_text(LONGEST_M, "g"))
        return missing
