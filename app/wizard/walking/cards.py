"""Shown beside and between the live curves: strides and cadence, the walk just stopped, and the one to come."""

import math
from collections.abc import Mapping

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QSizePolicy, QVBoxLayout

from app.theme.current import on_theme, px, scaled
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.key_cap import KeyCap
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wizard.walking.charts import Hairline
from app.wizard.walking.label_chooser import LabelChooser
from app.wizard.walking.timed_chooser import CourseField, TimedChooser
from app.wizard.walking.walk_list import WalkRow, WalkState
from app.wording.timed_tests import instruction, name_of_test
from app.wording.translation import tr, tr_n
from core.body import Side
from core.timed.protocols import PlannedTest

FIGURE = 60
UNDER_FIGURES = 0.14  # of their size lies below the line that the unit shares
NO_FIGURE = "\N{EN DASH}"
ACROSS, DOWN = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom


class WalkFigures(Card):
    """Strides and cadence, to be read from across the room."""

    def __init__(self) -> None:
        super().__init__(spacing=0.5)  # a pixel, at any size
        self._strides = Text(NO_FIGURE, size=FIGURE, weight=SEMIBOLD)
        self._cadence = Text(NO_FIGURE, size=FIGURE, weight=SEMIBOLD)
        self._counts = {side: Text("0", size=18, weight=MEDIUM) for side in Side}
        self._chips = {side: Chip(side) for side in Side}
        self._line = Hairline()
        self._unit = Text(tr("steps/min"), size=14, tone="ink2")
        self.in_words = ""
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        pairs = [lay_out(QHBoxLayout(), self._chips[side], self._counts[side], spacing=8) for side in Side]
        self._sides = lay_out(QBoxLayout(DOWN), *pairs, spacing=8)
        unit = self._unit, 0, Qt.AlignmentFlag.AlignBottom
        self._with_unit = lay_out(QBoxLayout(ACROSS), self._cadence, unit, 1, spacing=8)
        rows = {
            tr("Strides"): lay_out(QHBoxLayout(), self._strides, 1, self._sides, spacing=8),
            tr("Cadence"): self._with_unit,
        }
        self._parts = [lay_out(QBoxLayout(DOWN), Text(word, size=14, tone="ink2"), row) for word, row in rows.items()]
        self._both = lay_out(QBoxLayout(DOWN), (self._parts[0], 1), self._line, (self._parts[1], 1))
        self.column.addLayout(self._both)
        self.set_compact(is_compact=False, is_narrow=False)
        on_theme(self._reserve_room)

    def show_figures(self, strides: Mapping[Side, int], cadence_steps_min: float) -> None:
        shown = str(max(strides.values())) if strides else NO_FIGURE
        cadence = f"{cadence_steps_min:.0f}" if math.isfinite(cadence_steps_min) else NO_FIGURE
        self._strides.setText(shown)
        self._cadence.setText(cadence)
        for side in Side:
            self._chips[side].setVisible(side in strides)
            self._counts[side].setVisible(side in strides)
            self._counts[side].setText(str(strides.get(side, 0)))
        stated = [tr("{count} strides.").format(count=shown)] if strides else []
        words = {Side.LEFT: tr("Left {count}."), Side.RIGHT: tr("Right {count}.")}
        stated += [words[side].format(count=strides[side]) for side in Side if side in strides]
        if math.isfinite(cadence_steps_min):
            stated.append(tr("Cadence {cadence} steps per minute.").format(cadence=cadence))
        self.in_words = " ".join(stated)

    def set_size(self, size: float) -> None:
        self._strides.set_size(size)
        self._cadence.set_size(size)
        self._reserve_room()
        self._unit.setContentsMargins(0, 0, 0, px(size * UNDER_FIGURES))

    def set_compact(self, is_compact: bool, is_narrow: bool, *, is_aside: bool = False) -> None:
        """Stand in one line; where it is narrow, with the words above the figures; `is_aside`: over a camera."""
        self._both.setDirection(ACROSS if is_compact or is_aside else DOWN)
        self._sides.setDirection(ACROSS if is_compact else DOWN)
        self._with_unit.setDirection(DOWN if is_aside else ACROSS)
        scaled(self._with_unit.setSpacing, 0 if is_aside else 8)
        scaled(self._sides.setSpacing, 2 if is_aside else 8)
        scaled(self._both.setSpacing, 16 if is_aside else 32 if is_compact else 4)
        for part in self._parts:
            part.setDirection(ACROSS if is_compact and not is_narrow else DOWN)
            scaled(part.setSpacing, 12 if part.direction() is ACROSS else 0)
            self._both.setAlignment(part, Qt.AlignmentFlag.AlignTop if is_aside else Qt.AlignmentFlag(0))
        self._line.setVisible(not is_compact and not is_aside)
        self.set_padding(8 if is_compact else 12 if is_aside else 16)

    def _reserve_room(self) -> None:
        """As wide as the figures get, so that nothing jumps."""
        for label in (self._strides, self._cadence, *self._counts.values()):
            label.setMinimumWidth(label.fontMetrics().horizontalAdvance("000"))


class StoppedCard(Card):
    """What was just recorded, and the one question about it."""

    def __init__(self) -> None:
        super().__init__()
        self._title = Text(size=16, weight=SEMIBOLD, wraps=True)
        self._facts = Text(size=14, tone="ink2", wraps=True)
        self.keep = Button("", ButtonKind.PRIMARY, key="I")
        self.discard = Button(tr("Exclude"), ButtonKind.SECONDARY, key="X")
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        words = lay_out(QVBoxLayout(), self._title, self._facts, spacing=0)
        verbs = lay_out(QHBoxLayout(), 1, self.discard, self.keep, spacing=12)
        self._row = lay_out(QBoxLayout(ACROSS), (words, 1), verbs, spacing=12)
        self.column.addLayout(self._row)

    def show_walk(self, walk: WalkRow | None, facts: str) -> None:
        if walk is None:
            return
        is_recovered = walk.state is WalkState.RECOVERED
        title = tr("{label}: recovered") if is_recovered else tr("{label}: stopped")
        self._title.setText(title.format(label=f"{walk.letter}  {walk.label}"))
        self._facts.setText(facts)
        self._facts.setVisible(bool(facts))
        keep = tr("Include walk")
        if walk.strides:
            keep = tr_n("Include {count} stride", "Include {count} strides", walk.strides).format(count=walk.strides)
        self.keep.setText(keep)
        self.keep.setAccessibleName(keep)
        self.keep.updateGeometry()

    def set_narrow(self, is_narrow: bool) -> None:
        """Put the buttons below the words where the width is too small for both."""
        self._row.setDirection(DOWN if is_narrow else ACROSS)


class EmptyCard(Card):
    """Before the first walk: what to do, and why to stand a moment; of a timed test how it is done."""

    accessible_role = QAccessible.Role.Note

    def __init__(self) -> None:
        super().__init__()
        self._what = Text(size=26, weight=SEMIBOLD, wraps=True)
        self._then = Text(size=16, tone="ink2", wraps=True)
        for text in (self._what, self._then):
            text.setAlignment(Qt.AlignmentFlag.AlignCenter)
        lay_out(self.column, 1, self._what, self._then, 1)
        self.show_test(None)

    def show_test(self, planned: PlannedTest | None) -> None:
        what = tr("Choose a condition, then press Space.")
        then = tr("Stand still for two seconds first: ankle angles are then correct from the start.")
        if planned is not None:
            what = tr("{test}: press Space.").format(test=name_of_test(planned.protocol))
            then = instruction(planned)
        self._what.setText(what)
        self._then.setText(then)
        self.setAccessibleName(f"{what} {then}")


class NextCard(Card):
    """What the next walk is called and which test it is, beside the button that starts it."""

    def __init__(self) -> None:
        super().__init__()
        self._title = Text(size=14, weight=MEDIUM, tone="ink2")
        self.chooser = LabelChooser()
        self.course = CourseField()
        self.test = TimedChooser()
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        test = lay_out(QHBoxLayout(), self.test, KeyCap("T"), spacing=8)
        lay_out(self.column, lay_out(QHBoxLayout(), (self._title, 1), self.course, test, spacing=16), self.chooser)

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()

    def name(self, letter: str) -> None:
        self._title.setText(tr("Next condition: {letter}").format(letter=letter) if letter else tr("Next condition"))

    def show_test(self, planned: PlannedTest | None) -> None:
        """Show which test the next walk is, and how long its course is."""
        self.test.show_choice(None if planned is None else planned.protocol)
        self.course.show_course(planned)
