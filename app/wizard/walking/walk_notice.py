"""The messages above the walks: of silent sensors, of the journal, of straps that slip, of too few strides."""

from typing import TYPE_CHECKING

from app.storage.stored import RecordingState
from app.summary.pooled_walks import pools_of
from app.wizard.losses import NOTHING, Losses, Message
from app.wizard.walk_messages import (
    bias_message,
    few_strides_message,
    implausible_message,
    lacks_message,
    loose_message,
    lossy_message,
    no_angles_message,
    recovered_message,
    slip_message,
)
from app.wizard.walking.received import received_so_far
from core.body import Side

if TYPE_CHECKING:
    from app.editing.session_recording import SessionRecording
    from app.wizard.recordings import SessionRecordings
    from app.wizard.visit import Visit
    from app.wizard.walking.readout import WalkingReadout


class WalkNotice:
    """Finds the gravest. `is_troubled`: something befell the journal, or the library, since the walk began."""

    def __init__(self, visit: "Visit") -> None:
        self._visit = visit
        self._losses = Losses()
        self.is_troubled = False

    def look(self) -> tuple[str, ...]:
        """Look at the sensors; the sites of those that fell silent since the last look."""
        sensors = self._visit.sensors
        if sensors.acquisition is None:
            return ()
        of_each = sensors.silent_s
        silent_s = {site: of_each[name] for name, site in sensors.site_of.items() if name in of_each}
        return tuple(self._losses.update(silent_s, sensors.acquisition.now_s))

    def message(self, view: "WalkingReadout | None") -> Message:
        """The message to be shown now; `view`: what the walk that goes on gave last."""
        recordings, sensors = self._visit.recordings, self._visit.sensors
        now_s = sensors.acquisition.now_s if sensors.acquisition is not None else 0.0
        lost = self._losses.message(recordings.has_begun, [*sensors.joints, *sensors.hips], now_s)
        trouble = recordings.trouble_message() if self.is_troubled else NOTHING
        for message in (trouble, recordings.standstill_message(sensors.site_of), lost):
            if message != NOTHING:
                return message
        if recordings.is_recording:
            return self._of_ongoing(view)
        asked = asked_walk(recordings)
        if asked is not None and asked.stored.state is RecordingState.RECOVERED:
            return recovered_message(recordings.called(asked.details.name), length_s(asked))
        if asked is not None and asked.lacks:
            return lacks_message(recordings.called(asked.details.name), asked.lacks)
        if sensors.are_loose:
            return loose_message(sensors.on_own_clocks)
        return self._few_strides()

    def _of_ongoing(self, view: "WalkingReadout | None") -> Message:
        ongoing, sensors = self._visit.recordings.ongoing, self._visit.sensors
        if ongoing is None or view is None:
            return NOTHING
        if view.implausible:
            return implausible_message(view.implausible)
        message = slip_message(view.slips, ongoing.began_s)
        if message == NOTHING:
            message = bias_message(view.corrections)
        if message == NOTHING and not view.joints and sensors.joints:
            return no_angles_message(sensors.sensor_at)
        return message if message != NOTHING else lossy_message(received_so_far(self._visit))

    def _few_strides(self) -> Message:
        """Say what is short of a spread for the last walk's condition, if its walks are all too short together."""
        walks = [recording for recording in self._visit.recordings.walks if recording.details.is_kept]
        if not walks or walks[-1].details.test is not None:  # a test is as long as it is
            return NOTHING
        pools = pools_of([recording.details for recording in self._visit.recordings.every])
        last = pools[walks[-1].details.name]
        counts: dict[Side, int] = {}
        for recording in walks:
            if pools[recording.details.name] == last:
                for side, count in strides_of(self._visit, recording).items():
                    counts[side] = counts.get(side, 0) + count
        return few_strides_message(counts)


def asked_walk(recordings: "SessionRecordings") -> "SessionRecording | None":
    """The walk that waits for somebody to say whether it is kept: the newest, or one that was recovered."""
    undecided = [recording for recording in recordings.walks if not recording.is_decided]
    new = [recording for recording in undecided if recording.stored.state is not RecordingState.RECOVERED]
    return new[-1] if new else undecided[0] if undecided else None


def strides_of(visit: "Visit", recording: "SessionRecording") -> dict[Side, int]:
    """As the analysis has counted them, or else as they were counted live: amid a walk it saw a part only."""
    session = visit.evaluation.session
    seen = {one.name: one for one in session.recordings} if session is not None else {}
    same = seen.get(recording.details.name)
    if same is None or recording.read_back is None or same.imu is not recording.read_back.imu:
        return dict(recording.strides or {})
    return visit.evaluation.strides(recording.details.name)


def length_s(recording: "SessionRecording") -> float:
    """How long a recording lasts, as its sensors have it."""
    if recording.read_back is None:
        return 0.0
    blocks = [block.time_s for block in recording.read_back.imu.values() if len(block)]
    return max((float(time_s[-1] - time_s[0]) for time_s in blocks), default=0.0)
