"""What two people changed in one thing at the same time, brought together field by field.

`base` is what was shown when the editing began, `mine` what was made of it, `theirs` what the library holds by now.
What only one side changed is kept; what both changed alike is no conflict; only what both changed differently has
to be asked about. Strides that were left out are one yes or no each, so there nothing has to be asked.
"""

import datetime
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

Value = str | float | bool | tuple[float, ...] | None
Values = Mapping[str, Value]
"""By the field's name, as `edited_fields` names them."""
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Merge:
    """`merged` has all fields; those in `contested` are as theirs. `theirs_only`: what only the other side changed."""

    merged: Values
    contested: tuple[str, ...]
    theirs_only: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MergeConflict:
    """One field that both changed, and differently. `by` is the other's name, empty where nothing names them."""

    field: str
    mine: Value
    theirs: Value
    by: str = ""
    at: datetime.datetime | None = None


@dataclass(frozen=True, slots=True)
class OtherChange:
    """One field that only the other side changed, and what it is now; `by` as in `Contest`."""

    field: str
    value: Value
    by: str = ""
    at: datetime.datetime | None = None


@dataclass(frozen=True, slots=True)
class Edited(Generic[T]):
    """What the library holds after an edit: all of it but what is contested, which is as the other side has it."""

    stored: T
    contests: tuple[MergeConflict, ...] = ()
    others: tuple[OtherChange, ...] = ()


def three_way(base: Values, mine: Values, theirs: Values) -> Merge:
    """Bring both sides together; all three have the same fields."""
    merged: dict[str, Value] = {}
    contested: list[str] = []
    theirs_only: list[str] = []
    for field, own in mine.items():
        before, other = base[field], theirs[field]
        if isinstance(own, tuple) or isinstance(other, tuple):
            merged[field] = _united(before, own, other)
            if other != before and merged[field] != own:
                theirs_only.append(field)
            continue
        merged[field] = own if other == before else other
        if other not in (before, own):
            (theirs_only if own == before else contested).append(field)
    return Merge(merged, tuple(contested), tuple(theirs_only))


def rebased(base: Values, stated: Values, held: Values) -> tuple[dict[str, Value], dict[str, Value]]:
    """Rebase edits since `base` onto `held`; give the new base and the values entered."""
    is_open = {field: value not in (base[field], held[field]) for field, value in stated.items()}
    return (
        {field: base[field] if is_open[field] else held[field] for field in stated},
        {field: stated[field] if is_open[field] else held[field] for field in stated},
    )


def _united(base: Value, mine: Value, theirs: Value) -> tuple[float, ...]:
    before, own, other = (set(one) if isinstance(one, tuple) else set() for one in (base, mine, theirs))
    return tuple(sorted((other | (own - before)) - (before - own)))
