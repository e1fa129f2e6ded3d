"""What is drawn thin beside a walk's curves: its condition at an earlier visit, another walk, or nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import Enum, auto

from app.summary.agreed import agreed_with
from app.summary.beside import beside_visit, beside_walk, walks_alone
from app.summary.comparison import Comparison
from app.summary.conditions import Part
from app.summary.facts import Facts, part_of
from app.summary.headline import Headline, Rule
from app.summary.request import AnalysedVisit
from app.summary.trend_lines import walked_visits
from app.summary.visits import ComparedVisits
from app.widgets.choice import Choice
from app.wording.dates import day_in_words
from app.wording.translation import tr

NARROWEST, WIDEST = 150, 260  # px


class ThinLine(Enum):
    """Which visit; another walk of the session is chosen by its recording's name."""

    NOTHING = auto()
    LAST_VISIT = auto()
    FIRST_VISIT = auto()

    @property
    def is_visit(self) -> bool:
        return self is not ThinLine.NOTHING


class ThinLineChoice(Choice):
    """The choice, and the comparison that its curves come from."""

    def __init__(self) -> None:
        super().__init__(tr("Thin line"))
        self.let_shrink(NARROWEST, WIDEST)  # conditions are typed
        self._visit: AnalysedVisit | None = None
        self._walks: Mapping[str, Part] = {}  # of this session, each alone
        self._shown = ""
        self._is_own = False  # somebody chose
        self._taken: ThinLine | str | None = None  # what `turn` took away
        self.currentIndexChanged.connect(self._on_chosen)  # what `offer` sets is not notified

    def show_visit(self, visit: AnalysedVisit) -> None:
        """Take the walks of this session; `offer_beside` follows."""
        agreed = agreed_with(visit.session)
        self._visit, self._walks = visit, walks_alone(visit.analysis, visit.session.recordings, agreed)
        self._is_own, self._taken = False, None

    def offer_beside(self, facts: Facts, headline: Headline) -> None:
        """Offer what the walk of these facts can stand beside; unless somebody chose, the headline's visit is drawn."""
        before, self._shown = self.currentData(), facts.walk.name
        called = self._visit.shown_names if self._visit is not None else {}
        walked = walked_visits(facts.course, facts.condition)
        days = [visit.day for visit in walked]
        lines: list[tuple[str, object]] = []
        if len(walked) > 1:
            lines.append((tr("Last visit, {day}").format(day=day_in_words(days[-2], days)), ThinLine.LAST_VISIT))
        if len(walked) > 2:
            lines.append((tr("First visit, {day}").format(day=day_in_words(days[0], days)), ThinLine.FIRST_VISIT))
        lines += [(str(called.get(name, name)), name) for name in self._walks if name != self._shown]
        lines.append((tr("No thin line"), ThinLine.NOTHING))
        proposed = ThinLine.FIRST_VISIT if headline.rule is Rule.SINCE_FIRST else ThinLine.LAST_VISIT
        self.offer(lines, before if self._is_own else proposed, len(lines) - 1)
        self.setVisible(self.count() > 1)

    def turn(self) -> None:
        """Take the line away, or draw that again which was taken, else the first that there is."""
        chosen = self.currentData()
        if chosen is not ThinLine.NOTHING:
            self._taken = chosen
            self.setCurrentIndex(self.findData(ThinLine.NOTHING))
        else:
            self.setCurrentIndex(max(self.findData(self._taken), 0))

    @property
    def walks(self) -> tuple[str, ...]:
        """The walk that is shown and the one beside it, which stand alone where both are of one condition."""
        chosen = self.currentData()
        return (self._shown, chosen) if isinstance(chosen, str) else ()

    def compared(self, facts: Facts, visits: Sequence[ComparedVisits] | None) -> tuple[Comparison | None, str]:
        """Give the walk's condition with the choice, or why there is no thin line; `visits` None: being read."""
        chosen, visit = self.currentData(), self._visit
        if visit is None or self._shown not in self._walks or chosen in (None, ThinLine.NOTHING):
            return None, ""
        is_simulated, names = visit.analysis.is_simulated, visit.shown_names
        walk = replace(facts.part, name=str(names.get(self._shown, self._shown)))
        if isinstance(chosen, ThinLine):
            if visits is None:
                return None, ""  # it comes in a moment
            is_first = chosen is ThinLine.FIRST_VISIT
            found = beside_visit(walk, facts.condition, visits, is_first=is_first, is_simulated=is_simulated)
            return found, "" if found is not None else tr("The earlier visit has no curve in this condition.")
        other = replace(part_of(visit, chosen, self.walks), name=str(names.get(chosen, chosen)))
        return beside_walk(walk, other, is_simulated=is_simulated), ""

    def _on_chosen(self, _index: int) -> None:
        self._is_own = True
