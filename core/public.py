"""The public names of `core`, each from the module that defines it; `core/__init__.py` explains them.

The imports are for type checkers and editors; at run time `core.lazy_names` takes `MODULES`.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from core.analysis import analyse as analyse
    from core.body import Joint as Joint
    from core.body import Segment as Segment
    from core.body import Side as Side
    from core.body import Site as Site
    from core.calibration.identified import identify as identify
    from core.calibration.identify import moving_data as moving_data
    from core.calibration.rest import rest_of as rest_of
    from core.calibration.validity import basis_of as basis_of
    from core.calibration.validity import spans_of_validity as spans_of_validity
    from core.findings import Finding as Finding
    from core.findings import Severity as Severity
    from core.gait.events import gait_of as gait_of
    from core.gait.foot import follow as follow
    from core.gait.live import LiveEvents as LiveEvents
    from core.gait.strides import strides_of as strides_of
    from core.live.sensors import LiveSensor as LiveSensor
    from core.live.walking import LiveWalk as LiveWalk
    from core.published.angles import published_angle as published_angle
    from core.published.identify import identify_as_published as identify_as_published
    from core.results import Analysis as Analysis
    from core.results import Calibration as Calibration
    from core.results import JointAngle as JointAngle
    from core.results import JointCalibration as JointCalibration
    from core.results import Method as Method
    from core.results import RecordingAnalysis as RecordingAnalysis
    from core.samples import ImuBlock as ImuBlock
    from core.samples import RateKind as RateKind
    from core.samples import SensorInfo as SensorInfo
    from core.session import Patient as Patient
    from core.session import Recording as Recording
    from core.session import RecordingKind as RecordingKind
    from core.session import Session as Session
    from core.signal.orientation import oriented as oriented
    from core.signal.pair import OrientedTrack as OrientedTrack
    from core.signal.pair import Pair as Pair
    from core.signal.pair import pair_up as pair_up
    from core.signal.sensors import SensorTracks as SensorTracks
    from core.signal.tracks import even_tracks as even_tracks
    from core.verdicts.diagnostics import diagnostics_of as diagnostics_of

MODULES = {
    "analyse": "core.analysis",
    "Joint": "core.body",
    "Segment": "core.body",
    "Side": "core.body",
    "Site": "core.body",
    "identify": "core.calibration.identified",
    "moving_data": "core.calibration.identify",
    "rest_of": "core.calibration.rest",
    "basis_of": "core.calibration.validity",
    "spans_of_validity": "core.calibration.validity",
    "Finding": "core.findings",
    "Severity": "core.findings",
    "gait_of": "core.gait.events",
    "follow": "core.gait.foot",
    "LiveEvents": "core.gait.live",
    "strides_of": "core.gait.strides",
    "LiveSensor": "core.live.sensors",
    "LiveWalk": "core.live.walking",
    "published_angle": "core.published.angles",
    "identify_as_published": "core.published.identify",
    "Analysis": "core.results",
    "Calibration": "core.results",
    "JointAngle": "core.results",
    "JointCalibration": "core.results",
    "Method": "core.results",
    "RecordingAnalysis": "core.results",
    "ImuBlock": "core.samples",
    "RateKind": "core.samples",
    "SensorInfo": "core.samples",
    "Patient": "core.session",
    "Recording": "core.session",
    "RecordingKind": "core.session",
    "Session": "core.session",
    "oriented": "core.signal.orientation",
    "OrientedTrack": "core.signal.pair",
    "Pair": "core.signal.pair",
    "pair_up": "core.signal.pair",
    "SensorTracks": "core.signal.sensors",
    "even_tracks": "core.signal.tracks",
    "diagnostics_of": "core.verdicts.diagnostics",
}
