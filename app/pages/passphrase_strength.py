"""How long would a passphrase hold, against somebody who has a copy of the library? In words, and on the cautious side.

The bits are those of NIST SP 800-63-1, table A.1, for passwords that people choose: 4 for the first letter, 2 for each
of the next seven, 1.5 up to the twentieth, 1 for each further one. What repeats or runs on (aaaa, 1234) counts as one
letter. A guess costs 64 MiB and three passes of Argon2id (RFC 9106); ten thousand a second is what a rack of graphics
cards might do.
"""

import unicodedata
from enum import Enum, auto
from itertools import pairwise

from app.wording import tr

GUESSES_PER_S = 1e4
MINUTE_S, HOUR_S, DAY_S, YEAR_S = 60.0, 3600.0, 86_400.0, 31_557_600.0


class Strength(Enum):
    NONE = auto()
    TOO_SHORT = auto()
    WEAK = auto()
    FAIR = auto()
    STRONG = auto()


def strength_of(passphrase: str, shortest: int) -> Strength:
    """Judge a passphrase; fewer than `shortest` letters are not accepted at all."""
    if not passphrase.strip():
        return Strength.NONE
    if len(passphrase.strip()) < shortest:
        return Strength.TOO_SHORT
    held_s = held_for_s(passphrase)
    return Strength.WEAK if held_s < 30 * DAY_S else Strength.FAIR if held_s < 10 * YEAR_S else Strength.STRONG


def strength_in_words(passphrase: str, shortest: int) -> str:
    """Say how long a passphrase holds, and what would be better."""
    strength = strength_of(passphrase, shortest)
    if strength is Strength.NONE:
        return tr("Five words that have nothing to do with each other are good, and easier to keep than signs.")
    if strength is Strength.TOO_SHORT:
        return tr("{shortest} letters or more are needed. Take a few words.").format(shortest=shortest)
    held = _in_words(held_for_s(passphrase))
    if strength is Strength.WEAK:
        return tr("Weak: who has a copy of the library could guess it within {held}. Add two words.").format(held=held)
    if strength is Strength.FAIR:
        return tr("Fair: guessing it would take {held} or so. One more word makes it strong.").format(held=held)
    return tr("Strong: guessing it would take {held}.").format(held=held)


def held_for_s(passphrase: str) -> float:
    """Half of the guesses that a passphrase is good for, in seconds."""
    return 2.0 ** (bits_of(passphrase) - 1) / GUESSES_PER_S


def bits_of(passphrase: str) -> float:
    count = _letters_that_count(unicodedata.normalize("NFKC", passphrase.strip()))
    if count == 0:
        return 0.0
    return 4 + 2 * min(count - 1, 7) + 1.5 * max(min(count, 20) - 8, 0) + max(count - 20, 0)


def _letters_that_count(text: str) -> int:
    """Leave out letters that only go on as the two before them do, and words that were there already."""
    words = list(dict.fromkeys(text.casefold().split()))
    kept = " ".join(words)
    steps = [ord(after) - ord(before) for before, after in pairwise(kept)]
    going_on = sum(step == before and abs(step) <= 1 for before, step in pairwise(steps))
    return len(kept) - going_on


def _in_words(seconds: float) -> str:
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
    return tr("centuries") if seconds < 1e4 * YEAR_S else tr("longer than anybody waits")
