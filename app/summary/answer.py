"""An answer to a comparison: one sentence, what belongs to it, and what kind of answer it is."""

from dataclasses import dataclass
from enum import StrEnum


class Outcome(StrEnum):
    """What kind of answer there is.

    DIFFERS: something exceeds its error. NOTHING: differences were judged, and none exceeds its error. OPEN: nothing
    could be judged.
    """

    DIFFERS = "differs"
    NOTHING = "nothing"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class Answer:
    """`first` is the sentence that is read from afar, `then` what belongs to it; `then` may be empty."""

    outcome: Outcome
    first: str
    then: str = ""
