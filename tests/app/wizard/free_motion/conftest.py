"""The patient's time waits for the screen, the library and the live estimator."""

import pytest

from app.wizard.worn_sensors import SourceChoice
from core.samples import Session
from devices.replay import ReplaySource
from tests.app.wizard.patient_time import PatientTime


@pytest.fixture
def source(simulated_session: Session, patient_time: PatientTime) -> ReplaySource:
    return ReplaySource(simulated_session, now_ns=patient_time.now_ns)


@pytest.fixture
def choice(source: ReplaySource, patient_time: PatientTime) -> SourceChoice:
    return SourceChoice("fast", "Fast patient", lambda: patient_time.acquisition(source), is_simulated=True)
