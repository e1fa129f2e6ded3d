"""What was received of the visit's recordings, and of the one that goes on."""

from typing import TYPE_CHECKING

from app.wizard.walking.received_card import ReceivedRow
from core.body import Site
from core.signal.received import SamplesReceived, samples_received

if TYPE_CHECKING:
    from uuid import UUID

    from app.editing.session_recording import SessionRecording
    from app.wizard.recordings import SessionRecordings
    from app.wizard.visit import Visit
    from core.session import Recording

LEAST_EXPECTED = 100  # samples: below, one lost packet would be much


class ReceivedCounts:
    """Counts each recording once."""

    def __init__(self) -> None:
        self._counted: dict[UUID, tuple[Recording, dict[Site, SamplesReceived]]] = {}

    def of(self, recording: "SessionRecording") -> dict[Site, SamplesReceived]:
        """By site; empty as long as it has not been read back."""
        if recording.read_back is None:
            return {}
        known = self._counted.get(recording.id)
        if known is None or known[0] is not recording.read_back:
            placement = recording.stored.placement
            sensors = placement.sensors if placement is not None else {}
            rates_hz = {site: one.info.rate_hz for site, one in sensors.items()}
            known = recording.read_back, samples_received(recording.read_back, rates_hz, sensors)
            self._counted[recording.id] = known
        return known[1]

    def rows(self, recordings: "SessionRecordings") -> list[ReceivedRow]:
        """Sensors that lost samples in recordings that count, or may."""
        return [
            ReceivedRow(recordings.called(recording.details.name), site, counts)
            for recording in recordings.every
            if recording.details.is_kept
            for site, counts in self.of(recording).items()
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
