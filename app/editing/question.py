"""Question about values that two stations changed differently: the operator chooses whose is to hold."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from app.storage.three_way import MergeConflict

Settle = Callable[[frozenset[str]], None]


@dataclass(frozen=True, slots=True, eq=False)
class EditQuestion:
    """`subject` names what was edited. `settle` takes the fields of which our own value is to hold; none: theirs stay.

    The library holds theirs meanwhile, and ours is in its history.
    """

    subject: str
    contests: Sequence[MergeConflict]
    settle: Settle
