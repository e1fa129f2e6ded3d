"""What was received of the visit's recordings, and of the one that goes on."""

from typing import TYPE_CHECKING

from app.wizard.walking.received_card import ReceivedRow
from core.body import Site
from core.signal.received import SamplesReceived

if TYPE_CHECKING:
    from app.editing.session_recording import SessionRecording
    from app.wizard.recordings import SessionRecordings
    from app.wizard.visit import Visit

LEAST_EXPECTED = 100  # samples: below, one lost packet would be much


def received_of(recording: "SessionRecording") -> dict[Site, SamplesReceived]:
    """By the sites that the sensors are stated to have been worn at."""
    placement = recording.stored.placement
    name_at = {site: one.name for site, one in placement.sensors.items()} if placement is not None else {}
    return {site: recording.received[name_at[site]] for site in Site if name_at.get(site) in recording.received}


def received_rows(recordings: "SessionRecordings") -> list[ReceivedRow]:
    """Sensors that lost samples in recordings that count, or may."""
    return [
        ReceivedRow(recordings.called(recording.details.name), site, counts)
        for recording in recordings.every
        if recording.details.is_kept
        for site, counts in received_of(recording).items()
        if counts.is_lossy
    ]


def received_so_far(visit: "Visit") -> dict[Site, SamplesReceived]:
    """Of the recording that goes on, by site: of sensors whose loss can be seen, once enough was expected."""
    counts = {}
    for name, (received, lost) in visit.recordings.received_so_far().items():
        site = visit.sensors.site_of.get(name)
        if site is not None and received + lost >= LEAST_EXPECTED:
            counts[site] = SamplesReceived(received + lost, received, 0.0)
    return counts
