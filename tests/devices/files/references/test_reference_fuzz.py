"""Spoilt references raise nothing but refusals, end nothing, and nothing is written."""

import pytest

from tests.safety.file_fuzz import fuzz_each
from tests.safety.reference_fuzz import reference_readers


@pytest.mark.endurance
@pytest.mark.parametrize("name", ["csv", "opensim", "visual3d", "c3d"])
def test_a_spoilt_reference_is_read_or_refused(name: str) -> None:
    ((_, found),) = fuzz_each(reference_readers(), 100, 7, [name])
    assert found.faults == []
    assert found.count["read"] > 0
    assert found.count["refused"] > 0
