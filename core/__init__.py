"""What the samples mean: from angular rates and specific forces to joint angles, gait events and their certainty.

Everything that turns samples into joint angles lives here, as plain functions over frozen data: no clock, no file, no
thread, no screen. Lengths are metres, angles radians, times seconds; degrees appear only where figures are printed.

Public is what `__all__` names: a `Session` of recordings goes into `analyse` and comes back as an `Analysis`, whose
`JointAngle`s hold the curves; below them what serves one joint, one foot, and a patient who walks now. These keep their
meaning, every other name may change. `tests/examples` has one script per task.
"""

from typing import TYPE_CHECKING

from core.lazy_names import lazily
from core.public import MODULES

if TYPE_CHECKING:
    from core.public import *  # the names below, for type checkers and editors

# a page to read: one line or two for each task
# fmt: off
__all__ = (
    "analyse", "Analysis", "RecordingAnalysis", "JointAngle", "Calibration", "JointCalibration", "Method",
    "Finding", "Severity",
    "Session", "Recording", "RecordingKind", "ImuBlock", "SensorInfo", "RateKind", "Patient", "Side", "Segment",
    "Site", "Joint",
    "identify", "SensorTracks", "spans_of_validity", "basis_of", "diagnostics_of",
    "even_tracks", "rest_of", "oriented", "OrientedTrack", "pair_up", "Pair", "moving_data",
    "identify_as_published", "published_angle",
    "follow", "gait_of", "strides_of",
    "LiveWalk", "LiveSensor", "LiveEvents",
)
# fmt: on

if not TYPE_CHECKING:  # a type checker would take any name for offered
    __getattr__ = lazily(__name__, MODULES)
