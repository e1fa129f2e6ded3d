"""What was changed at a prosthesis before each walk, as a table for other programs: `alignments.csv`.

One line for each part of each change. Nothing of it is measured: it is what somebody has stated.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

from app.system.tables import typed_cell, write_table
from app.wording.alignment import change_in_words
from core.alignment import AlignmentChange, PartChange
from core.session import Recording, RecordingKind

ALIGNMENTS = "alignments.csv"
HEADER = (
    *("walk", "condition", "since", "part"),
    *("angle_deg", "turns", "shift_mm", "height_mm", "text", "in_words"),
    *("program_before", "program", "setting", "setting_before", "setting_value", "returns_to"),
)


def write_alignments(recordings: Sequence[Recording], path: Path) -> None:
    """Write the table of walks that count, nothing without changes; raises OSError."""
    lines = [
        _cells(recording, recording.alignment, part)
        for recording in changed_walks(recordings)
        if recording.alignment is not None
        for part in recording.alignment.parts
    ]
    if lines:
        write_table(HEADER, lines, path)


def changed_walks(recordings: Sequence[Recording]) -> list[Recording]:
    """The walks that count and before which something was changed."""
    walks = [one for one in recordings if one.kind is RecordingKind.WALKING and one.is_kept]
    return [one for one in walks if one.alignment is not None]


def alignments_of(recordings: Sequence[Recording]) -> Mapping[str, AlignmentChange | None]:
    """Of each condition of the walks that count what was changed before it; of several walks the last word holds."""
    found: dict[str, AlignmentChange | None] = {}
    for one in recordings:
        if one.kind is RecordingKind.WALKING and one.is_kept:
            condition = one.condition or one.name
            found[condition] = one.alignment or found.get(condition)
    return found


def _cells(recording: Recording, change: AlignmentChange, part: PartChange) -> list[str]:
    figures = (part.angle_deg, part.turns, part.shift_mm, part.height_mm)
    return [
        typed_cell(recording.name),
        typed_cell(recording.condition),
        typed_cell(change.since),
        str(part.part),
        *(f"{value:g}" if value else "" for value in figures),
        typed_cell(part.text),
        typed_cell(change_in_words([part])),
        *map(typed_cell, (part.program_before, part.program, part.setting)),
        *("" if value is None else f"{value:g}" for value in (part.setting_before, part.setting_value)),
        typed_cell(change.returns_to),
    ]
