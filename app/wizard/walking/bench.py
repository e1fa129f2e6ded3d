"""The chain of alignments at the prosthetist's bench: what the next walk is walked with, and what leads back."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from app.summary.alignments import alignments_of
from app.summary.pooled_walks import pool_letters, pools_of
from app.wording.alignment import as_entered
from app.wording.recordings import LETTERS, label_again, shown_names
from core.alignment import (
    FIGURES,
    MOST_TEXT,
    AlignmentChange,
    NetChange,
    PartChange,
    ProsthesisPart,
    changed_between,
    condition_returned_to,
    root_of,
)
from core.session import Recording, RecordingKind

NOTHING_REPORTED = dict.fromkeys(FIGURES, 0.0)
NAMES = ("program_before", "program", "setting")
NUMBERS = ("setting_before", "setting_value")
SWITCHED_PARTS = (ProsthesisPart.FOOT, ProsthesisPart.KNEE_UNIT)  # with programs and settings


class EntryTopic(NamedTuple):
    """What is entered at once: the position of a part, or its program and a setting."""

    part: ProsthesisPart
    is_program: bool = False


def _topics_of(part: ProsthesisPart) -> list[EntryTopic]:
    positions = [EntryTopic(part)] if part is not ProsthesisPart.FOOT else []  # its screws and its rotation are moved
    return [*positions, EntryTopic(part, is_program=True)] if part in SWITCHED_PARTS else positions


TOPICS = tuple(topic for part in ProsthesisPart for topic in _topics_of(part))


class KnownStates:
    """What programs and settings are set to, by what was stated of them before."""

    def __init__(self, found: Mapping[tuple[ProsthesisPart, str], str | float] | None = None) -> None:
        self._found = found or {}

    def program(self, part: ProsthesisPart) -> str:
        found = self._found.get((part, ""), "")
        return found if isinstance(found, str) else ""

    def setting(self, part: ProsthesisPart, name: str) -> float | None:
        found = self._found.get((part, name.strip().casefold())) if name.strip() else None
        return found if isinstance(found, float) else None


class ChangeEntry:
    """The next change while it is entered: each part has its figures and words, and `part` is the one in hand.

    `known`: what programs and settings are now: what they were before the change, unless somebody enters it.
    `has_knee`: whether the knee is the prosthesis's, as far as is known; a unit that is not there is not offered.
    """

    def __init__(self) -> None:
        self.part = ProsthesisPart.FOOT_FRONT_SCREW
        self.is_program = False
        self.known = KnownStates()
        self.has_knee = True
        self.times_loaded = 0
        self._figures: dict[ProsthesisPart, dict[str, float]] = {}
        self._texts: dict[ProsthesisPart, str] = {}
        self._names: dict[ProsthesisPart, dict[str, str]] = {}
        self._numbers: dict[ProsthesisPart, dict[str, float]] = {}

    @property
    def topic(self) -> EntryTopic:
        return EntryTopic(self.part, self.is_program)

    @topic.setter
    def topic(self, topic: EntryTopic) -> None:
        self.part, self.is_program = topic

    @property
    def topics(self) -> list[EntryTopic]:
        """What can be entered, and what was already."""
        entered = {change.part for change in self.parts} | {self.part}
        return [
            one for one in TOPICS if self.has_knee or one.part is not ProsthesisPart.KNEE_UNIT or one.part in entered
        ]

    def figure(self, name: str) -> float:
        """Of the part in hand: `angle_deg`, `turns`, `shift_mm` or `height_mm`."""
        return self._figures.get(self.part, NOTHING_REPORTED)[name]

    @property
    def text(self) -> str:
        return self._texts.get(self.part, "")

    def name(self, which: str) -> str:
        """Of the part in hand: `program_before`, `program` or `setting`, as it was typed."""
        return self._names.get(self.part, {}).get(which, "")

    def number(self, which: str) -> float | None:
        """Of the part in hand: `setting_before` or `setting_value`; None where nothing was entered."""
        return self._numbers.get(self.part, {}).get(which)

    @property
    def known_program(self) -> str:
        return self.known.program(self.part)

    @property
    def known_setting(self) -> float | None:
        return self.known.setting(self.part, self.name("setting"))

    def step(self, name: str, steps: int) -> None:
        """Add so many steps to a figure of the part in hand, up to its limit."""
        limits = FIGURES[name]
        value = self.figure(name) + steps * limits.step
        own = self._figures.setdefault(self.part, dict(NOTHING_REPORTED))
        own[name] = min(max(value, -limits.most), limits.most)

    def say(self, text: str) -> None:
        self._texts[self.part] = text

    def say_name(self, which: str, text: str) -> None:
        self._names.setdefault(self.part, {})[which] = text

    def set_number(self, which: str, value: float | None) -> None:
        own = self._numbers.setdefault(self.part, {})
        own.pop(which, None)
        if value is not None:
            own[which] = value

    @property
    def parts(self) -> tuple[PartChange, ...]:
        """All that was entered so far."""
        reported = []
        for part in ProsthesisPart:
            given: dict[str, Any] = {"text": self._texts.get(part, "").strip()}
            given |= self._figures.get(part, NOTHING_REPORTED) | self._program_of(part) | self._setting_of(part)
            if any(given.values()):
                reported.append(PartChange(part, **given))
        return tuple(reported)

    def _program_of(self, part: ProsthesisPart) -> dict[str, Any]:
        """What was entered of a program; nothing as long as it is the one before."""
        own = {name: text.strip() for name, text in self._names.get(part, {}).items()}
        before, after = own.get("program_before") or self.known.program(part), own.get("program", "")
        return {"program_before": before, "program": after} if after and after.casefold() != before.casefold() else {}

    def _setting_of(self, part: ProsthesisPart) -> dict[str, Any]:
        name, numbers = self._names.get(part, {}).get("setting", "").strip(), self._numbers.get(part, {})
        before, after = numbers.get("setting_before", self.known.setting(part, name)), numbers.get("setting_value")
        if not name or after is None or after == before:
            return {}
        return {"setting": name, "setting_before": before, "setting_value": after}

    def load(self, parts: Sequence[PartChange]) -> None:
        """Enter all of a change again, what is of one part together; empty: nothing."""
        self._figures, self._texts, self._names, self._numbers = {}, {}, {}, {}
        self.times_loaded += 1
        for one in parts:
            figures = self._figures.setdefault(one.part, dict(NOTHING_REPORTED))
            figures |= {name: value + getattr(one, name) for name, value in figures.items()}
            texts = filter(None, [self._texts.get(one.part, ""), one.text])
            self._texts[one.part] = "; ".join(texts)[:MOST_TEXT]
            names, numbers = self._names.setdefault(one.part, {}), self._numbers.setdefault(one.part, {})
            names |= {name: value for name in NAMES if (value := getattr(one, name))}
            numbers |= {name: value for name in NUMBERS if (value := getattr(one, name)) is not None}


@dataclass(frozen=True, slots=True)
class AlignmentChain:
    """The conditions walked so far in order, what was changed before each, and `base`, which the prosthesis is in.

    `latest` is the condition of the latest walk: `base` is another where the prosthesis was put back to it since.
    """

    recordings: tuple[Recording, ...]
    letters: Mapping[str, str]  # by condition
    changes: Mapping[str, AlignmentChange | None]
    base: str
    latest: str

    @property
    def first(self) -> str:
        """What the chain of `base` began with; empty where nothing was walked."""
        return root_of(self.changes, self.base) if self.changes else ""

    @property
    def next_letter(self) -> str:
        """Of the next condition that is new; none where letters have run out."""
        last = max((letter[:1] for letter in self.letters.values()), default="")
        return LETTERS[LETTERS.index(last) + 1 :][:1] if last else LETTERS[0]

    @property
    def is_back(self) -> bool:
        """Whether the prosthesis was put back since the latest walk."""
        return self.base != self.latest

    @property
    def again(self) -> tuple[str, AlignmentChange]:
        """What the next walk is called after the return, and what was undone before it."""
        back = changed_between(self.changes, self.latest, self.base) or ()
        to = condition_returned_to(self.base, self.changes.get(self.base))
        return label_again(to, list(self.changes)), AlignmentChange(self.latest, as_entered(back), returns_to=to)

    @property
    def again_letter(self) -> str:
        """The letter and number that a walk after the return has, as "A2"."""
        label, change = self.again
        walk = Recording("", RecordingKind.WALKING, "", {}, condition=label, alignment=change)
        return shown_names([*self.recordings, walk])[""].letter

    def set_so(self, condition: str, change: AlignmentChange | None) -> tuple[NetChange, ...]:
        """By what the prosthesis differs from the first alignment in a walk that was changed so before."""
        changes = {**self.changes, condition: change}
        return changed_between(changes, root_of(changes, condition), condition) or ()

    def way_back(self, to: str) -> tuple[NetChange, ...] | None:
        """What leads from `base` to another condition; None where no chain ties them."""
        return changed_between(self.changes, self.base, to)

    @property
    def known(self) -> KnownStates:
        """What programs and settings are in `base`, by what was stated when they were changed."""
        found: dict[tuple[ProsthesisPart, str], str | float] = {}
        for change in filter(None, self.changes.values()):
            since = changed_between(self.changes, change.since, self.base)
            if since is None or change.returns_to:
                continue
            then = {(one.part, two.name.casefold()): two.after for one in since for two in one.switched}
            for part in change.parts:
                for one in part.switched:
                    key = part.part, one.name.casefold()
                    if (state := then.get(key, one.before)) is not None:
                        found[key] = state
        return KnownStates(found)


def chain_of(recordings: Sequence[Recording], returned_to: str) -> AlignmentChain:
    """The chain of the walks that count; `returned_to`: what the prosthesis was put back to since, empty where not."""
    walks = [one for one in recordings if one.kind is RecordingKind.WALKING and one.is_kept]
    called, letters = pool_letters(recordings), dict[str, str]()
    for pool in pools_of(recordings).values():
        if not pool.apart or pool.condition not in letters:
            letters[pool.condition] = called[pool]
    changes = alignments_of(recordings)
    latest = (walks[-1].condition or walks[-1].name) if walks else ""
    base = returned_to if returned_to in changes else latest
    return AlignmentChain(tuple(recordings), letters, changes, base, latest)


def next_walk(chain: AlignmentChain, entry: ChangeEntry, new_condition: str) -> tuple[str, AlignmentChange | None]:
    """What the next walk is called and what was changed before it: with nothing entered, the same condition again."""
    if entry.parts:
        return new_condition, AlignmentChange(chain.base, entry.parts)
    return chain.again if chain.is_back else (chain.base, chain.changes.get(chain.base))
