"""English made as long as German. It checks that every page has the room, and that every sentence passes the catalogue.

Letters are doubled all along until a sentence is 35 % longer, vowels wear a mark that English does not have, and
brackets show where a sentence begins and ends. What is in braces is left alone, since it is a figure's name.
"""

import re
from gettext import NullTranslations

LONGER = 1.35  # German against English, as the screens were designed for
MARKED = str.maketrans("aeiouyAEIOUY", "äéïöüýÄÉÏÖÜÝ")
FIELD = re.compile(r"(\{[^{}]*\})")


class PseudoLanguage(NullTranslations):
    def gettext(self, message: str) -> str:
        return lengthened(message)

    def ngettext(self, msgid1: str, msgid2: str, n: int) -> str:
        return lengthened(msgid1 if n == 1 else msgid2)


def lengthened(message: str) -> str:
    """Give `message` 35 % longer, as "[Stäärt]"; its fields in braces as they are."""
    stated, done = "", 0
    for piece in FIELD.split(message):
        for part in [piece] if FIELD.fullmatch(piece) else piece:
            done += len(part)
            required = round(LONGER * done) - len(stated)
            marked = part.translate(MARKED) if len(part) == 1 else part
            stated += marked * 2 if part.isalpha() and required >= 2 else marked
    return f"[{stated}]"
