"""What an argument of the command line may be, and the words of several subcommands.

Nothing here imports what computes, so that `--help` and a refusal come at once: words that stand for the core's own are
repeated, and a test holds them to those.
"""

import argparse
import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from uuid import UUID

from core.parameters import BY_COLUMN
from devices.files.refusal import one_line
from devices.other_packages import IMPORTERS, offers

METHODS = ("robust", "published")
DEFAULT_TAU_S = 2.0
KINDS = ("standing", "free_motion", "walking")
IMPORTED = (
    *("xsens-mtmanager", "movella-dot", "xsens-mti", "ximu3", "ximu", "shimmer", "mvnx", "apdm", "opensim"),
    *("bids-motion", "xdf", "matlab", "parquet", "csv"),
)
ENCODINGS = ("utf-8", "utf-16", "cp1252")
SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|", "space": " "}
DECIMALS = {"point": ".", "comma": ","}
FORCE_UNITS, RATE_UNITS = ("m/s2", "g", "mg"), ("rad/s", "deg/s", "mdeg/s")
TIME_UNITS = ("s", "ms", "us", "ns", "min", "h", "d", "count", "clock")
EXPORTED = ("xlsx", "c3d", "mot", "sto", "fhir", "bids-motion")
LOCALES = {"en": (",", "."), "de": (";", ",")}  # what separates cells, and what is before a fraction
MODELS = ("rajagopal2016", "gait2392")
TYPED = ("device", "aids", "surface", "conditions", "changes")
PAPERS = ("a4", "letter")
EMULATED = ("ximu3", "witmotion", "csv", "xsens-mti", "shimmer3")
AGREEMENT, DIFFERENCES = "agreement.pdf", "differences.csv"

PREFIX = "library:"
LIBRARY = Path("library")  # the word, in place of a folder; a folder of this name is ./library
WHO = "--operator"
PASSPHRASE_FILE = "--passphrase-file"
OF_LIBRARY = "the folder of the library (your own)"
ONE_SESSION = "the session folder, results with their session inside, or library:ID"
ADDRESS = "postgresql://USER@SERVER/DATABASE"
ON_TERMINAL = "The terminal"  # in the place of a file's name in what is stated about interruptions
EXAMPLE = "SELECT condition, count(DISTINCT session), avg(knee_range_deg) FROM parameters GROUP BY condition"


@dataclass(frozen=True, slots=True)
class LibrarySession:
    """`library:ID`: a session of a library, in place of a session folder."""

    id: UUID

    def __str__(self) -> str:
        return f"{PREFIX}{self.id}"

    @classmethod
    def parsed(cls, text: str) -> "LibrarySession":
        """Parse an id with or without its prefix; raises ArgumentTypeError."""
        try:
            return cls(UUID(text.removeprefix(PREFIX)))
        except ValueError:
            raise argparse.ArgumentTypeError(f"{one_line(text)} is not {PREFIX}ID with the id of a session") from None


def session_place(text: str) -> Path | LibrarySession:
    """An argument that names a session: its folder, or library:ID."""
    return LibrarySession.parsed(text) if text.startswith(PREFIX) else Path(text)


def one_of(words: Sequence[str]) -> Callable[[str], str]:
    """An argument that is one of `words`; another is refused."""

    def check(text: str) -> str:
        if text not in words:
            raise argparse.ArgumentTypeError(f"{text} is none of {', '.join(words)}")
        return text

    return check


def imported_format(text: str) -> str:
    """A format of ours, or the name of one that another package offers; looked for where it is none of ours."""
    if text not in IMPORTED:
        others = [offer.name for offer in offers(IMPORTERS, IMPORTED)]
        return one_of((*IMPORTED, *others))(text)
    return text


def positive(text: str) -> float:
    """An argument that is a positive number."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return number


def line_number(text: str) -> int:
    """An argument that is the number of a line, or 0."""
    if not (text.isascii() and text.isdigit() and int(text) <= 1_000_000):
        raise argparse.ArgumentTypeError(f"{text} is no number of a line")
    return int(text)


def three_columns(text: str) -> tuple[str, ...]:
    """An argument that names the columns of three axes, or none of them."""
    columns = tuple(one.strip() for one in next(csv.reader([text]), []))
    if columns != ("none",) and (len(columns) != 3 or not all(columns)):
        raise argparse.ArgumentTypeError(f"{text} does not name three columns as x,y,z, nor none")
    return columns


def worker_count(text: str) -> int:
    """An argument that is a number of workers."""
    if not (text.isascii() and text.isdigit() and 0 < int(text) <= 1000):
        raise argparse.ArgumentTypeError(f"{text} is no number of workers")
    return int(text)


def separator(text: str) -> str:
    """An argument that is what separates cells, or its name."""
    if text not in {**SEPARATORS, **dict.fromkeys(SEPARATORS.values())}:
        raise argparse.ArgumentTypeError(f"{text} is none of {', '.join(SEPARATORS)}")
    return SEPARATORS.get(text, text)


def limit_of(text: str) -> tuple[str, float]:
    """A column and the least change of it that matters."""
    column, _, value = text.partition("=")
    try:
        limit = float(value)
    except ValueError:
        limit = math.nan
    if column not in BY_COLUMN or not limit > 0:
        raise argparse.ArgumentTypeError(f"{text!r} is no column of a table with a value above 0, as knee_range_deg=5")
    return column, limit
