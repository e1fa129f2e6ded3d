"""What tests of sensors share: a radio whose seconds pass at once."""

from collections.abc import Iterator

import pytest

from tests.devices.dot.virtual_time import VirtualRadio


@pytest.fixture
def radio() -> Iterator[VirtualRadio]:
    one = VirtualRadio()
    yield one
    one.close()
