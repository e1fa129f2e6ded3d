"""Laps of a walk of a set time as they were counted beside it: how many, how long, and what came after the last."""

from dataclasses import replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QBoxLayout

from app.theme.current import scaled
from app.widgets.card import Card
from app.widgets.field import NumberField
from app.widgets.lay_out import lay_out
from app.widgets.text import Text
from app.wording.translation import tr
from core.timed.protocols import DEFINITIONS, PlannedTest

FIELD_WIDTH = 104
LONGEST_LAP_M, MOST_LAPS = 200.0, 200


class LapEntry(Card):
    """`entered`: one of its fields was left after a change; `planned` is then the test with what they hold."""

    entered = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._planned: PlannedTest | None = None
        self.lap = NumberField(
            tr("Lap length"), low=1.0, high=LONGEST_LAP_M, decimals=2, unit="m", has_label=False, states_wrong=False
        )
        self.laps = NumberField(tr("Laps completed"), low=0, high=MOST_LAPS, has_label=False, states_wrong=False)
        self.rest = NumberField(
            tr("After the last lap"),
            low=0.0,
            high=LONGEST_LAP_M,
            decimals=1,
            unit="m",
            has_label=False,
            states_wrong=False,
        )
        row = QBoxLayout(QBoxLayout.Direction.LeftToRight)
        named = ((tr("Lap"), self.lap), (tr("Laps completed"), self.laps), (tr("then"), self.rest))
        for words, field in named:
            scaled(field.setFixedWidth, FIELD_WIDTH)
            field.committed.connect(self._on_committed)
            lay_out(row, Text(words, tone="ink2"), field, spacing=12)
        lay_out(self.column, lay_out(row, 1))

    @property
    def fields(self) -> tuple[NumberField, ...]:
        return self.lap, self.laps, self.rest

    @property
    def planned(self) -> PlannedTest | None:
        """The test with what was entered; laps without their length are no distance, and are left away."""
        if self._planned is None:
            return None
        laps, rest_m = self.laps.value, self.rest.value
        count = None if laps is None else int(laps)
        return replace(self._planned, lap_m=self.lap.value, typed_laps=count, rest_m=rest_m)

    def show_test(self, planned: PlannedTest) -> None:
        """Show it for a walk of a set time, and nothing for others."""
        self._planned = planned
        self.setVisible(DEFINITIONS[planned.protocol].duration_s is not None)
        values = (planned.lap_m, planned.typed_laps, planned.rest_m)
        for field, value in zip(self.fields, values, strict=True):
            if not field.line_edit.hasFocus():
                field.set_value(value)

    def _on_committed(self) -> None:
        if self.planned != self._planned and not any(field.is_wrong for field in self.fields):
            self.entered.emit()
