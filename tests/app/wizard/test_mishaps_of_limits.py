"""What no sensor shows of the patient's body is stated wherever results are, also when a session is opened again."""

import pytest
from pytestqt.qtbot import QtBot

from app.storage.stored import Limits
from app.wizard.visit import Visit
from app.wording.findings import sentence
from app.workers.library_controller import LibraryController
from core.body import Side, Site
from core.session import RecordingKind
from tests.app.wizard.begun_visit import begin, record

STATED = "Right ankle: The foot has no ankle joint. Its angle is the foot relative to the shank."


def stated(visit: Visit) -> list[str]:
    assert visit.evaluation.analysis is not None
    return [sentence(finding) for finding in visit.evaluation.analysis.findings]


@pytest.mark.parametrize("is_reported_late", [False, pytest.param(True, marks=pytest.mark.endurance)])
def test_a_foot_without_ankle_is_called_foot_against_shank(
    qtbot: QtBot, controller: LibraryController, visit: Visit, worn: dict[str, Site], is_reported_late: bool
) -> None:
    begin(qtbot, visit, worn)
    limits = Limits(without_ankle=frozenset({Side.RIGHT}))
    if not is_reported_late:
        visit.record.set_limits(limits)
    with qtbot.waitSignal(visit.evaluation.done):
        record(qtbot, visit, RecordingKind.WALKING, 4.0)
    if is_reported_late:
        assert STATED not in stated(visit)
        with qtbot.waitSignal(visit.evaluation.done):
            visit.record.set_limits(limits)
    assert STATED in stated(visit)
    assert visit.session is not None
    again = Visit(controller, [])
    with qtbot.waitSignals([again.resumed, again.evaluation.done]):
        again.resume(visit.session.id)
    assert STATED in stated(again)
    again.close()
    again.finish()
