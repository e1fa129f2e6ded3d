"""A library whose time a test moves on."""

import datetime
from collections.abc import Iterator
from dataclasses import replace

import pytest

from app.storage.library import Library
from app.storage.opened import OpenedLibrary
from app.storage.stored import Action


class Later:
    """The time of a library, which a test moves on."""

    def __init__(self) -> None:
        self.days = 0.0

    def __call__(self) -> datetime.datetime:
        return datetime.datetime.now(datetime.UTC) + datetime.timedelta(self.days)


def go_on(timed: OpenedLibrary, later: Later, days: float) -> None:
    """Let time pass in which somebody looks in every six days."""
    while later.days < days:
        later.days = min(later.days + 6, days)
        timed.library.audit.note(Action.VIEW, "library")


@pytest.fixture
def later() -> Later:
    return Later()


@pytest.fixture
def timed(opened: OpenedLibrary, later: Later) -> Iterator[OpenedLibrary]:
    """The same library under the test's time."""
    with replace(opened, library=Library.open(opened.folder, opened.data_key, later)) as timed:
        timed.library.log_in("hk")
        yield timed
