"""What do several tests of the works share? The patient, who takes a few seconds to make."""

import pytest

from tests.app.acquisition.works.patient import Worn, dressed_patient


@pytest.fixture(scope="session")
def worn() -> Worn:
    return dressed_patient()
