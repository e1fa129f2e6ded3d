"""The one interface that charts of the stride are drawn on: a painter on the screen, SVG on paper.

Lengths are in the back end's own unit, y downwards; `stride_drawing` draws on either.
"""

from dataclasses import dataclass
from enum import Enum, auto
from typing import Literal, Protocol

from core.body import Side

Anchor = Literal["start", "middle", "end"]
"""Which part of a text is at its place."""


class Tone(Enum):
    """What a line or a word is for; each back end has a colour for it, and one for each leg."""

    INK = auto()
    NOTE = auto()
    AXIS = auto()
    INSIDE_ERROR = auto()


@dataclass(frozen=True, slots=True)
class Lengths:
    """How large a back end draws.

    `label_apart`: from an axis to its labels; `percents_below`: to the middle of those of the stride. `halo`: what it
    adds to a label's width. `hidden_margins`: all that is beside the words of a hidden curve's box, its chip too.
    """

    tick: float
    label_apart: float
    percents_below: float
    zero: float
    axis: float
    bar: float
    leader: float
    dot: float
    halo: float
    line: float
    chip: float
    hidden_padding: float
    hidden_margins: float
    hidden_height: float


class Canvas(Protocol):
    """Lines, texts, markers and boxes; words over curves have a halo and are of the `first` rank or below it."""

    @property
    def lengths(self) -> Lengths: ...

    def stroke(self, start: tuple[float, float], end: tuple[float, float], tone: Tone, width: float) -> None: ...

    def label(self, x: float, middle: float, stated: str, anchor: Anchor) -> None:
        """A label of an axis."""

    def words(
        self, x: float, middle: float, stated: str, anchor: Anchor, tone: Tone | Side, *, is_first: bool
    ) -> None: ...

    def width_of(self, stated: str, *, is_first: bool) -> float:
        """The room that `words` take, without their halo."""

    def dot(self, x: float, y: float, side: Side) -> None:
        """A marker on a curve: left filled, right outlined."""

    def chip(self, left: float, middle: float, side: Side) -> None:
        """The letter of a leg in its frame, on a clear ground."""

    def hatched_box(self, left: float, top: float, width: float, height: float) -> None:
        """A box that nobody takes for a curve."""
