"""What tests of accessibility get: the roles of our widgets, which the application reports Qt when it starts."""

from collections.abc import Iterator

import pytest
from PySide6.QtWidgets import QApplication

from app.widgets.accessible_role import show_roles
from app.wording.translation import use_language


@pytest.fixture(scope="session", autouse=True)
def _roles(qapp: QApplication) -> None:
    show_roles()


@pytest.fixture(params=["en", "de"])
def language(request: pytest.FixtureRequest) -> Iterator[str]:
    use_language(request.param)
    yield request.param
    use_language("en")
