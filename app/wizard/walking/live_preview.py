"""What is live while somebody walks: the estimator with all that is known, given amid a walk what that walk adds.

Free motion alone leaves the ankles' axes unsure, and may not have shown the hips. So the walk that goes on is looked at
twice, once each foot has made enough strides and once a turn has come by, together with what was recorded before; what
comes of it is taken over without a break.
"""

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.live_output.chunks import LiveStreams
from app.live_output.output import live_output
from app.wizard.walking.estimator import WalkingEstimator
from app.wizard.walking.walk_rows import ongoing_walk
from core.body import LEG_JOINTS, Segment, Side
from core.live.walking import STRIDES_FOR_ANKLE
from core.session import Recording

if TYPE_CHECKING:
    from app.acquisition.acquisition import Acquisition
    from app.editing.session_recording import Ongoing
    from app.wizard.visit import Visit
    from app.wizard.walking.readout import WalkingReadout

HIPS_AFTER_S = 22.0  # of a walk, with a turn as a rule, that shows them if any does
LOOKED_BACK_S = 29.0  # of a walk that goes on; the ring buffer holds a second more


class LivePreview(QObject):
    """Knows the visit and no page. `shown`: the latest of the walk that goes on or has ended, with all its strides."""

    renewed = Signal(object)  # another WalkingEstimator works from now on, before it is given samples; None: none does

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._estimator: WalkingEstimator | None = None
        self._seen: WalkingReadout | None = None  # as the estimator gave `shown`
        self.shown: WalkingReadout | None = None
        self._counted_before: dict[Side, int] = {}  # by estimators before this one, amid this walk
        self._is_ankle_asked = self._are_hips_asked = False

    def begin(self) -> None:
        """Let an estimator work, with the calibration as it is now."""
        if (acquisition := self._visit.sensors.acquisition) is not None:
            self._go_over(acquisition, self._new_estimator())

    def end(self) -> None:
        """Nobody looks any more."""
        self._estimator = None
        self.renewed.emit(None)
        live_output.close_streams()
        if (acquisition := self._visit.sensors.acquisition) is not None:
            acquisition.set_estimator(None)

    def begin_walk(self, began_s: float) -> None:
        """Show, count and look at this walk from here on."""
        self._seen = self.shown = None
        self._counted_before = {}
        self._is_ankle_asked = self._are_hips_asked = False
        if self._estimator is not None:
            self._estimator.count_from(began_s)
            self._send_from(self._estimator)
        if (acquisition := self._visit.sensors.acquisition) is not None and not self._visit.sensors.are_in_memory:
            live_output.begin_walk(began_s, acquisition.now_s)

    def end_walk(self) -> None:
        """Send nothing more of this walk."""
        live_output.end_walk()

    def look(self) -> "WalkingReadout | None":
        """What the estimator gives now, with time going on also while nothing is received; None where none works."""
        if self._estimator is None:
            return None
        view, sensors = self._estimator.state, self._visit.sensors
        if sensors.are_silent and sensors.acquisition is not None:
            return view.while_silent(sensors.acquisition.now_s, sensors.site_of.values())
        return view

    def follow(self, view: "WalkingReadout") -> bool:
        """Take what the estimator gives amid a walk; return whether it is something new to be shown."""
        if view is self._seen or math.isnan(view.now_s):
            return False
        self._seen = view
        strides = {side: count + self._counted_before.get(side, 0) for side, count in view.strides.items()}
        self.shown = replace(view, strides=strides)
        self._ask()
        return True

    def take_over(self) -> None:
        """Go on with what has been found out by now: by another estimator only where joints have become known."""
        acquisition = self._visit.sensors.acquisition
        if acquisition is None:
            return
        fresh = self._new_estimator()
        if self._estimator is None or fresh.calibrated - self._estimator.calibrated:
            self._go_over(acquisition, fresh)
            return
        calibration = self._visit.calibration
        for joint in LEG_JOINTS:
            if not joint.is_knee and joint in calibration:
                self._estimator.recalibrate(joint, calibration[joint])
        self._estimator.find_hips(self._visit.hips)

    def _new_estimator(self) -> WalkingEstimator:
        visit = self._visit
        return WalkingEstimator(visit.sensors.site_of, visit.live_sensors(), visit.calibration, visit.hips)

    def _go_over(self, acquisition: "Acquisition", estimator: WalkingEstimator) -> None:
        walk = ongoing_walk(self._visit.recordings)
        if walk is not None and self.shown is not None:
            self._counted_before = dict(self.shown.strides)
            estimator.count_from(acquisition.now_s)
        elif walk is not None:
            estimator.count_from(walk.began_s)
        self._estimator = estimator
        self._send_from(estimator)
        sides = {site.leg_side for site in self._visit.sensors.site_of.values() if site.segment is Segment.FOOT}
        feet = tuple(side for side in Side if side in sides)
        live_output.open_streams(LiveStreams(estimator.rates_hz, feet, self._visit.is_simulated))
        self.renewed.emit(estimator)
        acquisition.set_estimator(estimator)

    def _send_from(self, estimator: WalkingEstimator) -> None:
        """Hand on what it finds, if it is asked for: the settings may be changed between two walks."""
        estimator.on_chunk = live_output.take if live_output.is_on else None

    def _ask(self) -> None:
        """Look at the walk once for the ankles' axes, and once more for hips that nothing has shown."""
        visit = self._visit
        acquisition, evaluation, recordings = visit.sensors.acquisition, visit.evaluation, visit.recordings
        walk = ongoing_walk(recordings)
        if walk is None or recordings.is_stopping or acquisition is None or self.shown is None or evaluation.is_busy:
            return
        strides = self.shown.strides
        is_ankle_due = bool(strides) and min(strides.values()) >= STRIDES_FOR_ANKLE and not self._is_ankle_asked
        are_hips_due = acquisition.now_s - walk.began_s >= HIPS_AFTER_S and not self._are_hips_asked
        self._is_ankle_asked |= is_ankle_due
        self._are_hips_asked |= are_hips_due
        if is_ankle_due or (are_hips_due and set(visit.sensors.hips) - visit.hips.keys()):
            visit.evaluate(self._until_now(walk, acquisition))

    def _until_now(self, walk: "Ongoing", acquisition: "Acquisition") -> Recording:
        """The last seconds of the walk that goes on, as if it had ended."""
        seconds = min(acquisition.now_s - walk.began_s, LOOKED_BACK_S)
        latest = {site: acquisition.latest(name, seconds) for name, site in self._visit.sensors.site_of.items()}
        received = {site: block for site, block in latest.items() if len(block)}
        reported = walk.details
        return Recording(
            reported.name,
            reported.kind,
            reported.folder,
            received,
            condition=reported.condition,
            alignment=reported.alignment,
        )
