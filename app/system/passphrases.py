"""Estimate how long a passphrase would hold against somebody who has a copy of the library.

The estimate is in words, and on the cautious side.

The number of guesses is that of zxcvbn (Wheeler 2016, USENIX Security 25), which knows common passwords, words, names,
dates, keys that lie side by side and what repeats. Its words are mostly English, so what is German, French or Italian
may be judged too kindly; the operator's and the clinic's own names are given to it. A guess costs 64 MiB and three
passes of Argon2id (RFC 9106); ten thousand a second is what a rack of graphics cards might do.
"""

import re
import unicodedata
from collections.abc import Iterable
from enum import Enum, auto
from typing import Any, NamedTuple

from app.wording.translation import tr

GUESSES_PER_S = 1e4
MINUTE_S, HOUR_S, DAY_S, YEAR_S = 60.0, 3600.0, 86_400.0, 31_557_600.0
MOST_JUDGED = 72  # letters; zxcvbn takes no more, for its work grows with the square
LEAST_HELD_S = 90 * DAY_S  # who takes a copy of a clinic's library has a season's patience at most
LEAST_KNOWN = 2  # letters of a name: a single initial is in every passphrase


class Strength(Enum):
    NONE = auto()
    TOO_SHORT = auto()
    WEAK = auto()
    FAIR = auto()
    STRONG = auto()


REFUSED = frozenset({Strength.TOO_SHORT, Strength.WEAK})


def strength_of(passphrase: str, shortest: int, known: Iterable[str] = ()) -> Strength:
    """Rate a passphrase; shorter than `shortest` or weak is refused. `known`: names of operator and clinic."""
    if not passphrase.strip():
        return Strength.NONE
    if len(passphrase.strip()) < shortest:
        return Strength.TOO_SHORT
    held_s = held_for_s(passphrase, known)
    return Strength.WEAK if held_s < LEAST_HELD_S else Strength.FAIR if held_s < 10 * YEAR_S else Strength.STRONG


def strength_in_words(passphrase: str, shortest: int, known: Iterable[str] = ()) -> str:
    """Say how long a passphrase holds, and what would be better."""
    known = tuple(known)
    strength = strength_of(passphrase, shortest, known)
    if strength is Strength.NONE:
        return tr("Five unrelated words are strong and easier to remember than symbols.")
    if strength in (Strength.TOO_SHORT, Strength.WEAK):
        return "{}. {}.".format(*refusal_of_passphrase(passphrase, shortest, known))
    held = _in_words(held_for_s(passphrase, known))
    if strength is Strength.FAIR:
        return tr("Fair: guessing this passphrase would take {held}. One more word makes it strong.").format(held=held)
    return tr("Strong: guessing this passphrase would take {held}.").format(held=held)


def refusal_of_passphrase(passphrase: str, shortest: int, known: Iterable[str] = ()) -> tuple[str, str]:
    """What is wrong with a passphrase that is not accepted, and what to do; both without their full stop."""
    if strength_of(passphrase, shortest, known) is not Strength.WEAK:
        return tr("At least {shortest} characters are needed").format(shortest=shortest), tr("Use several words")
    judged = _judged(passphrase, known)
    held = _in_words(_held_s(judged.guesses))
    what = tr("{why}, so anyone with a copy of the library could guess it within {held}").format(
        why=_why(judged.parts), held=held
    )
    return what, tr("Use four or five unrelated words")


def held_for_s(passphrase: str, known: Iterable[str] = ()) -> float:
    """Half of the guesses that a passphrase is good for, in seconds."""
    return _held_s(_judged(passphrase, known).guesses) if passphrase.strip() else 0.0


def _held_s(guesses: float) -> float:
    return guesses / 2 / GUESSES_PER_S


class _Judged(NamedTuple):
    guesses: float
    parts: list[dict[str, Any]]


def _judged(passphrase: str, known: Iterable[str]) -> _Judged:
    from zxcvbn import zxcvbn  # its lists of words take as long to load as the rest of a page

    words = [word for text in known for word in (text, *re.split(r"[\W_]+", text)) if len(word) >= LEAST_KNOWN]
    judged = zxcvbn(unicodedata.normalize("NFKC", passphrase.strip())[:MOST_JUDGED], user_inputs=["gaitwright", *words])
    return _Judged(float(judged["guesses"]), [dict(part) for part in judged["sequence"]])


def _why(parts: list[dict[str, Any]]) -> str:
    """Say why it is guessed so soon, by the longest of its parts that somebody would try."""
    longest = max(parts, key=lambda part: (part["pattern"] != "bruteforce", len(part["token"])))
    match longest["pattern"]:
        case "repeat":
            return tr("The passphrase contains repeats")
        case "sequence":
            return tr("The passphrase contains letters or digits in sequence")
        case "spatial":
            return tr("The passphrase uses keys that lie side by side")
        case "date" | "regex":
            return tr("The passphrase contains a date or a year")
        case "dictionary" if longest["dictionary_name"] == "user_inputs":
            return tr("The passphrase contains a name or code: yours, the clinic's or the program's")
        case "dictionary":
            return tr("The passphrase contains a common password, word or name")
    return tr("The passphrase is too short for the characters it uses")


def _in_words(seconds: float) -> str:
    if seconds < MINUTE_S:
        return tr("a minute")
    if seconds < HOUR_S:
        return tr("minutes")
    if seconds < DAY_S:
        return tr("hours")
    if seconds < 60 * DAY_S:
        return tr("days")
    if seconds < 2 * YEAR_S:
        return tr("months")
    if seconds < 100 * YEAR_S:
        return tr("years")
    return tr("centuries") if seconds < 1e4 * YEAR_S else tr("longer than anyone would wait")
