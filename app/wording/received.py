"""How many samples were received of those expected, in words."""

from collections.abc import Mapping

from app.wording.body import name_of
from app.wording.translation import capitalised, figure_text, joined, tr
from core.body import Site
from core.signal.received import SamplesReceived


def received_clause(counts: Mapping[Site, SamplesReceived]) -> str:
    """State what was received of one recording, as one of its facts; empty where nothing is known of it."""
    if not counts:
        return ""
    lossy = [name_of(site) for site, one in counts.items() if one.is_lossy]
    if lossy:
        return tr("samples lost: {sensors}").format(sensors=joined(lossy))
    if all(one.received == one.expected for one in counts.values()):
        return tr("all samples received")
    least = min(100.0 - one.lost_percent for one in counts.values())
    return tr("at least {share} % of the samples received").format(share=figure_text(least, ".1f"))


def lossy_sentence(counts: Mapping[Site, SamplesReceived]) -> str:
    """State what the sensors that lose samples sent so far; empty where none does."""
    stated = [
        tr("{sensor}: {received} of {expected} samples").format(
            sensor=name_of(site), received=one.received, expected=one.expected
        )
        for site, one in counts.items()
        if one.is_lossy
    ]
    return capitalised(tr("{sensors} received.").format(sensors=", ".join(stated))) if stated else ""
