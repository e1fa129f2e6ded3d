"""Which measures the bench shows of two alignments, and why some of them are read with caution."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from app.results.compared_words import is_judged
from app.summary.comparison import Compared, Comparison
from app.summary.conditions import Part
from app.summary.measures import FITTED
from app.summary.prosthesis_fitting import OF_BOTH, OF_PROSTHETIC, OF_SOUND
from app.summary.what_stands_out import FAMILIES
from app.widgets.chip import leg_name
from app.wording.body import name_of
from app.wording.translation import tr
from app.wording.verdicts import gate_words
from core.body import Joint, JointKind, Side
from core.verdicts.model import Assessment, Verdict
from core.verdicts.norms import MIN_STRIDES_FOR_SD

LENGTH = "stride_length_m"
STRIDES_GATE = "strides"  # what is short of them is called provisional
MOST_OTHERS, MOST_OTHERS_OF_SOUND = 3, 1  # there is room for no more


@dataclass(frozen=True, slots=True)
class BenchRows:
    """The rows of each group; the usual ones, then others that changed beyond their error."""

    prosthetic: Sequence[Compared]
    sound: Sequence[Compared]
    both: Sequence[Compared]


def is_provisional(found: Comparison, prosthetic: Side) -> bool:
    """Whether a walk has too few strides of the prosthetic side for an error."""
    return any(part.strides(prosthetic) < MIN_STRIDES_FOR_SD for part in found.parts)


def may_be_stated(row: Compared) -> bool:
    """Whether a sentence may name it: judged, of one leg, and no height, which the standing zero is in."""
    return is_judged(row) and not row.measure.is_of_walk and not row.measure.needs_height


def reported_row(found: Comparison, prosthetic: Side) -> Compared | None:
    """The measure of the prosthetic side that the sentence is about; None where none was judged.

    What changed beyond its error by most errors, of the usual measures first, then of those for fitting.
    """
    if is_provisional(found, prosthetic):
        return None
    own = [row for row in found.rows if may_be_stated(row) and row.side is prosthetic]
    beyond = [row for row in own if row.exceeds] or [
        row for row in _fitted(found, prosthetic) if row.exceeds and may_be_stated(row)
    ]
    worth = [row for row in beyond if row.difference.is_worth_a_sentence]
    return max(_without_family(worth or beyond or own), key=lambda row: row.difference.ratio, default=None)


def shown_rows(found: Comparison, prosthetic: Side) -> BenchRows:
    """What the table shows: what a sentence names is among it."""
    reported, fitted = reported_row(found, prosthetic), _fitted(found, prosthetic)
    own = [*_of(found, OF_PROSTHETIC, prosthetic)]
    first = [reported] if reported is not None else []
    own += _others([*first, *_beyond(found, prosthetic), *(row for row in fitted if row.exceeds)], own, MOST_OTHERS)
    sound = next(side for side in Side if side is not prosthetic)
    of_sound = _of(found, OF_SOUND, sound) if sound in found.sides else []
    of_sound += _others(_beyond(found, sound), of_sound, MOST_OTHERS_OF_SOUND)
    return BenchRows(own, of_sound, [*_of(found, OF_BOTH, None), *_of(found, (LENGTH,), prosthetic)])


def marked_rows(found: Comparison, prosthetic: Side) -> dict[JointKind, Compared]:
    """What is marked on the curve of each joint: of the table's rows beyond error the one that the sentence names."""
    rows = [row for row in shown_rows(found, prosthetic).prosthetic if row.exceeds and not row.measure.needs_height]
    reported = reported_row(found, prosthetic)
    rows.sort(key=lambda row: (reported is None or row.measure != reported.measure, -row.difference.ratio))
    return {kind: row for kind in JointKind for row in rows[::-1] if row.measure.kind == kind}


def cautions_of(parts: Sequence[Part], *assessments: Callable[[Part], Assessment]) -> list[str]:
    """Why something is read with caution, with the letters of the walks: "A, B: ..."; few strides are stated once."""
    letters: dict[str, list[str]] = {}
    for assessment in assessments:
        for part in parts:
            for reason in assessment(part).reasons:
                if reason.verdict is Verdict.CARE and reason.gate != STRIDES_GATE:
                    letters.setdefault(gate_words(reason).why, []).append(part.letter)
    reasons: dict[str, list[str]] = {}
    for why, own in letters.items():
        reasons.setdefault(", ".join(dict.fromkeys(own)), []).append(why)
    return [f"{called}: {' '.join(every)}" for called, every in reasons.items()]


def cautions_of_table(found: Comparison, prosthetic: Side) -> list[str]:
    """The same of what the table shows and no curve: times and distances, and the sound side's joints."""
    stated = [(leg_name(side), cautions_of(found.parts, _timing_of(side), _distance_of(side))) for side in found.sides]
    stated += [
        (name_of(joint), cautions_of(found.parts, shape_of(joint)))
        for joint in found.joints
        if joint.side is not prosthetic
    ]
    pattern = tr("Caution, {where}. {reasons}")
    return [pattern.format(where=where, reasons=" ".join(reasons)) for where, reasons in stated if reasons]


def shape_of(joint: Joint) -> Callable[[Part], Assessment]:
    """What may be stated of a joint's curve, in each part."""
    return lambda part: part.verdicts.joint(joint).shape


def caution_of_row(row: Compared) -> list[str]:
    """The same of one measure."""
    if row.measure.is_of_walk:
        return cautions_of([row.against, row.part], lambda part: part.assessment_of_walk(row.measure.column))
    return cautions_of([row.against, row.part], lambda part: part.assessment(row.side, row.measure.column))


def _timing_of(side: Side) -> Callable[[Part], Assessment]:
    return lambda part: part.verdicts.leg(side).timing


def _distance_of(side: Side) -> Callable[[Part], Assessment]:
    return lambda part: part.verdicts.leg(side).distance


def _of(found: Comparison, columns: Iterable[str], side: Side | None) -> list[Compared]:
    """Of one leg, or of both where `side` is None."""
    of_side = [row for row in found.rows if row.measure.is_of_walk or row.side is side]
    return [row for column in columns for row in of_side if row.measure.column == column]


def _fitted(found: Comparison, prosthetic: Side) -> list[Compared]:
    return [found.compare(measure, prosthetic, found.parts[1], found.against) for measure in FITTED]


def _beyond(found: Comparison, side: Side) -> list[Compared]:
    beyond = [row for row in found.rows if row.side is side and row.exceeds and may_be_stated(row)]
    return sorted(_without_family(beyond), key=lambda row: -row.difference.ratio)


def _others(rows: Iterable[Compared], usual: Sequence[Compared], most: int) -> list[Compared]:
    """Those of other measures than the usual ones, each once."""
    shown = {LENGTH, *(row.measure.column for row in usual)}
    return list({row.measure.column: row for row in rows if row.measure.column not in shown}.values())[:most]


def _without_family(rows: Sequence[Compared]) -> list[Compared]:
    """A range and the excursion that makes most of it are one movement: the excursion is reported."""
    reported = {(row.measure.column, row.difference.difference > 0) for row in rows}
    return [row for row in rows if (FAMILIES.get(row.measure.column), row.difference.difference > 0) not in reported]
