"""Spoilt files raise nothing but refusals, end nothing, and nothing is written."""

from collections.abc import Iterator

import pytest

from devices.files.limited_reader import LimitedReader
from tests.safety.file_fuzz import fuzz, importers

FILES = 200


@pytest.fixture(scope="module")
def reader() -> Iterator[LimitedReader]:
    """One process for all of them: its start takes longer than the files."""
    reader = LimitedReader()
    yield reader
    reader.close()


@pytest.mark.endurance
@pytest.mark.parametrize("name", importers())
def test_a_spoilt_file_is_read_or_refused(name: str, reader: LimitedReader) -> None:
    spoilable = importers()[name]
    found = fuzz(spoilable, FILES, 7, reader)
    assert found.faults == []
    assert found.count["read"] > 0
    assert found.count["refused"] > (0 if spoilable.is_stream else FILES / 2)
