"""What was set at a foot beside what is measured: agreement, disagreement, nothing set, and what is not measured."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.summary.comparison import Comparison, Contrast
from app.summary.conditions import Part
from app.summary.set_angle import SetAngle, set_angle, set_angle_in_words
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Side
from tests.core.verdicts.built_walk import calibrations, judged_walk, leg, walk

FRONT = PartChange(ProsthesisPart.FOOT_FRONT_SCREW, angle_deg=3.0)
OF_B = AlignmentChange("Alignment A", (FRONT,))


def part(letter: str, swing_deg: float, change: AlignmentChange | None = None, **more: Any) -> Part:
    found = calibrations()
    left = leg(Side.LEFT)
    swing = {"shank_to_foot_in_swing_rad": np.full(len(left.strides), np.deg2rad(swing_deg))}
    left = replace(left, parameters={**left.parameters, **swing})
    made = Part(letter, f"Alignment {letter}", (judged_walk(walk(left=left), found),), found, alignment=change)
    return replace(made, **more)


def found_of(shown: Part, base: Part, changes: dict[str, AlignmentChange | None]) -> SetAngle | None:
    return set_angle(Comparison(Contrast.CONDITIONS, (base, shown)), shown, base, Side.LEFT, changes)


def words_of(shown: Part, base: Part, change: AlignmentChange | None) -> str:
    found = found_of(shown, base, {"Alignment A": None, "Alignment B": change})
    return set_angle_in_words(found) if found is not None else ""


def test_what_was_set_is_shown_with_what_is_measured() -> None:
    """The foot points 2.8 deg further down: dorsiflexion is what the column counts."""
    assert words_of(part("B", 2.2, OF_B), part("A", 5.0), OF_B) == "Set 3.0° plantarflexion, measured 2.8° (±0.7°)."


def test_a_foot_that_was_not_set_as_stated_is_to_be_checked() -> None:
    stated = words_of(part("B", 4.0, OF_B), part("A", 5.0), OF_B)
    assert stated == "Set 3.0° plantarflexion, measured 1.0° (±0.7°). Check the setting."
    other_way = words_of(part("B", 6.0, OF_B), part("A", 5.0), OF_B)
    assert other_way.startswith("Set 3.0° plantarflexion, measured −1.0°")


@pytest.mark.parametrize(
    ("swing_deg", "stated"),
    [
        (5.4, "Foot angle unchanged (measured 0.4°, ±0.7°). Other changes are not measured."),
        (
            7.0,
            "Foot angle not set, measured 2.0° dorsiflexion (±0.7°). Check the foot. Other changes are not measured.",
        ),
    ],
)
def test_where_nothing_was_set_the_foot_is_unchanged_or_to_be_checked(swing_deg: float, stated: str) -> None:
    pylon = AlignmentChange("Alignment A", (PartChange(ProsthesisPart.PYLON, height_mm=5.0),))
    assert words_of(part("B", swing_deg, pylon), part("A", 5.0), pylon) == stated


def test_with_sensors_strapped_on_again_nothing_is_measured() -> None:
    stated = words_of(part("B", 2.0, OF_B, attachment=1), part("A", 5.0), OF_B)
    assert stated == "The set foot angle cannot be measured here."


def test_without_a_chain_between_two_conditions_nothing_is_stated() -> None:
    assert found_of(part("B", 2.0), part("A", 5.0), {"Alignment A": None, "Alignment B": None}) is None


def test_a_repeat_of_a_condition_has_nothing_set_whatever_was_in_between() -> None:
    first = part("A", 5.0)
    again = replace(part("A", 5.1), letter="A2")
    found = found_of(again, first, {"Alignment A": None, "Alignment B": OF_B})
    assert found is not None
    assert found.set_deg == 0.0
    assert found.agrees


def test_the_changes_of_a_chain_add_up() -> None:
    of_c = AlignmentChange(
        "Alignment B", (replace(FRONT, angle_deg=-1.0), PartChange(ProsthesisPart.SHOE, text="8 mm"))
    )
    shown = replace(part("B", 3.0, of_c), letter="C", name="Alignment C")
    found = found_of(shown, part("A", 5.0), {"Alignment A": None, "Alignment B": OF_B, "Alignment C": of_c})
    assert found is not None
    assert (found.set_deg, found.has_other_parts, found.agrees) == (2.0, True, True)
