"""Names of recordings wherever somebody reads of them.

A walk is called by the letter of its condition and the condition.

A recording's own name ("walk 3") is its identity in a session's folder, in tables and for programs; nobody has to know
it. On the screen and on paper a walk is called "A Barefoot", and "A2 Barefoot" where it is the second of its condition:
the letter that represents the condition in every comparison, the words that somebody chose or typed. Labels that we
propose are read in the user's language, whichever they were stored in.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import accumulate

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
    the sensors were attached again. Discarded walks have none.
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
        own_words = tr(label[0]).format(letter=label[1])
        return name if own_words.casefold() == name.casefold() else own_words
    own = _OWN_NAME.fullmatch(name)
    if own is None:
        return name
    words = {"standing": tr("standing"), "free motion": tr("free motion"), "walk": tr("walk")}
    return f"{words[own[1]]} {own[2] or ''}".rstrip()


@cache
def _own_labels() -> dict[str, tuple[str, str]]:
    """Each label that we propose in any language, and which one it is, with the letter of an alignment."""
    found: dict[str, tuple[str, str]] = {}
    for spoken in map(spoken_in, languages()):
        found |= {spoken(label).casefold(): (label, "") for label in OWN_LABELS}
        found |= {spoken(ALIGNMENT).format(letter=one).casefold(): (ALIGNMENT, one) for one in LETTERS}
    return found


def with_shown_names(finding: Finding, names: Mapping[str, ShownName]) -> Finding:
    """Let a finding say where it was found as the reader knows it."""
    return replace(finding, where=where_shown(finding.where, names))


def where_shown(where: str, names: Mapping[str, ShownName]) -> str:
    """Call the recordings as they are shown, in a text that lists parts of the body and recordings."""
    return ", ".join(str(names.get(part, part)) for part in where.split(", "))


def _conditions(recordings: Sequence[Recording]) -> dict[str, tuple[str, int]]:
    """Each kept walk's condition, or its own name, and how often sensors had been strapped again by then."""
    strapped = accumulate(one.is_restrapped_before for one in recordings)
    return {
        one.name: (one.condition or one.name, count)
        for one, count in zip(recordings, strapped, strict=True)
        if one.kind is RecordingKind.WALKING and one.is_kept
    }
