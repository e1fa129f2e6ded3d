"""What the person of hinges recorded: once for all tests, which change copies of it."""

import pytest

from core.body import Site
from core.session import Session
from tests.core.hinges import PERSON


@pytest.fixture(scope="session")
def knee_visit() -> Session:
    """Standing, free motion and a walk of the left thigh and shank."""
    return PERSON.visit()


@pytest.fixture(scope="session")
def leg_visit() -> Session:
    """The same with thigh, shank and foot."""
    return PERSON.visit((Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT))
