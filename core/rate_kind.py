"""Do the rates stand for instants or for intervals? Where no sensor says so, the data of one joint decide.

Half an interval between rates and orientations is enough to make the accelerations of the joint disagree.
"""

import numpy as np

from core.body import Joint, Site
from core.calibration.identify import decide, moving_data
from core.findings import Finding, Severity
from core.measure import pairs_of
from core.samples import RateKind, Recording, RecordingKind, Session
from core.sensors import SensorTracks

MIN_COST_RATIO = 1.15  # instants are the rule; intervals need evidence


def find_rate_kind(
    session: Session, span: tuple[Recording, ...], unusable: frozenset[tuple[str, Site]]
) -> tuple[RateKind, list[Finding]]:
    """The kind of the sensors that do not tell it, and a finding where the data showed it."""
    asked = SensorTracks(session, span, unusable, RateKind.INSTANTANEOUS)
    for recording in span:
        if recording.kind is RecordingKind.STANDING:
            continue
        for joint in Joint:
            sites = (joint.proximal, joint.distal)
            untold = all(session.sensors.get(s) is None or session.sensors[s].rate_kind is None for s in sites)
            if untold and asked.is_usable(recording, *sites):
                costs = {kind: _cost(session, span, unusable, kind, recording, joint) for kind in RateKind}
                if costs[RateKind.INSTANTANEOUS] - costs[RateKind.AVERAGED] > np.log(MIN_COST_RATIO):
                    found = Finding("rate_kind_found", Severity.INFO, "session", {"kind": str(RateKind.AVERAGED)})
                    return RateKind.AVERAGED, [found]
                if np.isfinite(costs[RateKind.INSTANTANEOUS]):
                    return RateKind.INSTANTANEOUS, []
    return RateKind.INSTANTANEOUS, []


def _cost(
    session: Session,
    span: tuple[Recording, ...],
    unusable: frozenset[tuple[str, Site]],
    kind: RateKind,
    recording: Recording,
    joint: Joint,
) -> float:
    tracks = SensorTracks(session, span, unusable, kind)
    data = moving_data(tuple(pairs_of(tracks, recording, joint, tracks.blocks(recording)[0], 0.0)))
    return decide(data).log_cost if data else float("inf")
