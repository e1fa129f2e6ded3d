"""What was changed at a prosthesis before a walk: angle, turns, shift, height, program or setting, as a chain.

Each condition ("Alignment B") names what was changed and from which condition ("Alignment A"). The changes of a chain
add up, and what undoes them is their sum turned round. A program and a setting go from one state to another; of
several changes the first state and the last count. A condition may state which earlier one it returns to: it is that
one again. Nothing here is measured: a person has stated it, and no angle is computed from it.

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
from typing import Any


class ProsthesisPart(StrEnum):
    """Where something was turned, shifted or exchanged. Screws are those of the adapter that holds the part."""

    FOOT_FRONT_SCREW = "foot_front_screw"
    FOOT_BACK_SCREW = "foot_back_screw"
    FOOT_INNER_SCREW = "foot_inner_screw"
    FOOT_OUTER_SCREW = "foot_outer_screw"
    FOOT_ROTATION = "foot_rotation"
    FOOT = "foot"
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
SETTINGS = ("setting_before", "setting_value")
WORDS = ("text", "program_before", "program", "setting")
MOST_TEXT = 200  # letters: a line of a list, not a letter to somebody
MOST_NAME = 40  # letters of a program or a setting, as makers call them
MOST_SETTING = 9999.0  # of a setting, either way: makers count in percent, newton metres or steps
MOST_PARTS = 20  # of one change


@dataclass(frozen=True, slots=True)
class Switched:
    """A program (`name` is empty, states are names) or a named setting (states are numbers); None: not recorded."""

    name: str
    before: str | float | None
    after: str | float | None

    @property
    def is_nothing(self) -> bool:
        return _folded(self.before) == _folded(self.after)


@dataclass(frozen=True, slots=True)
class PartChange:
    """What was changed at one part; `text` is typed freely. Signs as in the module's docstring.

    `program`, `program_before`: names; empty: not recorded. `setting` names a number, `setting_value` now and
    `setting_before`; None: not recorded.

    Raises
    ------
    ValueError
        A figure that is off its step or beyond its limit, a text that is too long, a setting without a name or a value,
        or nothing at all.
    """

    part: ProsthesisPart
    angle_deg: float = 0.0
    turns: float = 0.0
    shift_mm: float = 0.0
    height_mm: float = 0.0
    text: str = ""
    program_before: str = ""
    program: str = ""
    setting: str = ""
    setting_before: float | None = None
    setting_value: float | None = None

    def __post_init__(self) -> None:
        for name, limits in FIGURES.items():
            value = getattr(self, name)
            if not math.isfinite(value) or abs(value) > limits.most or not (value / limits.step).is_integer():
                raise ValueError(f"{name} is {value}, expected steps of {limits.step:g} up to {limits.most:g}")
        if len(self.text) > MOST_TEXT:
            raise ValueError(f"text has {len(self.text)} letters, expected {MOST_TEXT} at most")
        if max(len(one) for one in (self.program_before, self.program, self.setting)) > MOST_NAME:
            raise ValueError(f"a name is too long, expected {MOST_NAME} letters at most")
        values = [one for one in (self.setting_before, self.setting_value) if one is not None]
        if bool(values) != bool(self.setting.strip()) or not all(abs(one) <= MOST_SETTING for one in values):
            raise ValueError(f"{self.setting!r} is {values}, expected a name and numbers up to {MOST_SETTING:g}")
        if not self.text.strip() and not any(getattr(self, name) for name in FIGURES) and not self.switched:
            raise ValueError(f"nothing is stated of {self.part}")

    @property
    def switched(self) -> tuple[Switched, ...]:
        """Its program and its setting, where one is stated."""
        before, after = self.program_before.strip() or None, self.program.strip() or None
        found = [Switched("", before, after)] if before or after else []
        if self.setting.strip():
            found.append(Switched(self.setting.strip(), self.setting_before, self.setting_value))
        return tuple(found)


@dataclass(frozen=True, slots=True)
class AlignmentChange:
    """What was changed before a walk, and `since` which condition.

    `returns_to`: the earlier condition that this one is again; its parts state what was undone.

    Raises
    ------
    ValueError
        No part, unless it returns, or too many.
    """

    since: str
    parts: tuple[PartChange, ...]
    returns_to: str = ""

    def __post_init__(self) -> None:
        least = 0 if self.returns_to else 1
        if not least <= len(self.parts) <= MOST_PARTS:
            raise ValueError(f"{len(self.parts)} parts, expected {least} to {MOST_PARTS}")


def condition_returned_to(condition: str, change: AlignmentChange | None) -> str:
    """Give a walk's condition, or the earlier one that the prosthesis was put back to by the `change` before it."""
    return (change.returns_to if change is not None else "") or condition


@dataclass(frozen=True, slots=True)
class NetChange:
    """What several changes of one part come to. `done`, `undone`: the texts that do not cancel, in their order.

    `switched`: its program and settings, each once.
    """

    part: ProsthesisPart
    angle_deg: float = 0.0
    turns: float = 0.0
    shift_mm: float = 0.0
    height_mm: float = 0.0
    done: tuple[str, ...] = ()
    undone: tuple[str, ...] = ()
    switched: tuple[Switched, ...] = ()

    @property
    def is_nothing(self) -> bool:
        words = self.done or self.undone or self.switched
        return not (words or any(getattr(self, name) for name in FIGURES))


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
        switched = _switched_on(before.switched, change.switched)
        of_part[change.part] = NetChange(
            change.part, **figures, done=tuple(done), undone=tuple(undone), switched=switched
        )
    return tuple(of_part[part] for part in ProsthesisPart if part in of_part and not of_part[part].is_nothing)


def undoing(changes: Sequence[NetChange]) -> tuple[NetChange, ...]:
    """What undoes all of `changes`."""
    return tuple(
        replace(
            change,
            **{name: 0.0 - getattr(change, name) for name in FIGURES},  # not -0.0
            done=change.undone[::-1],
            undone=change.done[::-1],
            switched=tuple(Switched(one.name, one.after, one.before) for one in change.switched),
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
    undone, done = (
        [change for one in way[: way.index(shared)][::-1] for change in _of(changes, one)] for way in (back, forth)
    )
    return added(*undoing(added(*undone)), *done)


def root_of(changes: Mapping[str, AlignmentChange | None], condition: str) -> str:
    """The condition that its chain began with; itself where nothing was changed."""
    return _to_root(changes, condition)[-1]


def alignment_table(change: AlignmentChange) -> dict[str, object]:
    """The change as plain values, for a file: what is empty is left out, and so is a zero that is no setting's."""
    parts = [
        {name: value for name, value in asdict(one).items() if value or (name in SETTINGS and value is not None)}
        for one in change.parts
    ]
    table: dict[str, object] = {"since": change.since, "parts": [one | {"part": str(one["part"])} for one in parts]}
    return table | ({"returns_to": change.returns_to} if change.returns_to else {})


def alignment_of_table(table: object) -> AlignmentChange | None:
    """What `alignment_table` was given; None of anything else."""
    if not isinstance(table, Mapping) or set(table) | {"returns_to"} != {"since", "parts", "returns_to"}:
        return None
    since, parts, returns_to = table["since"], table["parts"], table.get("returns_to", "")
    if not isinstance(since, str) or not isinstance(returns_to, str):
        return None
    if not isinstance(parts, Sequence) or isinstance(parts, str):
        return None
    try:
        return AlignmentChange(since, tuple(map(_part_of_table, parts)), returns_to)
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
    figures = {name: getattr(change, name) for name in FIGURES}
    return NetChange(change.part, **figures, done=done, switched=_switched_on((), change.switched))


def _of(changes: Mapping[str, AlignmentChange | None], condition: str) -> tuple[NetChange, ...]:
    """What was changed before a condition; nothing where it is an earlier one again."""
    found = changes.get(condition)
    return tuple(map(_as_net, found.parts)) if found is not None and not found.returns_to else ()


def _switched_on(before: Sequence[Switched], then: Sequence[Switched]) -> tuple[Switched, ...]:
    """Programs and settings after one another, each once, from its first state to its last."""
    found = {one.name.casefold(): one for one in before}
    for one in then:
        first = found.get(one.name.casefold())
        found[one.name.casefold()] = one if first is None else Switched(first.name, first.before, one.after)
    return tuple(found[name] for name in sorted(found) if not found[name].is_nothing)


def _folded(state: str | float | None) -> str | float | None:
    return state.casefold() if isinstance(state, str) else state


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
        condition = change.returns_to or change.since
    return found


def _part_of_table(table: object) -> PartChange:
    known = {field.name for field in fields(PartChange)}
    if not isinstance(table, Mapping) or "part" not in table or not set(table) <= known:
        raise ValueError("a part of another form")
    figures = {name: table[name] for name in (*FIGURES, *SETTINGS) if name in table}
    if any(isinstance(value, bool) or not isinstance(value, int | float) for value in figures.values()):
        raise ValueError("a figure that is no number")
    given: dict[str, Any] = {name: table[name] for name in WORDS if name in table}
    if not all(isinstance(value, str) for value in (*given.values(), table["part"])):
        raise ValueError("words that are no text")
    given |= {name: float(value) for name, value in figures.items()}
    return PartChange(ProsthesisPart(table["part"]), **given)
