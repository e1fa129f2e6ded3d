"""What the prosthesis of one side is: level of amputation, and knee and foot as far as the level leaves them open."""

from collections.abc import Mapping
from enum import StrEnum
from typing import TypeVar

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.text import Text
from app.wizard.patient.captioned import Captioned
from app.wording.prostheses import FEET, KNEES, LEVELS
from app.wording.translation import tr
from core.body import Side
from core.prosthesis import NOT_STATED, AmputationLevel, FootKind, KneeKind, Prosthesis

WIDEST = 280  # px of a choice, as far as its words do not need more

_ACROSS = QBoxLayout.Direction.LeftToRight
K = TypeVar("K", bound=StrEnum)


class ProsthesisRow(QWidget):
    """One line. What was chosen of a part that the level excludes is kept, for a level chosen by mistake."""

    edited = Signal()  # by the user

    def __init__(self, side: Side) -> None:
        super().__init__()
        is_left = side is Side.LEFT
        names = (
            tr("Left level of amputation") if is_left else tr("Right level of amputation"),
            tr("Left prosthetic knee") if is_left else tr("Right prosthetic knee"),
            tr("Left prosthetic foot") if is_left else tr("Right prosthetic foot"),
        )
        self.choices = tuple(map(Choice, names))
        self._boxes = tuple(map(Captioned, self.choices, names))
        for choice in self.choices:
            choice.let_shrink(WIDEST, WIDEST)
            choice.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            choice.activated.connect(self._on_activated)
        self._line = lay_out(QBoxLayout(_ACROSS), *((box, 1) for box in self._boxes), margins=0, spacing=12)
        words = tr("Without ankle joint, the angle is called “foot relative to shank”.")
        self._note = Text(words, size=12, tone="ink2", wraps=True)
        lay_out(QVBoxLayout(self), self._line, self._note, margins=0, spacing=6)
        self.show_prosthesis(NOT_STATED)

    @property
    def prosthesis(self) -> Prosthesis:
        at, (_, knee, foot) = self._at_level, self.choices
        return Prosthesis(
            at.level,
            _chosen(knee, KneeKind) if at.has_knee else None,
            _chosen(foot, FootKind) if at.may_have_foot else None,
        )

    def show_prosthesis(self, prosthesis: Prosthesis) -> None:
        """Show what is stated; it is not reported as an edit."""
        level, knee, foot = self.choices
        level.offer(_lines(LEVELS), prosthesis.level or "")
        knee.offer(_lines(KNEES), prosthesis.knee or "")
        foot.offer(_lines(FEET), prosthesis.foot or "")
        self._follow()

    @property
    def _at_level(self) -> Prosthesis:
        return Prosthesis(_chosen(self.choices[0], AmputationLevel))

    def fit(self, room: int) -> None:
        """Set the choices below one another where `room` px would cut one's words."""
        shown = [box.minimumSizeHint().width() for box in self._boxes if not box.isHidden()]
        needed = sum(shown) + (len(shown) - 1) * self._line.spacing()
        self._line.setDirection(_ACROSS if needed <= room else QBoxLayout.Direction.TopToBottom)

    def _follow(self) -> None:
        """Ask for a knee only where the level replaces it, and for a foot only where the ankle is not left."""
        at, (_, knee, foot) = self._at_level, self._boxes
        knee.setVisible(at.has_knee)
        foot.setVisible(at.may_have_foot)
        self._note.setVisible(self.prosthesis.has_rigid_foot)

    def _on_activated(self) -> None:
        self._follow()
        self.edited.emit()


def _lines(words: Mapping[K, str]) -> list[tuple[str, str]]:
    return [(tr("Not recorded"), ""), *((tr(text), str(kind)) for kind, text in words.items())]


def _chosen(choice: Choice, kind: type[K]) -> K | None:
    """The kind that is chosen; a list gives back plain words."""
    word = choice.currentData()
    return kind(word) if word else None
