"""Whether rates stand for instants or for intervals; where no sensor names it, the joints decide together.

Half an interval between rates and orientations is enough to make the accelerations of a joint disagree. One joint
alone is no evidence where tissue is loose, so what all joints show is added up.
"""

import numpy as np

from core.angles.measure import paired
from core.body import LEG_JOINTS, Joint, Site
from core.calibration.coincidence import fit_forces, joint_forces
from core.calibration.identify import DECISION_SAMPLES, decide, moving_data
from core.calibration.joint_axis import Candidates, heading_from_axes
from core.findings import Finding, Severity
from core.samples import RateKind
from core.session import Recording, RecordingKind, Session
from core.signal.datasets import Datasets
from core.signal.orientation import as_of_intervals
from core.signal.pair import OrientedTrack
from core.signal.sensors import SensorTracks

# Logarithms of cost ratios, added up. Instants of 40 simulated sessions reached 0.2, nearly always they are under 0;
# intervals on hinges give 7 and more, under soft tissue 1 to 3.5 at 100 Hz and 0.1 to 1.6 at 200 Hz.
MIN_EVIDENCE = 0.35
ENOUGH_EVIDENCE = 3.0  # what further joints cannot turn
MAX_RECORDINGS = 2  # of each joint


def tracks_of_kind(
    session: Session, span: tuple[Recording, ...], unusable: frozenset[tuple[str, Site]]
) -> tuple[SensorTracks, list[Finding]]:
    """The tracks of a span, of the kind that the data show where sensors do not name it; a finding reports that."""
    instants = SensorTracks(session, span, unusable, RateKind.INSTANTANEOUS)
    evidence = 0.0
    for recording, joint in _undeclared(instants):
        evidence += _evidence(instants, recording, joint)
        if abs(evidence) > ENOUGH_EVIDENCE:
            break
    if evidence <= MIN_EVIDENCE:
        return instants, []
    found = Finding("rate_kind_found", Severity.INFO, "session", {"kind": str(RateKind.AVERAGED)})
    return SensorTracks(session, span, unusable, RateKind.AVERAGED), [found]


def _undeclared(tracks: SensorTracks) -> list[tuple[Recording, Joint]]:
    """The first recordings of each joint of which no sensor names the kind of its rates."""
    declared = {site for site, info in tracks.session.sensors.items() if info.rate_kind is not None}
    moving = [recording for recording in tracks.span if recording.kind is not RecordingKind.STANDING]
    found = []
    for joint in LEG_JOINTS:
        sites = joint.proximal, joint.distal
        if declared.isdisjoint(sites):
            usable = [(recording, joint) for recording in moving if tracks.is_usable(recording, *sites)]
            found += usable[:MAX_RECORDINGS]
    return found


def _evidence(tracks: SensorTracks, recording: Recording, joint: Joint) -> float:
    """Logarithm of what the accelerations of a joint disagree on, taken as instants, over that taken as intervals."""
    block = tracks.blocks(recording)[0]
    sides = [tracks.oriented(recording, site, block) for site in (joint.proximal, joint.distal)]
    data = _data(sides)
    other = _data([[as_of_intervals(one) for one in side] for side in sides])
    if data is None or other is None:
        return 0.0
    best = decide(data).best
    return float(np.log(_cost(data, best) / _cost(other, best)))


def _data(sides: list[list[OrientedTrack]]) -> Datasets | None:
    data = moving_data(tuple(paired(sides[0], sides[1], 0.0)))
    return data.thinned(DECISION_SAMPLES) if data else None


def _cost(data: Datasets, axes: Candidates) -> float:
    forces = joint_forces(data)
    heading = data.heading(heading_from_axes(data, axes.axis_1, axes.axis_2))
    return float(fit_forces(forces, heading[:, forces.chosen]).cost[0])
