"""Tests that every quantity has all that screens, files and verdicts need of it."""

import pytest

from core.goals import GOAL_COLUMNS, OF_TESTS
from core.parameters import (
    ALIGNED,
    BETWEEN_LEGS,
    BY_COLUMN,
    COMPARED,
    EXCURSIONS,
    MOVEMENTS,
    OF_WALK,
    REGISTRY,
    Parameter,
    ParameterFile,
    QuantityClass,
    Unit,
    unit_of,
)
from core.verdicts.fitting import BY_COLUMN as OF_FITTING
from core.verdicts.quantities import EXCURSIONS_BY_COLUMN, WINDOWS


def is_defined(parameter: Parameter) -> bool:
    """Whether somebody states what it is: the entry, its window or excursion, or the table of fitting."""
    return bool(parameter.definition) or parameter.column in {*WINDOWS, *EXCURSIONS_BY_COLUMN, *OF_FITTING}


def test_each_column_is_described_once() -> None:
    assert len(BY_COLUMN) == len(REGISTRY)


@pytest.mark.parametrize("parameter", REGISTRY, ids=lambda one: one.column)
def test_a_column_ends_in_its_unit_and_is_defined(parameter: Parameter) -> None:
    assert unit_of(parameter.column) is not None
    assert is_defined(parameter) or parameter.file is ParameterFile.WALK


def test_what_lists_name_is_known() -> None:
    listed = {*COMPARED, *BETWEEN_LEGS, *ALIGNED, *OF_WALK, *(column for of in MOVEMENTS.values() for column in of)}
    assert listed <= set(BY_COLUMN)
    assert set(GOAL_COLUMNS) - set(OF_TESTS) == {one.column for one in REGISTRY if one.most is not None}


def test_movements_need_no_zero() -> None:
    classes = {BY_COLUMN[column].rests_on for of in MOVEMENTS.values() for column in of}
    assert classes == {QuantityClass.SHAPE, QuantityClass.EXCURSION}
    assert {f"{one.name}_deg" for one in EXCURSIONS} <= {column for of in MOVEMENTS.values() for column in of}


@pytest.mark.parametrize(
    ("column", "unit"),
    [
        ("speed_m_s", Unit.SPEED),
        ("cadence_steps_min", Unit.CADENCE),
        ("clearance_m", Unit.METRES),
        ("shift_mm", Unit.MILLIMETRES),
        ("percent", Unit.PERCENT),
        ("time_s", Unit.SECONDS),
        ("side", None),
        ("walks", None),
    ],
)
def test_a_unit_is_the_longest_end(column: str, unit: Unit | None) -> None:
    assert unit_of(column) is unit
