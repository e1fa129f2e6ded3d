"""What a walk's curves stand beside: the band, the other leg, another walk of the session or the last visit."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import Enum, auto

from PySide6.QtCore import Qt

from app.summary.agreed import agreed_with
from app.summary.beside import beside_last_visit, beside_walk, walks_alone
from app.summary.comparison import Comparison
from app.summary.conditions import Part
from app.summary.facts import Facts, part_of
from app.summary.request import AnalysedVisit
from app.summary.visits import ComparedVisits
from app.theme.notifier import ThemeNotifier
from app.widgets.choice import Choice
from app.wording.translation import tr

NARROWEST, WIDEST = 186, 320  # px


class Beside(Enum):
    """What the curves stand beside; another walk of the session is chosen by its recording's name."""

    BAND = auto()
    LEGS = auto()  # each other alone
    LAST_VISIT = auto()


class BesideChoice(Choice):
    """The choice, and the comparison that comes of it."""

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__(look, tr("Compare with"))
        self.let_shrink(NARROWEST, WIDEST)  # conditions are typed
        self.keep_whole(tr("Versus reference"), tr("Left and right only"))
        self._visit: AnalysedVisit | None = None
        self._walks: Mapping[str, Part] = {}  # of this session, each alone
        self._shown = ""

    def show_visit(self, visit: AnalysedVisit) -> None:
        """Take the walks of this session; `offer` follows."""
        agreed = agreed_with(visit.session)
        self._visit, self._walks = visit, walks_alone(visit.analysis, visit.session.recordings, agreed)

    def offer(self, shown: str, *, has_visits: bool) -> None:
        """Offer what the recording of this name can stand beside; what was chosen stays, where it can."""
        before, self._shown = self.currentData(), shown
        called = self._visit.shown_names if self._visit is not None else {}
        self.blockSignals(True)
        self.clear()
        self.addItem(tr("Versus reference"), Beside.BAND)
        self.setItemData(0, tr("Reference: inner area 1 SD, outer area 2 SD."), Qt.ItemDataRole.ToolTipRole)
        self.addItem(tr("Left and right only"), Beside.LEGS)
        for name in self._walks if shown in self._walks else ():
            if name != shown:
                self.addItem(tr("Versus {walk}").format(walk=called.get(name, name)), name)
        if has_visits and shown in self._walks:
            self.addItem(tr("Versus last visit"), Beside.LAST_VISIT)
        self.setCurrentIndex(max(self.findData(before), 0))
        self.blockSignals(False)
        self.updateGeometry()

    @property
    def walks(self) -> tuple[str, ...]:
        """The walk that is shown and the one beside it, which stand alone where both are of one condition."""
        chosen = self.currentData()
        return (self._shown, chosen) if isinstance(chosen, str) else ()

    def compared(self, facts: Facts, visits: Sequence[ComparedVisits] | None) -> tuple[Comparison | None, str]:
        """The walk's condition against what was chosen, or why there is nothing to compare it with.

        Parameters
        ----------
        facts
            Of the walk that is shown, beside the chosen one.
        visits
            Those of the patient; None while they are being read.
        """
        chosen, visit = self.currentData(), self._visit
        if visit is None or self._shown not in self._walks:
            return None, ""
        is_simulated, names = visit.analysis.is_simulated, visit.shown_names
        walk = replace(facts.part, name=str(names.get(self._shown, self._shown)))
        if chosen is Beside.LAST_VISIT:
            if visits is None:
                return None, tr("Reading earlier visits.")
            found = beside_last_visit(walk, facts.condition, visits, is_simulated=is_simulated)
            return found, "" if found is not None else tr("No earlier visit has a walk in this condition.")
        if chosen not in self._walks:
            return None, ""
        other = replace(part_of(visit, chosen, self.walks), name=str(names.get(chosen, chosen)))
        return beside_walk(walk, other, is_simulated=is_simulated), ""
