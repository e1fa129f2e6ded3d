"""Differences that left the measurement error. Walks, visits or legs on the same axes, and their differences."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QApplication, QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.charts.cycles import Band, SideCycle
from app.plots.compared_chart import ComparedChart, ComparedFrame
from app.plots.cycle_charts import CycleCharts
from app.results.compared_card import ComparedCard
from app.results.compared_words import (
    conclusion,
    days_of,
    error_in_words,
    not_reported_in_words,
    part_in_words,
    sentence,
    side_sentence,
    side_weight,
    weight_in,
)
from app.summary.comparison import Comparison, Contrast, SideRow, compare_sides, first_and_second
from app.summary.conditions import Part, left_out_of_parts
from app.summary.reference_bands import NOBODY, bands_of, reference_curves, sides_with_band
from app.summary.visits import ComparedVisits, condition_in_words
from app.theme.current import on_theme, scaled
from app.theme.icons import Icon
from app.widgets.chips import Chips
from app.widgets.choice import Choice
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import scrolled
from app.widgets.segmented import Segmented
from app.widgets.text import Text
from app.wording.numbers import MINUS
from app.wording.translation import later, tr
from core.body import JointKind, Side
from core.gait.cycles import POINTS
from core.results import Analysis
from core.verdicts.norms import AgeAndHeight, ReferenceCurves

CURVES, PLOT, TABLE = "curves", "plot", "table"
MOST_WITH_STRIDES = 3  # visits whose strides are counted beside their day
KINDS = (200, 360)  # px: the narrowest and the widest that the box becomes
OTHER_ZERO = later(
    "No common standing reference: compare range of motion and curve shape, not absolute angles. "
    "Here, 0° is the mean angle over the gait cycle."
)
NO_COMMON_CONDITION = later(
    "This visit shares no condition with an earlier visit, so the visits are not compared. "
    "{walked} To compare any two visits or conditions, choose “Any visits and conditions”."
)
NOTHING = {
    Contrast.CONDITIONS: later("Only one walk has strides. Record a second walk to compare."),
    Contrast.VISITS: later("No earlier visit of this patient has a walk to compare."),
    Contrast.SIDES: later("Only one leg was measured, so the legs cannot be compared."),
    Contrast.CHOSEN: later("No earlier visit of this patient has a walk to compare."),
}


class ComparePage(QWidget):
    """`kinds` and `bases` are placed by the page around it, where room is short `view` is as well."""

    visits_requested = Signal()  # the earlier visits are requested, and not known yet: `show_visits` is to follow

    def __init__(self) -> None:
        super().__init__()
        self._conditions: tuple[Part, ...] = ()
        self._visits: tuple[ComparedVisits, ...] | None = None
        self._every: tuple[Part, ...] = ()  # each condition of each visit
        self._walked = ""  # under which conditions each visit was
        self._affected: Side | None = None
        self._affected_words = ""
        self._analysis: Analysis | None = None
        self._who = NOBODY
        self._chosen: tuple[str, ...] = ()  # letters, before the last was turned
        self._pressed = ""  # the letter that was asked for last
        self._has_visits = self._is_simulated = self._is_compact = self._is_spacious = self._has_two_charts = False
        self._has_view, self._is_reading = True, False
        self.comparison: Comparison | None = None
        self.side_rows: tuple[SideRow, ...] = ()
        self.kinds = Choice(tr("Compare"))
        self.kinds.let_shrink(*KINDS)  # a condition that was typed is part of its lines
        self.bases = Choice(tr("Starting point"))
        self.view = Segmented(
            tr("View"), [(CURVES, tr("Curves"), ""), (PLOT, tr("Differences"), ""), (TABLE, tr("Table"), "")]
        )
        self.chips = Chips(tr("Compared items"), [("", " ")])
        self.nothing = Text(size=16, wraps=True)
        self.frames: dict[tuple[Side, JointKind], ComparedFrame] = {}
        for kind in JointKind:
            for side in Side:
                self.frames[side, kind] = ComparedFrame(ComparedChart(kind), side, kind)
        self.side_charts = CycleCharts(reference_curves())
        self._mark = IconMark(Icon.DIFFERENCE, size=20)
        self.conclusion = Text(size=14, wraps=True)
        self.error = Text(size=12, tone="ink2", wraps=True)
        self.card = ComparedCard()
        self._build()
        self._connect()

    # what is shown

    def show_conditions(
        self, analysis: Analysis, parts: Sequence[Part], is_prosthetic: bool, who: AgeAndHeight
    ) -> None:
        """Show the walks of one session, `who` walked them; what was known of other visits is forgotten."""
        self._conditions, self._visits, self._every = tuple(parts), None, ()
        self._is_reading = False  # what was asked for may have been refused
        self._analysis, self._who = analysis, who
        affected = analysis.affected_side
        self._affected, self._is_simulated = affected, analysis.is_simulated
        self._affected_words = tr("Left vs right")
        if affected is not None:
            stated = tr("Prosthetic vs sound side") if is_prosthetic else tr("Affected vs sound side")
            self._affected_words = stated
        self._offer_kinds()

    @property
    def has_visits(self) -> bool:
        """Whether earlier visits are offered."""
        return self._has_visits

    def set_has_visits(self, has_visits: bool) -> None:
        """Offer earlier visits, which `visits_requested` asks for."""
        self._has_visits = has_visits
        self._offer_kinds()

    @property
    def visits(self) -> tuple[ComparedVisits, ...] | None:
        """The conditions shared with earlier visits; None until these were read."""
        return self._visits

    def wish_visits(self) -> None:
        """Ask for the earlier visits, if nobody did."""
        if self._visits is None and not self._is_reading:
            self._is_reading = True
            self.visits_requested.emit()

    def show_visits(self, visits: Sequence[ComparedVisits], walked: str = "", every: Sequence[Part] = ()) -> None:
        """Show the conditions that visits up to this one share; `every`: all of all visits, free to choose."""
        self._visits, self._walked, self._is_reading = tuple(visits), walked, False
        self._every = tuple(every)
        self._offer_kinds()

    def set_band_shown(self, is_shown: bool) -> None:
        for frame in self.frames.values():
            frame.chart.has_band = is_shown
            frame.chart.redraw()
        self.side_charts.set_band_shown(is_shown)

    def set_room(self, is_compact: bool, is_spacious: bool, has_two_charts: bool, *, has_view: bool) -> None:
        """Split curves and differences if short of room; without `has_view` the owner places the choice."""
        was_compact, was_spacious = self._is_compact, self._is_spacious
        self._is_compact, self._is_spacious, self._has_view = is_compact, is_spacious, has_view
        self.view.set_offered(CURVES, is_compact)
        self._has_two_charts = has_two_charts
        self._fit_side_charts()
        if is_compact != was_compact:
            self.view.choose(CURVES if is_compact else PLOT)
        self.card.set_room(is_compact, is_spacious)
        if (is_compact, is_spacious) != (was_compact, was_spacious):
            self._show()  # with more rows and columns
        self._show_parts()

    @property
    def kind(self) -> Contrast:
        return Contrast((self.kinds.currentData() or Contrast.CONDITIONS).split()[0])

    @property
    def _of_visits(self) -> ComparedVisits | None:
        """The condition whose visits are compared."""
        number = self.kinds.currentIndex() - self.kinds.findData(Contrast.VISITS)
        return self._visits[number] if self._visits and self.kind is Contrast.VISITS else None

    @property
    def tab_order(self) -> list[QWidget]:
        card = self.card
        return [self.kinds, self.bases, *self.view.segments, *self.chips.buttons, card.all_measures, card.table]

    # how it is laid out

    def _build(self) -> None:
        room, self._charts, self._words = QWidget(), QWidget(), QWidget()
        grid = QGridLayout(room)
        grid.setContentsMargins(0, 0, 0, 0)
        scaled(grid.setSpacing, 12)
        for (side, kind), frame in self.frames.items():
            grid.addWidget(frame, list(JointKind).index(kind), 0 if side is Side.LEFT else 1)
        self._curves = scrolled(room, is_upright=False)
        charts = ((self._curves, 1), (self.side_charts, 1), self.chips)
        self._left = lay_out(QVBoxLayout(self._charts), *charts, margins=0, spacing=12)
        reported = lay_out(QVBoxLayout(), self.conclusion, self.error, 1, spacing=4)
        mark = self._mark, 0, Qt.AlignmentFlag.AlignTop
        self._head = lay_out(QHBoxLayout(self._words), mark, (reported, 1), margins=0, spacing=12)
        columns = lay_out(QHBoxLayout(), (self._charts, 1), self.card, spacing=12)
        self._page = lay_out(QVBoxLayout(self), self.nothing, (columns, 1), margins=0, spacing=12)
        on_theme(self._fit_card)

    def _connect(self) -> None:
        self.kinds.currentIndexChanged.connect(self._on_kind_changed)
        self.bases.currentIndexChanged.connect(self._show)
        self.view.chosen.connect(self._show_parts)
        for digit in range(1, 10):
            for keys, is_second in ((f"{digit}", False), (f"Shift+{digit}", True)):  # asleep while the page is hidden
                shortcut = QShortcut(QKeySequence(keys), self)
                shortcut.activated.connect(partial(self.choose_pair, digit - 1, is_second=is_second))

    def _place_words(self) -> None:
        """Put the message over all of the page, or, where that is low, into the card, which scrolls."""
        if self._is_compact:
            self.card.begin_with(self._words)
        else:
            self._page.insertWidget(1, self._words)
        if self._has_view and self._is_compact:
            self._page.insertWidget(1, self.view, 0, Qt.AlignmentFlag.AlignLeft)
        elif self._has_view:
            self._head.addWidget(self.view, 0, Qt.AlignmentFlag.AlignTop)
        for part in (self, self._words):
            hear_as_laid_out(part)

    def _show_parts(self) -> None:
        self._place_words()
        view, has_any = self.view.choice, not self.nothing.text()
        is_alone = self._is_compact or (view == TABLE and not self._is_spacious)  # the table takes all the width
        has_both = self._is_spacious and self.kind is not Contrast.VISITS  # the table of visits draws them itself
        has_curves = has_any and (not is_alone or view == CURVES)
        has_card = has_any and (not self._is_compact or view != CURVES)
        self.nothing.setVisible(not has_any)
        self._charts.setVisible(has_curves)
        for widget in (self._words, self.card):
            widget.setVisible(has_card)
        self.view.setVisible(has_any and not has_both)
        is_sides = self.kind is Contrast.SIDES
        self._curves.setVisible(not is_sides)
        self.side_charts.setVisible(is_sides)
        self.chips.setVisible(not is_sides)
        self.card.show_parts(
            has_plot=view != TABLE or has_both,
            has_table=view == TABLE or has_both,
            is_alone=self._charts.isHidden(),
        )

    # what is compared

    def _offer_kinds(self) -> None:
        before = self.kinds.currentData()
        kinds: list[tuple[str, object]] = [(tr("Walks of this visit"), Contrast.CONDITIONS)]
        if self._has_visits and not self._visits:
            kinds.append((tr("Visits"), Contrast.VISITS))
        for number, visits in enumerate(self._visits or ()):  # the first keeps the data of them all
            stated = tr("Visits, {condition}").format(condition=condition_in_words(visits.condition))
            kinds.append((stated, f"{Contrast.VISITS} {number}" if number else Contrast.VISITS))
        if len(self._every) > 1:
            kinds.append((tr("Any visits and conditions"), Contrast.CHOSEN))
        kinds.append((self._affected_words, Contrast.SIDES))
        first = Contrast.CONDITIONS if len(self._conditions) > 1 else Contrast.SIDES
        self.kinds.offer(kinds, before if before is not None else first)
        self._on_kind_changed()

    def _on_kind_changed(self) -> None:
        if self.kind is Contrast.VISITS:
            self.wish_visits()
        parts = self._parts()
        self._make_chips(parts)
        self._offer_bases(parts)
        self._show()

    def _parts(self) -> tuple[Part, ...]:
        if self.kind is Contrast.VISITS:
            return self._of_visits.parts if self._of_visits is not None else ()
        return self._every if self.kind is Contrast.CHOSEN else self._conditions

    def _make_chips(self, parts: Sequence[Part]) -> None:
        chips = Chips(tr("Compared items"), self._words_of(parts) or [("", " ")])
        ends = [*parts[:1], *parts[-1:]]  # of many, the oldest and the latest to begin with
        chips.choose([part.letter for part in (ends if self.kind is Contrast.CHOSEN else parts)])
        chips.turned.connect(self._on_turned)
        self._left.replaceWidget(self.chips, chips)
        self.chips.hide()
        self.chips.deleteLater()
        self.chips, self._chosen, self._pressed = chips, chips.chosen, ""

    def _words_of(self, parts: Sequence[Part]) -> list[tuple[str, str]]:
        """Visits by their day; of many without their strides, so that the curves keep their room."""
        if self.kind is not Contrast.VISITS:
            return [(part.letter, part_in_words(part, part.name)) for part in parts]
        is_few = len(parts) <= MOST_WITH_STRIDES
        return [
            (part.letter, part_in_words(part, day) if is_few else f"{part.letter} {day}")
            for part, day in zip(parts, days_of(parts), strict=True)
        ]

    def _offer_bases(self, parts: Sequence[Part]) -> None:
        pattern = tr("Walk: {letter}") if self.kind is Contrast.SIDES else tr("Starting point: {letter}")
        shown = [part for part in parts if self.kind is Contrast.SIDES or part.letter in self.chips.chosen]
        last = len(shown) - 1 if self.kind is Contrast.SIDES else 0
        lines = [(pattern.format(letter=part.letter), part.letter) for part in shown]
        self.bases.offer(lines, self.bases.currentData(), last)
        self.bases.setEnabled(len(shown) > 1)

    def _on_turned(self) -> None:
        before, self._chosen = self._chosen, self.chips.chosen
        turned = set(before) ^ set(self._chosen)
        if turned and QApplication.keyboardModifiers() & Qt.KeyboardModifier.ShiftModifier:
            letters = [part.letter for part in self._parts()]
            self.choose_pair(letters.index(turned.pop()), is_second=True)
            return
        self._offer_bases(self._parts())
        self._show()

    def choose_pair(self, number: int, *, is_second: bool) -> None:
        """Show part `number` (from 0) beside its base, or the first; `is_second`: as base of the part shown."""
        parts = self._parts()
        if self.kind is Contrast.SIDES or not 0 <= number < len(parts) or len(parts) < 2:
            return
        part = parts[number]
        if is_second:
            shown = next((one for one in parts if one.letter == self._pressed and one is not part), None)
            against, part = part, shown or next(one for one in reversed(parts) if one is not part)
        else:
            against = Comparison(self.kind, parts).base_of(part)
            against = against if against is not part else parts[1 if number == 0 else 0]
        self._pressed = part.letter
        self.chips.choose([part.letter, against.letter])
        self._chosen = self.chips.chosen
        self._offer_bases(parts)
        self.bases.setCurrentIndex(self.bases.findData(against.letter))
        self._show()

    def _show(self) -> None:
        self.nothing.setText(self._why_nothing())
        if not self.nothing.text():
            if self.kind is Contrast.SIDES:
                self._show_sides()
            else:
                self._show_comparison()
        self._show_parts()

    def _why_nothing(self) -> str:
        if self.kind is Contrast.VISITS and self._visits is None:
            return tr("Reading earlier visits.")
        parts = self._parts()
        if self.kind is Contrast.SIDES:
            return "" if any(len(part.sides) > 1 for part in parts) else tr(NOTHING[Contrast.SIDES])
        if self.kind is Contrast.VISITS and not parts and self._walked:
            return tr(NO_COMMON_CONDITION).format(walked=self._walked)
        return tr(NOTHING[self.kind]) if len(parts) < 2 else ""

    def _show_comparison(self) -> None:
        chosen = tuple(part for part in self._parts() if part.letter in self.chips.chosen) or self._parts()[:1]
        base = next((k for k, part in enumerate(chosen) if part.letter == self.bases.currentData()), 0)
        self.comparison = found = Comparison(self.kind, chosen, base, self._is_simulated)
        self.side_rows = ()
        curves, sides = self._band(found.against)
        has_hips = any(joint.is_hip for joint in found.joints)
        for (side, kind), frame in self.frames.items():
            joint = kind.of(side)
            worn = [part for part in chosen if joint in part.joints]
            is_about_mean = not all(
                part.verdicts.joint(joint).height.is_reported for part in worn if part.is_drawn(joint)
            )
            is_about_mean |= len(worn) > 1 and not found.has_one_zero(joint)
            drawn = [part.curve(joint, is_about_mean=is_about_mean) for part in worn]
            is_beside_band = curves is not None and side in sides
            frame.chart.band = Band(*curves.mean_and_sd_deg(kind)) if curves is not None and is_beside_band else None
            notes = [tr(OTHER_ZERO)] if is_about_mean else []
            notes += [not_reported_in_words(part, joint) for part in worn if not part.is_drawn(joint)]
            frame.show_curves(drawn, " ".join(notes), self._is_simulated, is_about_mean=is_about_mean)
            frame.setVisible(side in found.sides and (kind is not JointKind.HIP or has_hips))
        visits = self._of_visits
        pattern = tr("Change from {letter}") if visits is None else tr("Change from {letter}, {condition}")
        condition = "" if visits is None else condition_in_words(visits.condition)
        title = pattern.format(letter=found.against.letter, condition=condition)
        reported = [row for row in found.changes if row.is_reported]
        self.error.setText(error_in_words([row.difference for row in reported]))
        worth = [sentence(row) for row in sorted(reported, key=weight_in(found)) if row.difference.is_worth_a_sentence]
        latest = found.latest if self.kind is Contrast.VISITS else None
        stated = conclusion(worth, reported, latest) if found.others else []
        if visits is not None and visits.without:
            without = tr("Not compared, as they have no walk in this condition: {visits}.")
            stated.append(without.format(visits=", ".join(visits.without)))
        self._say(stated, chosen, is_marked=bool(worth))
        self.card.show_comparison(found, title, self.conclusion.text())

    def _show_sides(self) -> None:
        parts = [part for part in self._conditions if part.letter == self.bases.currentData()] or [self._conditions[-1]]
        part = parts[0]
        first, second = first_and_second(self._affected)
        self.comparison, self.side_rows = None, compare_sides(part, (first, second))
        nothing = np.empty((0, POINTS))
        cycles = {
            joint: SideCycle(part.cycle(joint), nothing, part.stance_percent(joint.side)) for joint in part.joints
        }
        curves, sides = self._band(part)
        self.side_charts.set_band(curves if sides else None)
        verdicts = {joint: part.verdicts.joint(joint) for joint in part.joints}
        self.side_charts.show_cycles(cycles, verdicts, self._is_simulated)
        self._fit_side_charts()
        reported = [row for row in self.side_rows if row.is_reported]
        differences = [row.difference for row in reported]
        self.error.setText(error_in_words(differences))
        worth = [row for row in sorted(reported, key=side_weight) if row.difference.is_worth_a_sentence]
        stated = conclusion([side_sentence(row, first, second) for row in worth], reported)
        self._say(stated, parts[:1], is_marked=bool(worth))
        title = f"{self._affected_words}: {first.letter} {MINUS} {second.letter}"
        self.card.show_sides(self.side_rows, first, second, title, self.conclusion.text())

    def _fit_side_charts(self) -> None:
        """Three charts are small where there is little room."""
        charts, is_compact = self.side_charts, self._is_compact
        is_crowded = not charts.hip.isHidden() and not self._is_spacious
        is_beside = is_compact and (self._has_two_charts or is_crowded)
        charts.set_side_by_side(is_beside)
        charts.set_tight(is_tight=is_crowded)

    def _band(self, part: Part) -> tuple[ReferenceCurves | None, frozenset[Side]]:
        """The curves that a part may stand beside, and which of its legs."""
        if self._analysis is None or not part.walks:
            return None, frozenset()
        return bands_of(part, self._who).curves, sides_with_band(part)

    def _say(self, stated: Sequence[str], parts: Sequence[Part], *, is_marked: bool) -> None:
        by_hand = left_out_of_parts(parts)
        self.conclusion.setText(" ".join([*stated, by_hand] if by_hand else stated))
        self._mark.setVisible(is_marked)

    def _fit_card(self) -> None:
        self.card.fit(is_alone=self._charts.isHidden())
