"""Tests of the published changes of timed tests: their order, their sources, and which of them print a dagger."""

import re

from core.timed.measures import COLUMNS, PROTOCOLS
from core.timed.protocols import TimedProtocol
from core.verdicts.published_changes import PUBLISHED, ChangeKind, Population, published_changes

SPEED = COLUMNS[TimedProtocol.TEN_METRES]


def test_every_figure_is_of_a_test_with_a_source_and_none_is_twice() -> None:
    assert {one.column for one in PUBLISHED} <= set(PROTOCOLS)
    assert len({(one.column, one.population, one.kind) for one in PUBLISHED}) == len(PUBLISHED)
    for one in PUBLISHED:
        assert 0.0 < one.low <= one.high
        assert one.sources
        assert len(set(one.sources)) == len(one.sources)
        assert all(re.search(r"\b(19|20)\d\d\b", source) for source in one.sources)


def test_a_figure_of_fewer_than_two_sources_that_were_read_is_unverified() -> None:
    found = {(one.column, one.population, one.kind): one for one in PUBLISHED}
    assert found[SPEED, Population.STROKE, ChangeKind.DETECTABLE].is_verified
    assert not found[SPEED, Population.LIMB_LOSS, ChangeKind.IMPORTANT].is_verified
    assert not found["six_minutes_distance_m", Population.LIMB_LOSS, ChangeKind.DETECTABLE].read
    assert sum(one.is_verified for one in PUBLISHED) == 6


def test_figures_are_found_by_test_and_population() -> None:
    stroke = published_changes(SPEED, Population.STROKE)
    assert {one.kind for one in stroke} == set(ChangeKind)
    assert {one.population for one in published_changes(SPEED)} == set(Population)
    assert published_changes("knee_range_deg") == ()
