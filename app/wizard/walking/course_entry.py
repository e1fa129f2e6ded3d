"""The course of a recorded test as somebody measured it: its length, and of a set time the laps counted on it."""

from dataclasses import replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.theme.current import scaled
from app.widgets.card import Card
from app.widgets.field import NumberField
from app.widgets.lay_out import lay_out
from app.widgets.leaving_keys import LeavingKeys
from app.widgets.text import Text
from app.wizard.walking.timed_chooser import FIELD_WIDTH, LONGEST_M, SHORTEST_M
from app.wording.timed_tests import course_label
from app.wording.translation import tr
from core.timed.protocols import DEFINITIONS, PlannedTest, course_of, with_course

MOST_LAPS = 200


class CourseEntry(Card):
    """`entered`: something else was entered; `planned` is then the test with what the fields hold. `left`: by a key."""

    entered = Signal()
    left = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._shown: PlannedTest | None = None
        self._caption = Text(tone="ink2")
        self.length = _field("", SHORTEST_M, LONGEST_M, decimals=2, unit="m")
        self.laps = _field(tr("Laps completed"), 0, MOST_LAPS)
        self.rest = _field(tr("After the last lap"), 0.0, LONGEST_M, decimals=1, unit="m")
        self._counted = QWidget()
        laps, rest = Text(tr("Laps completed"), tone="ink2"), Text(tr("After the last lap"), tone="ink2")
        lay_out(QHBoxLayout(self._counted), laps, self.laps, rest, self.rest, margins=0, spacing=12)
        lay_out(self.column, lay_out(QHBoxLayout(), self._caption, self.length, self._counted, 1, spacing=12))
        for field in self.fields:
            field.committed.connect(self._on_committed)
            LeavingKeys(field).left.connect(self.left)

    @property
    def fields(self) -> tuple[NumberField, ...]:
        return self.length, self.laps, self.rest

    @property
    def planned(self) -> PlannedTest | None:
        if (shown := self._shown) is None:
            return None
        laps = self.laps.value
        count = None if laps is None else int(laps)
        return replace(with_course(shown, self.length.value), typed_laps=count, rest_m=self.rest.value)

    def show_test(self, planned: PlannedTest) -> None:
        """Show what was entered for a test that has a course, and nothing for others."""
        if planned == self._shown:
            return
        is_same = self._shown is not None and self._shown.protocol is planned.protocol
        self._shown = planned
        label = course_label(planned.protocol)
        self.setVisible(bool(label))
        self._caption.setText(label)
        self.length.set_label(label)
        self._counted.setVisible(_has_laps(planned))
        values = (course_of(planned), planned.typed_laps, planned.rest_m)
        for field, value in zip(self.fields, values, strict=True):
            if not (is_same and field.line_edit.hasFocus()):  # what is being typed stays
                field.set_value(value)

    def _on_committed(self) -> None:
        if self.planned != self._shown and not any(field.is_wrong for field in self.fields):
            self.entered.emit()


def _has_laps(planned: PlannedTest) -> bool:
    return DEFINITIONS[planned.protocol].duration_s is not None


def _field(label: str, low: float, high: float, decimals: int = 0, unit: str = "") -> NumberField:
    field = NumberField(label, low=low, high=high, decimals=decimals, unit=unit, has_label=False, states_wrong=False)
    scaled(field.setFixedWidth, FIELD_WIDTH)
    return field
