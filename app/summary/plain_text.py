"""Make every typed text printable. What the bundled fonts cannot show becomes a box, what nobody can see is dropped.

A single character without a glyph, a control character or a private one would refuse the whole document under PDF/A
and PDF/UA: a name must never prevent a report.
"""

import struct
import unicodedata
from functools import cache
from importlib.resources import files

from app.wording.translation import tr

FONT_FILES = (
    "Inter-Regular.otf",
    "Inter-Medium.otf",
    "Inter-SemiBold.otf",
    "InterDisplay-SemiBold.otf",
    "NotoSansHebrew-Regular.ttf",
    "NotoSansArabic-Regular.ttf",
)
BOX = "□"
MAX_MARKS = 2  # combining marks on one character: more climb into the lines above
MAX_RUN = 22  # characters without a space, beyond which a line may break within them
BREAK_EVERY = 6
UNSEEN = {"Cc", "Cf", "Cs", "Co", "Cn"}
RIGHT_TO_LEFT = ("R", "AL", "AN")
ISOLATE, POP = "\u2068", "\u2069"
BREAK = "\u200b"
MAX_TYPED = 120  # characters of one field, of which the page shows two lines
CONDITION_LENGTH = 32  # within a sentence or a legend


def plain(text: str) -> str:
    """Give one line of typed text as it can be printed: composed, seen, and covered by a bundled font."""
    shown: list[str] = []
    marks = 0
    for character in unicodedata.normalize("NFC", text):
        category = unicodedata.category(character)
        if character.isspace():
            character, category = " ", "Zs"
        if category in UNSEEN:
            continue
        if not category.startswith("M"):
            shown.append(character if ord(character) in coverage() else BOX)
            marks = 0
        elif shown and marks < MAX_MARKS and _has_marks(shown[-1] + character):
            shown[-1] += character
            marks += 1
    if any(unicodedata.bidirectional(letter[0]) in RIGHT_TO_LEFT for letter in shown):
        # a bracket that is turned round is the other one's glyph, and a PDF maps a glyph to text once for all pages
        shown = [" " if unicodedata.mirrored(letter[0]) else letter for letter in shown]
    return " ".join("".join(shown).split())


def typed(text: str, most: int = MAX_TYPED) -> str:
    """Give what the clinic typed, ready to stand within a line of ours."""
    return isolated(breakable(shortened(plain(text), most))) or tr("not recorded")


def plain_lines(text: str) -> list[str]:
    """Give the lines of a longer text, empty ones between paragraphs kept once."""
    lines = [breakable(plain(line)) for line in text.splitlines()]
    return [line for k, line in enumerate(lines) if line or (0 < k < len(lines) - 1 and lines[k - 1])]


def breakable(text: str) -> str:
    """Let a line end within words that have no place to break."""
    return " ".join(word if len(word) <= MAX_RUN else _broken(word) for word in text.split(" "))


def shortened(text: str, most: int) -> str:
    """Cut a text that would take the place of others; what is missing is shown by an ellipsis."""
    return text if len(text) <= most else text[: most - 1].rstrip() + "…"


def isolated(text: str) -> str:
    """Keep a typed text's direction to itself: a Hebrew code would turn the date beside it round."""
    return f"{ISOLATE}{text}{POP}" if text else ""


@cache
def coverage() -> frozenset[int]:
    """Code points that any of the bundled families has a glyph for."""
    return frozenset().union(*_coverages())


@cache
def _coverages() -> tuple[frozenset[int], ...]:
    """Of each family; Inter's weights differ by a few, and a text may be set in any of them."""
    *inter, hebrew, arabic = (frozenset(_covered(font)) for font in font_data())
    return inter[0].intersection(*inter[1:]), hebrew, arabic


def _has_marks(letter: str) -> bool:
    """Check for a non-Inter letter whose marks its font has; with Inter, PDF text would repeat the mark."""
    inter, *others = _coverages()
    return ord(letter[0]) not in inter and any(set(map(ord, letter)) <= covered for covered in others)


@cache
def font_data() -> tuple[bytes, ...]:
    """Every bundled font, as it is in its file."""
    folder = files("resources") / "fonts"
    return tuple((folder / name).read_bytes() for name in FONT_FILES)


def _broken(word: str) -> str:
    """Parts of a word written to the left would be set in the order of ours, so those stand in lines of their own."""
    is_to_left = any(unicodedata.bidirectional(character) in ("R", "AL") for character in word)
    every, between = (MAX_RUN, " ") if is_to_left else (BREAK_EVERY, BREAK)
    return between.join(word[k : k + every] for k in range(0, len(word), every))


def _covered(font: bytes) -> set[int]:
    """Read a font's character map: its segments (format 4, OpenType 1.9) or its groups (format 12)."""
    tables = struct.unpack(">H", font[4:6])[0]
    records = (struct.unpack(">4sIII", font[12 + 16 * k : 28 + 16 * k]) for k in range(tables))
    start = next(offset for tag, _, offset, _ in records if tag == b"cmap")
    count = struct.unpack(">H", font[start + 2 : start + 4])[0]
    found: set[int] = set()
    for k in range(count):
        _, _, offset = struct.unpack(">HHI", font[start + 4 + 8 * k : start + 12 + 8 * k])
        found |= _mapped(font, start + offset)
    return found


def _mapped(font: bytes, at: int) -> set[int]:
    form = struct.unpack(">H", font[at : at + 2])[0]
    if form == 12:
        count = struct.unpack(">I", font[at + 12 : at + 16])[0]
        groups = (struct.unpack(">III", font[at + 16 + 12 * k : at + 28 + 12 * k]) for k in range(count))
        return {code for first, last, _ in groups for code in range(first, last + 1)}
    if form != 4:
        return set()
    segments = struct.unpack(">H", font[at + 6 : at + 8])[0] // 2

    def column(number: int, kind: str) -> tuple[int, ...]:
        begin = at + 14 + 2 * segments * number + (2 if number else 0)  # two bytes of padding after the first
        return struct.unpack(f">{segments}{kind}", font[begin : begin + 2 * segments])

    last, first, delta, offset = column(0, "H"), column(1, "H"), column(2, "h"), column(3, "H")
    offsets_at = at + 16 + 6 * segments
    found = set()
    for k in range(segments):
        for code in range(first[k], last[k] + 1):
            glyph = code + delta[k]
            if offset[k]:
                where = offsets_at + 2 * k + offset[k] + 2 * (code - first[k])
                glyph = struct.unpack(">H", font[where : where + 2])[0]
            if glyph % 65536:
                found.add(code)
    return found - {0xFFFF}
