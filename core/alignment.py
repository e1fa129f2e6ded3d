"""What was changed at a prosthesis before a walk: parts with angle, screw turns, shift and height, as a chain.

Each condition ("Alignment B") names what was changed and from which condition ("Alignment A"). The changes of a chain
add up, and what undoes them is their sum turned round. Nothing here is measured: a person has stated it, and no angle
is computed from it.

Signs: `angle_deg` of the foot's front and back screws is positive where the foot is plantarflexed, of its inner and
outer screws where it is everted, of its rotation where the toes turn out; of the socket's screws where the socket is
flexed or abducted; of any other part as its maker counts. `turns` are positive out of the thread; `shift_mm` backwards,
of inner and outer screws outwards; `height_mm` where the part is longer or higher.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from enum import StrEnum


class ProsthesisPart(StrEnum):
    """Where something was turned, shifted or exchanged. Screws are those of the adapter that holds the part."""

    FOOT_FRONT_SCREW = "foot_front_screw"
    FOOT_BACK_SCREW = "foot_back_screw"
    FOOT_INNER_SCREW = "foot_inner_screw"
    FOOT_OUTER_SCREW = "foot_outer_screw"
    FOOT_ROTATION = "foot_rotation"
    SOCKET_FRONT_SCREW = "socket_front_screw"
    SOCKET_BACK_SCREW = "socket_back_screw"
    SOCKET_INNER_SCREW = "socket_inner_screw"
    SOCKET_OUTER_SCREW = "socket_outer_screw"
    KNEE_UNIT = "knee_unit"
    PYLON = "pylon"
    SHOE = "heel_or_shoe"
    OTHER = "other"

    @property
    def is_frontal(self) -> bool:
        """Whether its angle and shift lie in the frontal plane."""
        return self.value.endswith(("_inner_screw", "_outer_screw"))


@dataclass(frozen=True, slots=True)
class FigureLimits:
    """In which steps a figure is entered, and how much is plausible in one change, either way."""

    step: float
    most: float


# Steps as prosthetists state them; the limits are beyond what adapters and pylons give, and catch slips of the hand.
FIGURES: Mapping[str, FigureLimits] = {
    "angle_deg": FigureLimits(0.5, 30.0),
    "turns": FigureLimits(0.125, 12.0),
    "shift_mm": FigureLimits(1.0, 60.0),
    "height_mm": FigureLimits(1.0, 100.0),
}
MOST_TEXT = 200  # letters: a line of a list, not a letter to somebody
MOST_PARTS = 20  # of one change


@dataclass(frozen=True, slots=True)
class PartChange:
    """What was changed at one part; `text` is typed freely. Signs as in the module's docstring.

    Raises
    ------
    ValueError
        A figure that is off its step or beyond its limit, a text that is too long, or nothing at all.
    """

    part: ProsthesisPart
    angle_deg: float = 0.0
    turns: float = 0.0
    shift_mm: float = 0.0
    height_mm: float = 0.0
    text: str = ""

    def __post_init__(self) -> None:
        for name, limits in FIGURES.items():
            value = getattr(self, name)
            if not math.isfinite(value) or abs(value) > limits.most or not (value / limits.step).is_integer():
                raise ValueError(f"{name} is {value}, expected steps of {limits.step:g} up to {limits.most:g}")
        if len(self.text) > MOST_TEXT:
            raise ValueError(f"text has {len(self.text)} letters, expected {MOST_TEXT} at most")
        if not self.text.strip() and not any(getattr(self, name) for name in FIGURES):
            raise ValueError(f"nothing is stated of {self.part}")


@dataclass(frozen=True, slots=True)
class AlignmentChange:
    """What was changed before a walk, and `since` which condition.

    Raises
    ------
    ValueError
        No part, or too many.
    """

    since: str
    parts: tuple[PartChange, ...]

    def __post_init__(self) -> None:
        if not 0 < len(self.parts) <= MOST_PARTS:
            raise ValueError(f"{len(self.parts)} parts, expected 1 to {MOST_PARTS}")


@dataclass(frozen=True, slots=True)
class NetChange:
    """What several changes of one part come to. `done`, `undone`: the texts that do not cancel, in their order."""

    part: ProsthesisPart
    angle_deg: float = 0.0
    turns: float = 0.0
    shift_mm: float = 0.0
    height_mm: float = 0.0
    done: tuple[str, ...] = ()
    undone: tuple[str, ...] = ()

    @property
    def is_nothing(self) -> bool:
        return not (self.done or self.undone or any(getattr(self, name) for name in FIGURES))


def net_of(changes: Iterable[PartChange]) -> tuple[NetChange, ...]:
    """Changes one after the other as one: each part once, in the order of `ProsthesisPart`; what cancels is gone."""
    return added(*(_as_net(change) for change in changes))


def added(*changes: NetChange) -> tuple[NetChange, ...]:
    """The sum of changes, in the order in which they were made."""
    of_part: dict[ProsthesisPart, NetChange] = {}
    for change in changes:
        before = of_part.get(change.part, NetChange(change.part))
        figures = {name: getattr(before, name) + getattr(change, name) for name in FIGURES}
        done, undone = list(before.done), list(before.undone)
        for text in change.done:
            _cancel(text, undone, done)
        for text in change.undone:
            _cancel(text, done, undone)
        of_part[change.part] = NetChange(change.part, **figures, done=tuple(done), undone=tuple(undone))
    return tuple(of_part[part] for part in ProsthesisPart if part in of_part and not of_part[part].is_nothing)


def undoing(changes: Sequence[NetChange]) -> tuple[NetChange, ...]:
    """What undoes all of `changes`."""
    return tuple(
        replace(
            change,
            **{name: 0.0 - getattr(change, name) for name in FIGURES},  # not -0.0
            done=change.undone[::-1],
            undone=change.done[::-1],
        )
        for change in changes
    )


def changed_between(
    changes: Mapping[str, AlignmentChange | None], start: str, end: str
) -> tuple[NetChange, ...] | None:
    """Sum the changes from one condition to another; None where no chain connects them."""
    back, forth = _to_root(changes, start), _to_root(changes, end)
    shared = next((one for one in back if one in forth), None)
    if shared is None:
        return None
    undone = [change for one in back[: back.index(shared)] for change in undoing(_of(changes, one))]
    done = [change for one in forth[: forth.index(shared)][::-1] for change in _of(changes, one)]
    return added(*undone, *done)


def alignment_table(change: AlignmentChange) -> dict[str, object]:
    """The change as plain values, for a file: what is zero or empty is left out."""
    parts = [{name: value for name, value in asdict(one).items() if value} for one in change.parts]
    return {"since": change.since, "parts": [one | {"part": str(one["part"])} for one in parts]}


def alignment_of_table(table: object) -> AlignmentChange | None:
    """What `alignment_table` was given; None of anything else."""
    if not isinstance(table, Mapping) or set(table) != {"since", "parts"}:
        return None
    since, parts = table["since"], table["parts"]
    if not isinstance(since, str) or not isinstance(parts, Sequence) or isinstance(parts, str):
        return None
    try:
        return AlignmentChange(since, tuple(map(_part_of_table, parts)))
    except (ValueError, OverflowError):  # a whole number beyond all floats
        return None


def alignment_text(change: AlignmentChange | None) -> str:
    """The change in one line of JSON; empty where nothing was changed."""
    return json.dumps(alignment_table(change), separators=(",", ":")) if change is not None else ""


def alignment_of_text(text: str) -> AlignmentChange | None:
    """What `alignment_text` was given; None of anything else."""
    try:
        return alignment_of_table(json.loads(text)) if text else None
    except (ValueError, RecursionError):
        return None


def _as_net(change: PartChange) -> NetChange:
    text = change.text.strip()
    done = (text,) if text else ()
    return NetChange(change.part, change.angle_deg, change.turns, change.shift_mm, change.height_mm, done)


def _of(changes: Mapping[str, AlignmentChange | None], condition: str) -> tuple[NetChange, ...]:
    found = changes.get(condition)
    return tuple(map(_as_net, found.parts)) if found is not None else ()


def _cancel(text: str, opposite: list[str], own: list[str]) -> None:
    """Take the text from what it undoes, the latest first, or add it to its own."""
    if text in opposite:
        del opposite[len(opposite) - 1 - opposite[::-1].index(text)]
    else:
        own.append(text)


def _to_root(changes: Mapping[str, AlignmentChange | None], condition: str) -> list[str]:
    """The condition and those that it came from, the nearest first; a ring ends where it closes."""
    found: list[str] = []
    while condition not in found:
        found.append(condition)
        change = changes.get(condition)
        if change is None:
            break
        condition = change.since
    return found


def _part_of_table(table: object) -> PartChange:
    known = {field.name for field in fields(PartChange)}
    if not isinstance(table, Mapping) or "part" not in table or not set(table) <= known:
        raise ValueError("a part of another form")
    figures = {name: table[name] for name in FIGURES if name in table}
    if any(isinstance(value, bool) or not isinstance(value, int | float) for value in figures.values()):
        raise ValueError("a figure that is no number")
    text = table.get("text", "")
    if not isinstance(text, str) or not isinstance(table["part"], str):
        raise ValueError("words that are no text")
    return PartChange(
        ProsthesisPart(table["part"]), **{name: float(value) for name, value in figures.items()}, text=text
    )
