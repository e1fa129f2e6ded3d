"""What somebody has to answer while the legs move: labels that the motion contradicts, and which leg it is."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal, Slot

from app.wizard.free_motion.side_question import SideQuestion, Words
from app.wizard.worn_corrections import opposite
from core.body import Side

if TYPE_CHECKING:
    from app.wizard.visit import Visit
    from core.placement.chains import Chains


class LabelQuestions(QObject):
    """Knows the visit and no page.

    Signals
    -------
    changed
        Something else is asked, or nothing any more.
    relabelled
        Sensors are worn otherwise than they were stated to be: what the motion has shown was of others.
    leg_named
        Which leg a sensor is on was answered, or that was undone, before the motion has shown the sites.
    """

    changed = Signal()
    relabelled = Signal()
    leg_named = Signal()

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._side = SideQuestion()
        self._sides_reported: dict[str, Side] = {}  # in this visit, by the sensor's name

    @property
    def named(self) -> tuple[str, Side] | None:
        """The sensor and the leg that it was stated to be on; None before, and once that is undone."""
        return self._side.reported

    @property
    def is_in_doubt(self) -> bool:
        """Whether labels are contradicted, and nobody has answered yet."""
        return bool(self._visit.sensors.detected)

    @property
    def is_understood(self) -> bool:
        """Whether `words` say what was understood, which can be undone by the answer 1."""
        return self._side.reported is not None

    @property
    def words(self) -> Words:
        """What is asked of the sides and what can be answered, or what was understood; empty while there is nothing."""
        return self._side.words

    def begin(self) -> None:
        """Another recording begins: nothing is asked yet. What was kept or stated about sensors holds for the visit."""
        self._side = SideQuestion()
        self._visit.sensors.doubt({})

    def ask_for_side(self, chains: "Chains | None") -> None:
        """The motion does not distinguish left from right: both legs began together, or one alone wears sensors."""
        if chains is not None:
            session = self._visit.session
            placed = session.placements[-1].site_of if session is not None and session.placements else {}
            earlier = {name: site.side for name, site in placed.items() if site.side is not None}
            self._side.look(chains, earlier | self._sides_reported)
            self.changed.emit()

    def withdraw(self) -> None:
        """The motion has shown the sites itself."""
        self._side.withdraw()

    @Slot(int)
    def answer(self, number: int) -> None:
        """Take the answer of this number, as `words` offers them."""
        self._side.answer(number)
        self._take_side()
        self.changed.emit()

    def _take_side(self) -> None:
        """Let the motion be that of the leg that was named; what was placed already changes legs."""
        reported, sensors = self._side.reported, self._visit.sensors
        if reported is not None:
            self._sides_reported[reported[0]] = reported[1]
        if not sensors.site_of:
            self.leg_named.emit()
        elif (
            reported is not None
            and reported[0] in sensors.site_of
            and sensors.site_of[reported[0]].side is not reported[1]
        ):
            sensors.assign_all({name: opposite(site) for name, site in sensors.site_of.items()})
            self.relabelled.emit()
