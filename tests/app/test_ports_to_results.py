"""A whole session over the wire: six ports, the wizard, results that are the patient's."""

import pytest
from PySide6.QtWidgets import QApplication

from devices.transport.ports import MORE_PORTS
from tests.safety.ports_to_results import run

pytestmark = pytest.mark.endurance  # more than a minute

MOST_KNEE_DEG, MOST_ANKLE_DEG = 0.4, 0.8  # on a machine that does other things as well; see evidence.md


def test_six_sensors_at_ports_lead_to_the_angles_of_the_patient(
    qapp: QApplication, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in (MORE_PORTS, "XDG_CONFIG_HOME"):
        monkeypatch.setenv(name, "")  # the session sets them; they are as before afterwards
    outcome = run(qapp, "csv", rate_hz=100, walks=1)
    assert (outcome.lost, outcome.wrong) == (0, 0)
    assert outcome.received == outcome.sent > 6 * 100 * 20
    assert outcome.worst(is_knee=True) < MOST_KNEE_DEG
    assert outcome.worst(is_knee=False) < MOST_ANKLE_DEG
