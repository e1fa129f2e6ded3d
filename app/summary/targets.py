"""How often the targets of each walk were reached, as the notes of the recordings have it: `targets.csv`."""

from collections.abc import Iterator, Sequence

from app.system.tables import typed_cell
from core.session import Recording
from core.targets import tallies_of

TARGETS = "targets.csv"
HEADER = ("recording", "condition", "measure", "side", "target", "unit", "reached", "strides", "reached_percent")


def target_rows(recordings: Sequence[Recording]) -> Iterator[tuple[str, ...]]:
    """Give a row for each target of each recording that counts."""
    for recording in recordings:
        for tally in tallies_of(recording.note) if recording.is_kept else ():
            target = tally.target
            yield (
                typed_cell(recording.folder),
                typed_cell(recording.condition),
                target.measure,
                target.side or "",
                str(target.value),
                target.measure.unit,
                str(tally.reached),
                str(tally.strides),
                f"{tally.reached_percent:.1f}",
            )
