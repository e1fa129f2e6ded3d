"""An output of its own for each test, and a walk that is known sample by sample."""

from collections.abc import Iterator

import pytest

from app.live_output.output import LiveOutput


@pytest.fixture
def output() -> Iterator[LiveOutput]:
    made = LiveOutput()
    yield made
    made.stop()
