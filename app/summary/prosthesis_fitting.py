"""A prosthesis fitted in one visit: its alignments in the order walked, what was set, and what is measured of it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from app.summary.agreed import agreed_with
from app.summary.alignments import alignments_of
from app.summary.comparison import Compared, Comparison, Contrast
from app.summary.conditions import Part, parts_of
from app.summary.measures import FITTED, MEASURES, Measure
from app.summary.set_angle import SetAngle, set_angle
from app.system.tables import figure_cell, typed_cell, write_table
from core.body import Side
from core.results import Analysis
from core.session import Session

SET_ANGLES = "set_angles.csv"
HEADER = ("condition", "since", "side", "set_deg", "measured_deg", "error_deg", "agrees", "other_changes")
OF_PROSTHETIC = ("knee_stance_to_swing_deg", "knee_while_loading_deg", "ankle_rocker_deg", "stance_percent")
OF_SOUND = ("knee_stance_to_swing_deg", "ankle_push_off_deg", "stance_percent")
OF_BOTH = ("speed_m_s", "cadence_steps_min")
MOST_FITTED = 3  # measures for fitting beyond their error, the surest first


@dataclass(frozen=True)
class ProsthesisFitting:
    """The alignments of one visit in the order walked; `comparison` begins with the starting point."""

    side: Side
    comparison: Comparison
    set_angles: tuple[SetAngle | None, ...]  # of each part but the first, against what it was changed from

    @property
    def start(self) -> Part:
        return self.comparison.against

    @property
    def others(self) -> tuple[Part, ...]:
        return self.comparison.others

    @property
    def sound(self) -> Side:
        return next(side for side in Side if side is not self.side)

    def of_prosthetic(self) -> list[Measure]:
        """Measures of the prosthetic side: those of every fitting, then what else changed beyond error."""
        beyond: dict[str, float] = {}
        for measure in FITTED:
            for part in self.others:
                row = self.compared(measure, self.side, part)
                if row.exceeds:
                    beyond[measure.column] = max(beyond.get(measure.column, 0.0), row.difference.ratio)
        surest = sorted(beyond, key=lambda column: -beyond[column])[:MOST_FITTED]
        return [*_named(OF_PROSTHETIC), *(measure for measure in FITTED if measure.column in surest)]

    def compared(self, measure: Measure, side: Side, part: Part) -> Compared:
        """A measure of an alignment beside the one it was changed from, or whose setting it returns to."""
        base = self.comparison.base_of(part)
        if measure.is_of_walk:
            return self.comparison.compare_walks(measure, part, base)
        return self.comparison.compare(measure, side, part, base)


def fitting_of(session: Session, analysis: Analysis) -> ProsthesisFitting | None:
    """Give the visit's fitting; None without a change, or where not one leg alone is prosthetic."""
    side = next((one for one in Side if session.patient.prosthetic_side == one), None)
    parts = parts_of(analysis, session.recordings, agreed=agreed_with(session))
    walked = tuple(part for part in parts if not part.is_apart)
    if side is None or len(walked) < 2 or all(part.alignment is None for part in walked):
        return None
    comparison = Comparison(Contrast.CONDITIONS, walked, is_simulated=analysis.is_simulated)
    changes = alignments_of(session.recordings)
    angles = (set_angle(comparison, part, comparison.base_of(part), side, changes) for part in walked[1:])
    return ProsthesisFitting(side, comparison, tuple(angles))


def of_sound() -> list[Measure]:
    return _named(OF_SOUND)


def of_both() -> list[Measure]:
    return _named(OF_BOTH)


def write_set_angles(found: ProsthesisFitting | None, path: Path) -> None:
    """Write what was set at the foot and what is measured, a row for each alignment; raises OSError."""
    if found is not None and (rows := [*_rows(found)]):
        write_table(HEADER, rows, path)


def _rows(found: ProsthesisFitting) -> Iterator[tuple[str, ...]]:
    for part, angle in zip(found.others, found.set_angles, strict=True):
        if angle is not None:
            agrees = ("no", "yes")[angle.agrees] if angle.is_measured else ""
            figures = (figure_cell(value) for value in (angle.set_deg, angle.measured_deg, angle.error_deg))
            names = typed_cell(part.name), typed_cell(found.comparison.base_of(part).name)
            yield (*names, str(found.side), *figures, agrees, ("no", "yes")[angle.has_other_parts])


def _named(columns: Sequence[str]) -> list[Measure]:
    known = {measure.column: measure for measure in MEASURES}
    return [known[column] for column in columns if column in known]
