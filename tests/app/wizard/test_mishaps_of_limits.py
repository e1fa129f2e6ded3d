"""What no sensor shows of the patient's body is stated wherever results are, also when a session is opened again."""

import pytest
from pytestqt.qtbot import QtBot

from app.storage.stored import Limits
from app.wizard.visit import Visit
from app.wording.findings import sentence
from app.workers.library_controller import LibraryController
from core.body import Side
from core.session import RecordingKind
from tests.app.wizard.begun_visit import record
from tests.app.wizard.present import present

STATED = "Right ankle: The foot has no ankle joint. Its angle is the foot relative to the shank."


def stated(visit: Visit) -> list[str]:
    return [sentence(finding) for finding in present(visit.evaluation.analysis).findings]


@pytest.mark.parametrize("is_reported_late", [False, pytest.param(True, marks=pytest.mark.endurance)])
def test_a_foot_without_ankle_is_called_foot_against_shank(
    qtbot: QtBot, controller: LibraryController, begun: Visit, is_reported_late: bool
) -> None:
    limits = Limits(without_ankle=frozenset({Side.RIGHT}))
    if not is_reported_late:
        begun.record.set_limits(limits)
    with qtbot.waitSignal(begun.evaluation.done):
        record(qtbot, begun, RecordingKind.WALKING, 4.0)
    if is_reported_late:
        assert STATED not in stated(begun)
        with qtbot.waitSignal(begun.evaluation.done):
            begun.record.set_limits(limits)
    assert STATED in stated(begun)
    again = Visit(controller, [])
    with qtbot.waitSignals([again.resumed, again.evaluation.done]):
        again.resume(present(begun.session).id)
    assert STATED in stated(again)
    again.close()
    again.finish()
