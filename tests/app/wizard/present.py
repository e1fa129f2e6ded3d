"""What has to be there for a test to go on."""

from typing import TypeVar

T = TypeVar("T")


def present(one: T | None) -> T:
    """Give it, or fail the test: it is missing."""
    assert one is not None
    return one
