"""The patient's time waits for the screen, the library and the live estimator."""

from tests.app.wizard.patient_time import choice, patient_time, source

__all__ = ["choice", "patient_time", "source"]
