"""Spoilt files raise nothing but refusals, end nothing, and nothing is written."""

import time
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


def test_the_good_files_are_the_same_whenever_they_are_written(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that a seed gives the same spoilt files again."""
    first = importers()
    monkeypatch.setattr(time, "time", lambda: 1_000_000_000.0)
    monkeypatch.setattr(time, "asctime", lambda: "another day")
    again = importers.__wrapped__()
    assert [name for name in first if first[name].content != again[name].content] == []


@pytest.mark.endurance
@pytest.mark.parametrize("name", importers())
def test_a_spoilt_file_is_read_or_refused(name: str, reader: LimitedReader) -> None:
    spoilable = importers()[name]
    found = fuzz(spoilable, FILES, 7, reader)
    assert found.faults == []
    assert found.count["read"] > 0
    assert found.count["refused"] > (0 if spoilable.is_stream else FILES / 2)
