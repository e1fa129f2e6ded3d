"""Spoilt references raise nothing but refusals, end nothing, and nothing is written."""

import pytest

from devices.files.limited_reader import LimitedReader
from tests.safety.file_fuzz import fuzz
from tests.safety.reference_fuzz import faults_of, reference_readers


@pytest.mark.endurance
@pytest.mark.parametrize("name", ["csv", "opensim", "visual3d", "c3d"])
def test_a_spoilt_reference_is_read_or_refused(name: str) -> None:
    reader = LimitedReader()
    try:
        found = fuzz(reference_readers()[name], 100, 7, reader)
    finally:
        reader.close()
    assert faults_of(name, found) == []
    assert found.outcomes["read"] > 0
    assert found.outcomes["refused"] > 0
