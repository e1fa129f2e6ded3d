"""Whatever a sensor's stream becomes on its way, its recording can be decoded."""

import pytest

from tests.safety.recording_fuzz import fuzz, streams

SAMPLES = 60_000


@pytest.mark.endurance
@pytest.mark.parametrize("name", streams())
def test_a_hurt_stream_is_decoded_from_its_journal_all_the_same(name: str) -> None:
    outcome = fuzz(streams()[name], SAMPLES, seed=4)
    assert outcome.faults == []
    assert outcome.count["in the recordings"] > 0.8 * outcome.count["sent whole"] > 0.5 * SAMPLES
