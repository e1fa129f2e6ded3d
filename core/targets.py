"""A figure that a patient tries to reach with every stride of a walk, and how often that was so.

A value counts as it is shown, rounded to a whole number: who reads 55 has reached 55. How often a target was reached is
kept in the recording's note, a line for each target, so that it goes wherever the recording goes.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from core.body import Side


class TargetMeasure(StrEnum):
    """What is aimed at, one value per stride; more is nearer to the target. The values are the words of targets.csv.

    KNEE_SWING_PEAK: largest knee flexion of the swing, deg; an angle from the zero of standing.
    FOOT_STRIKE: pitch of the foot at initial contact, deg, toes up positive, zero as it lay in the stance before.
    STANCE_RATIO: duration of a leg's stance in percent of that of the other leg's latest stance: the symmetry ratio
    (Patterson et al. 2010, Gait Posture 31:241; the source could not be read) of single stances.
    CADENCE: two steps over the duration of the stride that has just ended, steps/min, of either foot.
    """

    KNEE_SWING_PEAK = "knee_swing_peak"
    FOOT_STRIKE = "foot_strike"
    STANCE_RATIO = "stance_ratio"
    CADENCE = "cadence"

    @property
    def unit(self) -> str:
        return _UNITS[self]

    @property
    def has_side(self) -> bool:
        """Whether it is of one leg; the cadence is of both."""
        return self is not TargetMeasure.CADENCE

    @property
    def limits(self) -> tuple[int, int]:
        """Between which a target makes sense, in its unit."""
        return _LIMITS[self]


_UNITS = {
    TargetMeasure.KNEE_SWING_PEAK: "deg",
    TargetMeasure.FOOT_STRIKE: "deg",
    TargetMeasure.STANCE_RATIO: "%",
    TargetMeasure.CADENCE: "steps/min",
}
_LIMITS = {  # wider than any walk; they catch figures typed into the wrong field
    TargetMeasure.KNEE_SWING_PEAK: (5, 100),
    TargetMeasure.FOOT_STRIKE: (-20, 45),
    TargetMeasure.STANCE_RATIO: (50, 150),
    TargetMeasure.CADENCE: (20, 180),
}


@dataclass(frozen=True, slots=True)
class Target:
    """`value` in the measure's unit; `side` is None where the measure is of both legs."""

    measure: TargetMeasure
    side: Side | None
    value: int

    def is_reached(self, shown: int) -> bool:
        """Whether a value, rounded as it is shown, reaches it."""
        return shown >= self.value


@dataclass(frozen=True, slots=True)
class TargetTally:
    """How many of the `strides` with a value reached the target."""

    target: Target
    reached: int
    strides: int

    @property
    def reached_percent(self) -> float:
        """Share of the strides; NaN where there are none."""
        return 100.0 * self.reached / self.strides if self.strides else math.nan


def shown_value(value: float) -> int:
    """The whole number that a value is shown and judged as; halves go up."""
    return math.floor(value + 0.5)


def with_tallies(note: str, tallies: Iterable[TargetTally]) -> str:
    """A recording's note with a line for each tally below what it contains already."""
    lines = [_line(tally) for tally in tallies if tally.strides]
    return "\n".join(filter(None, [note, *lines]))


def tallies_of(note: str) -> tuple[TargetTally, ...]:
    """What `with_tallies` added to a note; lines that somebody has changed otherwise are passed over."""
    found = []
    for line in note.splitlines():
        read = _LINE.fullmatch(line.strip())
        if read is None or read["measure"] not in list(TargetMeasure):
            continue
        measure = TargetMeasure(read["measure"])
        if measure.has_side is (read["side"] == _BOTH) or measure.unit != read["unit"]:
            continue
        side = Side(read["side"]) if measure.has_side else None
        reached, strides = int(read["reached"]), int(read["strides"])
        if 0 < strides >= reached:
            found.append(TargetTally(Target(measure, side, int(read["value"])), reached, strides))
    return tuple(found)


_BOTH = "both"
_LINE = re.compile(
    r"target (?P<measure>\w+) (?P<side>left|right|both) (?P<value>-?[0-9]{1,3}) (?P<unit>deg|%|steps/min): "
    r"(?P<reached>[0-9]{1,6}) of (?P<strides>[0-9]{1,6}) strides"
)


def _line(tally: TargetTally) -> str:
    target = tally.target
    aimed = f"target {target.measure} {target.side or _BOTH} {target.value} {target.measure.unit}"
    return f"{aimed}: {tally.reached} of {tally.strides} strides"
