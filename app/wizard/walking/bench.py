"""The chain of alignments at the prosthetist's bench: what the next walk is walked with, and what leads back."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from app.summary.alignments import alignments_of
from app.wording.recordings import LETTERS, condition_letters
from core.alignment import (
    FIGURES,
    AlignmentChange,
    NetChange,
    PartChange,
    ProsthesisPart,
    changed_between,
)
from core.session import Recording, RecordingKind

NOTHING_REPORTED = dict.fromkeys(FIGURES, 0.0)


class ChangeEntry:
    """The next change while it is entered: each part has its figures and words, and `part` is the one in hand."""

    def __init__(self) -> None:
        self.part = ProsthesisPart.FOOT_FRONT_SCREW
        self._figures: dict[ProsthesisPart, dict[str, float]] = {}
        self._texts: dict[ProsthesisPart, str] = {}

    def figure(self, name: str) -> float:
        """Of the part in hand: `angle_deg`, `turns`, `shift_mm` or `height_mm`."""
        return self._figures.get(self.part, NOTHING_REPORTED)[name]

    @property
    def text(self) -> str:
        return self._texts.get(self.part, "")

    def step(self, name: str, steps: int) -> None:
        """Add so many steps to a figure of the part in hand, up to its limit."""
        limits = FIGURES[name]
        value = self.figure(name) + steps * limits.step
        own = self._figures.setdefault(self.part, dict(NOTHING_REPORTED))
        own[name] = min(max(value, -limits.most), limits.most)

    def say(self, text: str) -> None:
        self._texts[self.part] = text

    @property
    def parts(self) -> tuple[PartChange, ...]:
        """All that was entered so far."""
        reported = []
        for part in ProsthesisPart:
            figures, text = self._figures.get(part, NOTHING_REPORTED), self._texts.get(part, "").strip()
            if text or any(figures.values()):
                reported.append(PartChange(part, **figures, text=text))
        return tuple(reported)

    def load(self, parts: Sequence[PartChange]) -> None:
        """Enter all of a change again; empty: nothing."""
        self._figures = {one.part: {name: getattr(one, name) for name in FIGURES} for one in parts}
        self._texts = {one.part: one.text for one in parts}


@dataclass(frozen=True, slots=True)
class AlignmentChain:
    """The conditions walked so far in order, what was changed before each, and `base`, which the prosthesis is in."""

    letters: Mapping[str, str]  # by condition
    changes: Mapping[str, AlignmentChange | None]
    base: str

    @property
    def first(self) -> str:
        return next(iter(self.changes), "")

    @property
    def next_letter(self) -> str:
        """Of the next condition that is new; none where letters have run out."""
        last = max(self.letters.values(), default="")
        return LETTERS[LETTERS.index(last) + 1 :][:1] if last else LETTERS[0]

    def set_so(self, condition: str, change: AlignmentChange | None) -> tuple[NetChange, ...]:
        """By what the prosthesis differs from the first alignment in a walk that was changed so before."""
        return changed_between({**self.changes, condition: change}, self.first or condition, condition) or ()

    def way_back(self, to: str) -> tuple[NetChange, ...] | None:
        """What leads from `base` to another condition; None where no chain ties them."""
        return changed_between(self.changes, self.base, to)


def chain_of(recordings: Sequence[Recording], returned_to: str) -> AlignmentChain:
    """The chain of the walks that count; `returned_to`: what the prosthesis was put back to since, empty where not."""
    of_walk = condition_letters(recordings)
    walks = [one for one in recordings if one.kind is RecordingKind.WALKING and one.is_kept]
    letters = {one.condition or one.name: of_walk[one.name] for one in walks}
    changes = alignments_of(recordings)
    latest = (walks[-1].condition or walks[-1].name) if walks else ""
    return AlignmentChain(letters, changes, returned_to if returned_to in changes else latest)


def next_walk(chain: AlignmentChain, entry: ChangeEntry, new_condition: str) -> tuple[str, AlignmentChange | None]:
    """What the next walk is called and what was changed before it: with nothing entered, the same condition again."""
    if entry.parts:
        return new_condition, AlignmentChange(chain.base, entry.parts)
    return chain.base, chain.changes.get(chain.base)
