"""Tests that the gravest reason decides and that every reason stays."""

import pytest

from core.body import Joint, Side
from core.verdicts.model import (
    NOT_MEASURED,
    READ,
    Assessment,
    GateReason,
    JointVerdicts,
    LegVerdicts,
    Verdict,
    Verdicts,
    assess,
    pooled,
    together,
    worst,
)

CARE = GateReason("drift", Verdict.CARE, 4.0, 3.0, "deg")
GRAVE = GateReason("axis", Verdict.NOT_REPORTED, 12.0, 9.0, "deg")


def test_the_words_are_those_of_the_files() -> None:
    assert [str(verdict) for verdict in Verdict] == ["read", "care", "withheld", "not_measured"]


def test_without_a_reason_a_quantity_can_be_read() -> None:
    assert assess([]) == READ
    assert worst([]) is Verdict.READ


def test_the_gravest_reason_decides_and_comes_first() -> None:
    found = assess([CARE, GRAVE, CARE])
    assert found.verdict is Verdict.NOT_REPORTED
    assert found.reasons == (GRAVE, CARE, CARE)
    assert assess([CARE]).verdict is Verdict.CARE


@pytest.mark.parametrize(
    ("verdict", "is_reported"),
    [(Verdict.READ, True), (Verdict.CARE, True), (Verdict.NOT_REPORTED, False), (Verdict.NOT_MEASURED, False)],
)
def test_a_figure_is_reported_while_it_is_not_not_reported(verdict: Verdict, is_reported: bool) -> None:
    assert Assessment(verdict).is_reported is is_reported


def test_what_needs_two_quantities_is_as_bad_as_the_worse_and_gives_each_reason_once() -> None:
    found = together([assess([CARE]), assess([GRAVE, CARE]), READ])
    assert found.verdict is Verdict.NOT_REPORTED
    assert found.reasons == (GRAVE, CARE)
    assert together([READ, NOT_MEASURED]).verdict is Verdict.NOT_MEASURED
    assert together([READ, READ]) == READ


def test_what_nobody_wore_was_not_measured() -> None:
    nothing = Verdicts()
    assert nothing.joint(Joint.LEFT_KNEE) == JointVerdicts(NOT_MEASURED, NOT_MEASURED, NOT_MEASURED)
    assert nothing.leg(Side.RIGHT) == LegVerdicts(NOT_MEASURED, NOT_MEASURED)
    assert nothing.between.verdict is Verdict.NOT_MEASURED


def test_walks_taken_together_are_as_bad_as_the_worst_of_them() -> None:
    good = Verdicts(
        {Joint.LEFT_KNEE: JointVerdicts(READ, READ, READ), Joint.LEFT_ANKLE: JointVerdicts(READ, READ, READ)},
        {Side.LEFT: LegVerdicts(READ, assess([CARE]))},
        READ,
    )
    bad = Verdicts(
        {Joint.LEFT_KNEE: JointVerdicts(assess([CARE]), assess([GRAVE]), READ)},
        {Side.LEFT: LegVerdicts(assess([GRAVE]), READ)},
        assess([GRAVE]),
    )
    found = pooled([good, bad])
    knee, ankle = found.joint(Joint.LEFT_KNEE), found.joint(Joint.LEFT_ANKLE)
    assert (knee.shape.verdict, knee.height.verdict, knee.sign.verdict) == (
        Verdict.CARE,
        Verdict.NOT_REPORTED,
        Verdict.READ,
    )
    assert ankle == JointVerdicts(READ, READ, READ)  # only one of the walks has it
    assert found.leg(Side.LEFT) == LegVerdicts(assess([GRAVE]), assess([CARE]))
    assert found.between == assess([GRAVE])
    assert set(found.legs) == {Side.LEFT}
    assert pooled([]).between == NOT_MEASURED
