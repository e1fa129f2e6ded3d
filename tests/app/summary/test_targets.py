"""targets.csv: what the notes of walks say of their targets, and nothing else that somebody noted."""

from dataclasses import replace
from typing import Any

import pytest

from app.summary.targets import HEADER, target_rows
from core.body import Side
from core.session import Recording, RecordingKind
from core.targets import Target, TargetMeasure, TargetTally, with_tallies

WALK = Recording("walk 1", RecordingKind.WALKING, "walk_1", {}, condition="=Shoes")
TALLIES = (
    TargetTally(Target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, 55), 2, 3),
    TargetTally(Target(TargetMeasure.CADENCE, None, 110), 4, 4),
)


def test_each_target_of_a_walk_has_its_row() -> None:
    noted = replace(WALK, note=with_tallies("A stick was used.", TALLIES))
    one, two = [dict(zip(HEADER, row, strict=True)) for row in target_rows([WALK, noted])]
    assert (one["measure"], one["side"], one["target"], one["unit"]) == ("knee_swing_peak", "left", "55", "deg")
    assert (one["reached"], one["strides"], one["reached_percent"]) == ("2", "3", "66.7")
    assert (two["measure"], two["side"], two["reached_percent"]) == ("cadence", "", "100.0")
    assert one["condition"] == "'=Shoes"  # no spreadsheet works it out


@pytest.mark.parametrize("changes", [{"note": "A stick was used."}, {"is_kept": False}])
def test_a_walk_without_targets_or_that_does_not_count_has_none(changes: dict[str, Any]) -> None:
    noted = replace(WALK, note=with_tallies("", TALLIES))
    assert len([*target_rows([noted])]) == 2
    assert [*target_rows([replace(noted, **changes)])] == []
