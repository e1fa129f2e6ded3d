"""What can be done while a timed test runs: end it, or break it off."""

import math

from app.system import sounds
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState, RecordingNote
from app.wizard.walking.timed_control import TimedControl
from app.wording.timed_tests import name_of_test
from app.wording.translation import tr
from core.timed.protocols import DEFINITIONS


def timed_bar(timed: TimedControl, elapsed_s: float) -> BarState:
    """`elapsed_s`: since the recording began. The only other action breaks the test off."""
    readout = timed.readout
    assert readout is not None
    definition = DEFINITIONS[readout.planned.protocol]
    if math.isfinite(timed.end_s):
        verb = tr("Stop") if readout.planned.end_key_s is not None else tr("End at the tape")
        note = tr("The test is over; recording stops shortly.")
        verb = verb if definition.length_m is not None else tr("Stop")
    elif not readout.has_begun:
        verb, note = (
            tr("Start the clock"),
            tr("The clock starts with the patient's movement. Space or a clicker starts it manually."),
        )
    elif definition.length_m is not None:
        verb = tr("End at the tape")
        note = tr("Press Space at the end of the tape. The distance then counts as {length:.2f} m.").format(
            length=definition.length_m
        )
    else:
        verb, note = tr("End the test"), tr("Space or a clicker ends the test now. Otherwise it ends automatically.")
    return BarState(
        primary=BarAction(verb, tr("Space"), Icon.STOP),
        others=(BarAction(tr("Cancel"), tr("Esc"), is_wished=False),),
        recording=RecordingNote(
            tr("Recording the full test: {test}").format(test=name_of_test(readout.planned.protocol)),
            note,
            elapsed_s,
            sounds.is_on(),
        ),
        has_back=False,
    )
