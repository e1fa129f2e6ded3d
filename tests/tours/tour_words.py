"""What a tour reads on the screen, reported in English whatever language is spoken: its stops are written once.

Used by `tour_inside.py`.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from babel.messages.pofile import read_po
from PySide6.QtCore import QCoreApplication

CATALOGUES = Path(__file__).resolve().parents[2] / "resources" / "locale"
FIELD = re.compile(r"\{(\w+)(?::[^}]*)?\}")
QT_WORDS = (("QFileDialog", "&Save"),)  # in dialogs of Qt's own, which no catalogue of ours has; with their context


@dataclass(frozen=True, slots=True)
class FieldMessage:
    """A message with fields: what it looks like where they are filled in, their names in its order, and in English."""

    pattern: re.Pattern[str]
    names: tuple[str, ...]
    english: str


def in_english(stated: str, language: str) -> tuple[str, ...]:
    """Give all that `stated` of another language may mean, as it is first: one word may be several English ones."""
    return tuple(dict.fromkeys([stated, *_meant(stated, language)]))


def _meant(stated: str, language: str) -> Iterator[str]:
    whole, with_fields = _catalogue(language)
    yield from whole.get(stated, ())
    for between in (": ", ", "):  # a name with its value, or its unit and state, behind it
        first, found_between, rest = stated.partition(between)
        if found_between:
            yield from (f"{one}{between}{rest}" for one in _meant(first, language))
    several = re.split(r"(?<=\.) ", stated)
    if len(several) > 1:
        yield " ".join(next(_meant(one, language), one) for one in several)
    for message in with_fields:
        if found := message.pattern.fullmatch(stated):
            reported = {
                name: next(_meant(one, language), one) for name, one in zip(message.names, found.groups(), strict=True)
            }
            parts = FIELD.split(message.english)  # texts, and between them the fields' names
            yield "".join(reported.get(part, "") if k % 2 else part for k, part in enumerate(parts))


@cache
def _catalogue(language: str) -> tuple[dict[str, list[str]], tuple[FieldMessage, ...]]:
    """Read whole messages, and those with fields that say more than these; Qt's words as it speaks now."""
    whole: dict[str, list[str]] = {}
    with_fields = []
    with (CATALOGUES / language / "LC_MESSAGES" / "gaitwright.po").open("rb") as file:
        messages = [(one.id, one.string) for one in read_po(file) if one.id]
    for one, two in messages:
        forms = [(one,), (two,)] if isinstance(one, str) else [tuple(one), tuple(two or ())]
        for english, other in zip(*forms, strict=False):
            if not isinstance(other, str):
                continue
            whole.setdefault(other, []).append(english)
            before, *rest = FIELD.split(other)
            if rest and re.search(r"\w{4,}", FIELD.sub(" ", other)):
                pattern = re.escape(before) + "".join(f"(.+){re.escape(after)}" for after in rest[1::2])
                with_fields.append(FieldMessage(re.compile(pattern), tuple(rest[::2]), english))
    for context, word in QT_WORDS:
        whole.setdefault(_without_key(QCoreApplication.translate(context, word)), []).append(_without_key(word))
    return whole, tuple(with_fields)


def _without_key(word: str) -> str:
    return word.replace("&", "")
