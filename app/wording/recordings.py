"""Names of recordings wherever somebody reads of them.

A walk is called by the letter of its condition and the condition.

A recording's own name ("walk 3") is its identity in a session's folder, in tables and for programs; nobody has to know
it. On the screen and on paper a walk is called "A Barefoot", and "A2 Barefoot" where it is the second of its condition:
the letter that represents the condition in every comparison, the words that somebody chose or typed. Labels that we
propose are read in the user's language, whichever they were stored in.
"""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import accumulate
from typing import NamedTuple

from app.wording.translation import languages, later, spoken_in, tr
from core.findings import Finding
from core.session import Recording, RecordingKind

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
OWN_NAMES = {  # in files, numbered by `SessionRecordings`
    RecordingKind.STANDING: "standing",
    RecordingKind.FREE_MOTION: "free motion",
    RecordingKind.WALKING: "walk",
}
OWN_LABELS = (later("Barefoot"), later("Shoes"), later("AFO"), later("Shoes, stick"))
ALIGNMENT = later("Alignment {letter}")
ALIGNMENT_AGAIN = later("Alignment {letter} again")  # which the prosthesis was put back to, with its number from 2 on
MOST_AGAIN = 9
_OWN_NAME = re.compile(rf"({'|'.join(OWN_NAMES.values())})(?: (\d+))?")


@dataclass(frozen=True, slots=True)
class ShownName:
    """`letter`: of the condition, with the walk's number from the second on; empty of all that is no kept walk.

    A walk without a condition is called by its own name, which distinguishes it: "A walk 3" would be no name.
    """

    letter: str
    words: str
    has_condition: bool = True

    def __str__(self) -> str:
        return f"{self.letter} {self.words}".lstrip() if self.has_condition else self.words


def condition_letters(recordings: Sequence[Recording]) -> dict[str, str]:
    """Give the letter of each included walk's condition, by the walk's name; empty beyond Z.

    `recordings` are in order of time. A walk without a condition has a letter of its own, and so have the walks after
    the sensors were attached again. What returns to an earlier condition has its letter. Discarded walks have none.
    """
    letters = dict(zip(dict.fromkeys(_conditions(recordings).values()), LETTERS, strict=False))
    return {name: letters.get(condition, "") for name, condition in _conditions(recordings).items()}


def shown_names(recordings: Sequence[Recording]) -> dict[str, ShownName]:
    """Give what each recording of one session is called, by its name; no two kept walks are called the same."""
    letters, conditions = condition_letters(recordings), _conditions(recordings)
    walked: dict[tuple[str, int], int] = {}
    found = {}
    for one in recordings:
        letter, words = letters.get(one.name, ""), name_in_words(one.condition or one.name)
        if (condition := conditions.get(one.name)) is not None:
            walked[condition] = walked.get(condition, 0) + 1
            number = str(walked[condition]) if walked[condition] > 1 else ""
            letter, words = (letter + number, words) if letter else ("", f"{words} {number}".rstrip())
        found[one.name] = ShownName(letter, words, bool(one.condition))
    return found


def name_in_words(name: str) -> str:
    """Put a name or a condition that we proposed into the user's language; one that somebody gave stays."""
    if (label := _own_labels().get(name.casefold())) is not None:
        own_words = label.words()
        return name if own_words.casefold() == name.casefold() else own_words
    own = _OWN_NAME.fullmatch(name)
    if own is None:
        return name
    words = {"standing": tr("standing"), "free motion": tr("free motion"), "walk": tr("walk")}
    return f"{words[own[1]]} {own[2] or ''}".rstrip()


def is_alignment(label: str) -> bool:
    """Whether a label is one of ours for an alignment, in whichever language."""
    found = _own_labels().get(label.casefold())
    return found is not None and bool(found.letter)


def label_again(condition: str, used: Collection[str]) -> str:
    """Name an alignment that the prosthesis is put back to, by its letter or what it is called; none of `used`."""
    own = _own_labels().get(condition.casefold())
    for number in range(1, MOST_AGAIN + 1):
        label = _Label(ALIGNMENT_AGAIN, own.letter, number).words() if own is not None and own.letter else ""
        if not label:
            label = _numbered(tr("{condition} again").format(condition=condition), number)
        if label.casefold() not in {one.casefold() for one in used}:
            return label
    return label


class _Label(NamedTuple):
    """A label that we propose: the message, the letter of an alignment, and the number of one again."""

    message: str
    letter: str = ""
    number: int = 1

    def words(self, spoken: Callable[[str], str] = tr) -> str:
        return _numbered(spoken(self.message).format(letter=self.letter), self.number)


def _numbered(words: str, number: int) -> str:
    return f"{words} {number}" if number > 1 else words


@cache
def _own_labels() -> dict[str, _Label]:
    """Each label that we propose in any language, and which one it is."""
    own = [_Label(label) for label in OWN_LABELS]
    own += [_Label(ALIGNMENT, one) for one in LETTERS]
    own += [_Label(ALIGNMENT_AGAIN, one, number) for one in LETTERS for number in range(1, MOST_AGAIN + 1)]
    return {label.words(spoken).casefold(): label for spoken in map(spoken_in, languages()) for label in own}


def with_shown_names(finding: Finding, names: Mapping[str, ShownName]) -> Finding:
    """Let a finding say where it was found as the reader knows it."""
    return replace(finding, where=where_shown(finding.where, names))


def where_shown(where: str, names: Mapping[str, ShownName]) -> str:
    """Call the recordings as they are shown, in a text that lists parts of the body and recordings."""
    return ", ".join(str(names.get(part, part)) for part in where.split(", "))


def _conditions(recordings: Sequence[Recording]) -> dict[str, tuple[str, int]]:
    """Each kept walk's condition or own name, or what it returns to, and how often sensors were strapped again."""
    strapped = accumulate(one.is_restrapped_before for one in recordings)
    return {
        one.name: (one.returned_to or one.name, count)
        for one, count in zip(recordings, strapped, strict=True)
        if one.kind is RecordingKind.WALKING and one.is_kept
    }
