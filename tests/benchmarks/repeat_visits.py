"""Count what is called different on people measured twice: where nothing changed, and where a known change was added.

    GAITWRIGHT_TEST_DATA=... python -m tests.benchmarks.repeat_visits

Feet of healthy people and of people after a stroke at two visits, and of people over their rehabilitation, each leg's
mean, sd, n, standard error and drift (repeat_visits/felius_*.csv); knees of another maker's sensors on two days, and
our simulated ones strapped again. A change is added to the later of two, up and down, and found where it is called with
its own sign. In brackets page one, which needs more than the mark of a table. Required: `LIMITS` of the test
tests/core/verdicts/test_repeat_visits.py.
"""

import math
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from core.parameters import SPEED, STANCE
from core.verdicts.norms import class_of_speed, read_time_distance
from tests.benchmarks.repeated_people import (
    FOOT_ANGLE,
    FOOT_FLAT,
    HEALTHY,
    HEEL_RISE,
    KNEES,
    LENGTH,
    STROKE,
    TIME,
    Repeated,
    Rule,
    after,
    before,
    legs_of_visits,
    other_knees,
    rehabilitation,
    simulated_knees,
    two_visits,
    walks_of_visits,
)

FEET: Mapping[str, tuple[float, ...]] = {  # what is added
    STANCE: (3.0, 4.0, 5.0),
    TIME: (0.06, 0.1),
    SPEED: (0.15, 0.2),
    LENGTH: (0.1, 0.15),
    FOOT_ANGLE: (5.0, 6.0, 8.0),
    HEEL_RISE: (8.0, 10.0),
    FOOT_FLAT: (10.0, 15.0),
}
KNEE_CHANGES = dict.fromkeys(KNEES, (5.0, 8.0, 10.0))
BANDS = Path(__file__).parents[2] / "resources" / "reference_bands"
OF_TIME_AND_DISTANCE = "fukuchi2018_spatiotemporal_overground_by_froude_class.csv"
OWN_SD = 1.1  # of our stance, points
EVENT_BIASES = (0.0, 1.7, 2.2, 2.5, 2.7)  # points
MAX_AWAY_SD = 2.0
HEIGHT_M = 1.7  # where a table asks for everybody's class


def share(calls: Iterable[bool]) -> float:
    """Percent; NaN of nothing."""
    known = list(calls)
    return 100.0 * sum(known) / len(known) if known else math.nan


def called(pairs: Iterable[Repeated], quantity: str, rule: Rule) -> tuple[float, float, float]:
    """The share of pairs that is marked, stated on page one, and beyond what speed makes, percent."""
    calls = [rule(pair) for pair in pairs if pair.quantity == quantity]
    return (
        share(call.is_marked for call in calls),
        share(call.is_on_page_one for call in calls),
        share(call.is_beyond_speed for call in calls),
    )


def found(pairs: Iterable[Repeated], quantity: str, change: float, rule: Rule) -> tuple[float, float]:
    """The share in which an added change is marked, and stated on page one, with its own sign, percent."""
    calls = [
        (sign * call.difference > 0, call)
        for pair in pairs
        if pair.quantity == quantity
        for sign in (1.0, -1.0)
        for call in [rule(pair.with_change(sign * change))]
    ]
    return (
        share(is_right and call.is_marked for is_right, call in calls),
        share(is_right and call.is_on_page_one for is_right, call in calls),
    )


def null_table(sets: Mapping[str, Sequence[Repeated]]) -> Iterator[str]:
    """What is called with nothing added."""
    yield "| quantity | " + " | ".join(f"{name}: before | after | beyond speed" for name in sets) + " |"
    yield "|---" * (1 + 3 * len(sets)) + "|"
    for quantity in _quantities(sets):
        cells = []
        for pairs in sets.values():
            old, new = called(pairs, quantity, before), called(pairs, quantity, after)
            cells += [f"{old[0]:.0f} ({old[1]:.0f})", f"{new[0]:.0f} ({new[1]:.0f})", f"{new[2]:.0f}"]
        yield f"| {quantity} | " + " | ".join(cells) + " |"
    counts = [
        f"{len({pair.person for pair in pairs})} people, {max(Counter(pair.quantity for pair in pairs).values())} pairs"
        for pairs in sets.values()
    ]
    yield f"Percent of {'; '.join(counts)}."


def power_table(sets: Mapping[str, Sequence[Repeated]], changes: Mapping[str, tuple[float, ...]]) -> Iterator[str]:
    """What is found of added changes."""
    yield "| change | " + " | ".join(f"{name}: before | after" for name in sets) + " |"
    yield "|---" * (1 + 2 * len(sets)) + "|"
    for quantity, sizes in changes.items():
        for change in sizes:
            shares = [found(pairs, quantity, change, rule) for pairs in sets.values() for rule in (before, after)]
            yield f"| {quantity} {change:g} | " + " | ".join(f"{one:.0f} ({page:.0f})" for one, page in shares) + " |"


def _quantities(sets: Mapping[str, Sequence[Repeated]]) -> list[str]:
    return list(dict.fromkeys(pair.quantity for pairs in sets.values() for pair in pairs))


def people_called(pairs: Iterable[Repeated], rule: Rule) -> tuple[int, int]:
    """People of whom page one states anything, and people."""
    by_person: dict[str, bool] = {}
    for pair in pairs:
        by_person[pair.person] = by_person.get(pair.person, False) or rule(pair).is_on_page_one
    return sum(by_person.values()), len(by_person)


def band_table(walks: Sequence[tuple[float, tuple[float, ...]]], height_m: float | None) -> Iterator[str]:
    """Healthy walks with a leg whose stance is more than two SD from the band of its class of speed."""
    text = (BANDS / OF_TIME_AND_DISTANCE).read_text(encoding="utf-8")
    bands = {group.speed_class: group.values["stance"] for group in read_time_distance(text)}
    known = [(bands[name], legs) for speed, legs in walks if (name := class_of_speed(speed, height_m)) is not None]
    yield f"{len(known)} walks of {len(walks)} have a class"
    yield "| event bias, points | SD in all | walks with a sentence |"
    yield "|---|---|---|"
    for bias in (None, *EVENT_BIASES):
        sds = [band.sd if bias is None else math.hypot(band.sd, OWN_SD, bias) for band, _ in known]
        stated = [
            max(abs(one - band.mean) for one in legs) > MAX_AWAY_SD * sd
            for (band, legs), sd in zip(known, sds, strict=True)
        ]
        name = "band alone" if bias is None else f"{bias:g}"
        yield f"| {name} | {min(sds):.1f} to {max(sds):.1f} | {sum(stated)}, {share(stated):.0f} % |"


def tables(folder: Path) -> Iterator[str]:
    """Everything, as markdown."""
    twice = {"healthy": two_visits(folder, HEALTHY), "stroke": two_visits(folder, STROKE)}
    following, whole = rehabilitation(folder)
    knees = {"another maker, two days": other_knees(folder), "simulated strappings": simulated_knees(folder)}
    legs = {"healthy": legs_of_visits(folder, HEALTHY), "stroke": legs_of_visits(folder, STROKE)}
    yield "Called where nobody changed, marked in tables (stated on page one)"
    yield from null_table(twice)
    for name, pairs in twice.items():
        counts = ["{} of {}".format(*people_called(pairs, rule)) for rule in (before, after)]
        yield f"People with a false sentence on page one, {name}: before {counts[0]}, after {counts[1]}"
    yield "\nCalled over a rehabilitation"
    yield from null_table({"next visit": following, "first to last": whole})
    yield "\nFound of a change added to the second visit"
    yield from power_table(twice, FEET)
    yield "\nLeft against right, beyond healthy legs"
    yield from null_table(legs)
    yield "\nKnees where nothing changed"
    yield from null_table(knees)
    yield "\nKnees, found of a change added"
    yield from power_table(knees, KNEE_CHANGES)
    for height_m in (None, HEIGHT_M):
        yield f"\nStance beside its band, healthy walks, height {height_m or 'missing'}"
        yield from band_table(walks_of_visits(folder, HEALTHY), height_m)


def main() -> None:
    print(*tables(Path(os.environ["GAITWRIGHT_TEST_DATA"]) / "repeat_visits"), sep="\n")


if __name__ == "__main__":
    main()
