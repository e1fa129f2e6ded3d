"""What tests of batches get: worker processes that find the tasks of tests, however the tests were started."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[4]


@pytest.fixture(autouse=True)
def _workers_find_the_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT)  # which a worker is given by the process that starts it
