"""What was entered or found wrongly, and put right after the fact: conditions, what counts, signs and sides."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.field import Field
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wording.body import name_of
from app.wording.translation import capitalised, tr
from core.body import Joint

ACROSS, DOWN = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom


@dataclass(frozen=True, slots=True)
class WalkLine:
    """One walk; `note` states when it was and what it holds."""

    key: str
    name: str
    note: str
    condition: str
    is_kept: bool


@dataclass(frozen=True, slots=True)
class JointLine:
    """One joint; `note` states what is known of its sign."""

    joint: Joint
    is_turned: bool
    note: str


class CorrectPage(QWidget):
    """Each correction is emitted at once; the page is then shown what came of it.

    `condition_typed`, `kept_turned`, `sign_turned`: a walk's key and its condition or whether it counts; a joint and
    whether its sign is turned.
    """

    condition_typed = Signal(str, str)
    kept_turned = Signal(str, bool)
    sign_turned = Signal(str, bool)

    def __init__(self) -> None:
        super().__init__()
        self.walk_rows: dict[str, _WalkRow] = {}
        self.joint_rows: dict[Joint, _JointRow] = {}
        self.back = Button(tr("Back to the results"), ButtonKind.SECONDARY, Icon.BACK)
        self.note = Text(tr("Each correction is recorded with its user and can be undone."), tone="ink2", wraps=True)
        self.walks = Card()
        self.walks.column.addWidget(Text(tr("Walks"), size=16, weight=SEMIBOLD))
        self.joints = Card()
        self.joints.column.addWidget(Text(tr("Joints"), size=16, weight=SEMIBOLD))
        self.sides = Card()
        self.sides.column.addWidget(Text(tr("Sides"), size=16, weight=SEMIBOLD))
        self.swap = Button(tr("Swap left and right"), ButtonKind.SECONDARY, Icon.REPEAT)
        self.swap_note = Text(size=14, tone="ink2", wraps=True)
        self._build()

    @property
    def tab_order(self) -> list[QWidget]:
        walks = [widget for row in self.walk_rows.values() for widget in (row.condition, row.kept)]
        return [self.back, *walks, *(row.turned for row in self.joint_rows.values()), self.swap]

    def show_walks(self, lines: Sequence[WalkLine]) -> None:
        """Show the walks; what is being typed stays."""
        for key in [key for key in self.walk_rows if key not in {line.key for line in lines}]:
            row = self.walk_rows.pop(key)
            row.hide()
            row.deleteLater()
        for line in lines:
            if line.key not in self.walk_rows:
                row = self.walk_rows[line.key] = _WalkRow(line)
                row.condition.committed.connect(partial(self._on_condition_committed, line.key))
                row.kept.toggled.connect(partial(self.kept_turned.emit, line.key))
                self.walks.column.insertWidget(self.walks.column.count() - 1, row)
            self.walk_rows[line.key].show_line(line)

    def show_joints(self, lines: Sequence[JointLine]) -> None:
        for line in lines:
            if line.joint not in self.joint_rows:
                row = self.joint_rows[line.joint] = _JointRow(line.joint)
                row.turned.toggled.connect(partial(self.sign_turned.emit, str(line.joint)))
                self.joints.column.insertWidget(self.joints.column.count() - 1, row)
            self.joint_rows[line.joint].show_line(line)
        known = {line.joint for line in lines}
        for joint, row in self.joint_rows.items():
            row.setVisible(joint in known)

    def show_sides(self, why_not: str) -> None:
        """Offer to swap the sides, or say why that is not possible here."""
        self.swap.setEnabled(not why_not)
        stated = tr("Swaps left and right in all recordings of this visit and analyses them again.")
        self.swap_note.setText(why_not or stated)

    def set_room(self, width: float, _height: float) -> None:
        is_narrow = width < 940
        self._columns.setDirection(DOWN if is_narrow else ACROSS)
        for row in self.walk_rows.values():
            row.set_narrow(is_narrow and width < 700)

    def focus(self) -> None:
        self.back.setFocus()

    def _build(self) -> None:
        for card in (self.walks, self.joints):
            card.column.addStretch(1)
        lay_out(self.sides.column, (self.swap, 0, Qt.AlignmentFlag.AlignLeft), self.swap_note)
        head = lay_out(QHBoxLayout(), self.back, (self.note, 1))
        scaled(head.setSpacing, 16)
        right = lay_out(QVBoxLayout(), self.joints, self.sides, 1)
        scaled(right.setSpacing, 12)
        self._columns = lay_out(QBoxLayout(ACROSS), (self.walks, 3), (right, 2), spacing=12)
        lay_out(QVBoxLayout(self), head, (self._columns, 1), margins=(16, 16, 16, 12), spacing=12)

    def _on_condition_committed(self, key: str) -> None:
        if (row := self.walk_rows.get(key)) is not None:  # a row that goes away is left, and commits
            self.condition_typed.emit(key, row.condition.text.strip())


class _WalkRow(QWidget):
    def __init__(self, line: WalkLine) -> None:
        super().__init__()
        self._line = line
        self._name = Text(size=15, weight=SEMIBOLD, wraps=True)
        self._note = Text(size=12, tone="ink2", wraps=True)
        self.condition = Field("", has_label=False, placeholder=tr("condition"))
        self.kept = Toggle(tr("Included"), "", is_on=line.is_kept)
        words = lay_out(QVBoxLayout(), self._name, self._note, spacing=0)
        kept = self.kept, 0, Qt.AlignmentFlag.AlignLeft
        self._row = lay_out(QBoxLayout(ACROSS, self), (words, 2), (self.condition, 3), kept, margins=0)
        scaled(self._row.setSpacing, 12)

    def show_line(self, line: WalkLine) -> None:
        if line.condition != self._line.condition or not self.condition.text:
            self.condition.set_text(line.condition)
        self._line = line
        self._name.setText(line.name)  # its condition is part of it
        self.condition.set_label(tr("Condition of {walk}").format(walk=line.name))
        self.kept.setAccessibleName(tr("{walk} included").format(walk=line.name))
        self._note.setText(line.note)
        self.kept.show_on(line.is_kept)

    def set_narrow(self, is_narrow: bool) -> None:
        self._row.setDirection(DOWN if is_narrow else ACROSS)


class _JointRow(QWidget):
    def __init__(self, joint: Joint) -> None:
        super().__init__()
        self.turned = Toggle(tr("Reverse the sign of this joint"), "", is_on=False)
        name = capitalised(name_of(joint))
        self.turned.setAccessibleName(tr("{joint}: reverse the sign of this joint").format(joint=name))
        self._note = Text(size=12, tone="ink2", wraps=True)
        kind = Text(tr("Knee") if joint.is_knee else tr("Ankle"), size=15, weight=SEMIBOLD)
        head = lay_out(QHBoxLayout(), Chip(joint.side), kind, (self._note, 1))
        scaled(head.setSpacing, 8)
        column = lay_out(QVBoxLayout(self), head, (self.turned, 0, Qt.AlignmentFlag.AlignLeft), margins=0)
        scaled(column.setSpacing, 4)

    def show_line(self, line: JointLine) -> None:
        self._note.setText(line.note)
        self.turned.show_on(line.is_turned)
