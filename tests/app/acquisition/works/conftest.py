"""What do several tests of the works share? The patient, who takes a few seconds to make."""

import pytest

from tests.app.wizard.dressed_patient import Worn, dressed_patient


@pytest.fixture(scope="session")
def dressed() -> Worn:
    return dressed_patient()
