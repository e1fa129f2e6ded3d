"""Parts of every step of the wizard: a page, a row in the rail, a bar of actions, and what keys do meanwhile."""

from enum import Enum, auto
from typing import TYPE_CHECKING, ClassVar

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from app.widgets.action_bar import BarState
from app.widgets.rail_row import StepState
from app.wizard.keys import Intent

if TYPE_CHECKING:
    from app.wizard.visit import Visit


class StepId(Enum):
    """The steps in their order; the value is the number that goes there with Ctrl."""

    PATIENT = auto()
    SENSORS = auto()
    STAND_STILL = auto()
    FREE_MOTION = auto()
    WALKING = auto()
    RESULTS = auto()
    REPORT = auto()


class Step(QObject):
    """Made once per visit; its page once it is entered, and shown the visit as it is whenever that happens.

    `reported`: what happened, and what follows or what to do: for the banner. Empty: the last word no longer holds.
    """

    id: ClassVar[StepId]

    changed = Signal()  # the bar, or the step's row in the rail, is another one now
    done = Signal()  # nothing is left to do here: the wizard goes on to the next step
    jumped = Signal(object)  # another step, by its StepId, is where to go on
    reported = Signal(str, str)
    offered = Signal(str)  # something was done that can be undone: what, for the toast; `undo` takes it back
    demonstration_required = Signal()  # a visit of the demonstration's patient is to begin in place of this one

    def __init__(self, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._visit = visit

    @property
    def page(self) -> QWidget:
        """Made at the first call: the window must not wait for pages that nobody has come to."""
        raise NotImplementedError

    @property
    def title(self) -> str:
        """Its name in the rail."""
        raise NotImplementedError

    @property
    def note(self) -> str:
        """What came of it, under the name; empty while nothing has."""
        return ""

    @property
    def state(self) -> StepState:
        """DONE, TODO, ATTENTION or SKIPPED; that it is the current one the wizard knows itself."""
        raise NotImplementedError

    @property
    def cannot_enter(self) -> str:
        """Why it cannot be entered yet, in a sentence; empty where it can."""
        return ""

    @property
    def cannot_leave(self) -> str:
        """Why it cannot be left now, in two sentences at most; empty where it can."""
        return ""

    @property
    def folds_sensors(self) -> bool:
        """Whether the page needs the room of the sensors' tiles now."""
        return False

    @property
    def takes_clicker(self) -> bool:
        """Whether every key of a presenter's clicker is to mean what Space does, for as long as this holds."""
        return False

    @property
    def topic(self) -> str:
        """The page of the manual that F1 opens."""
        raise NotImplementedError

    def prepare(self) -> bool:
        """Build the next slow part of the page in advance, and give whether there was one."""
        return False

    def enter(self) -> None:
        """It comes into sight: show the visit as it is, begin what begins by itself."""

    def leave(self) -> None:
        """It goes out of sight: end what must not go on unseen."""

    def tick(self) -> None:
        """Called 30 times a second while it is in sight: show what is live."""

    def bar(self) -> BarState:
        """What can be done now: each action names what it does, and does it."""
        raise NotImplementedError

    def on_intent(self, intent: Intent) -> bool:
        """A key that the frame does not know what to do with; returns whether it meant something here."""
        return False

    def undo(self) -> None:
        """Take back what was offered last."""
