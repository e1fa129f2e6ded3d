"""What tests of accessibility get: the roles of our widgets, which the application tells Qt when it starts."""

import pytest
from PySide6.QtWidgets import QApplication

from app.widgets.accessible_role import tell_roles


@pytest.fixture(scope="session", autouse=True)
def _roles(qapp: QApplication) -> None:
    tell_roles()
