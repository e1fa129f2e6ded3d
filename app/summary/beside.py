"""What a walk can stand beside: another walk of its session, or its condition on an earlier visit."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from app.charts.marks import Deviation, extreme_of
from app.summary.comparison import Compared, Comparison, Contrast
from app.summary.conditions import Part, parts_of
from app.summary.marks_on_curves import windows_of
from app.summary.numbers_in_words import fixed
from app.summary.visits import ComparedVisits
from app.wording.recordings import shown_names
from app.wording.translation import tr
from core.body import JointKind
from core.goals import NO_GOALS, AgreedGoals
from core.results import Analysis
from core.session import Recording


def walks_alone(
    analysis: Analysis, recordings: Sequence[Recording], agreed: AgreedGoals = NO_GOALS
) -> Mapping[str, Part]:
    """Every walk of a session that has strides by its name, each by itself, in order of time; called as it is shown."""
    names = shown_names(recordings)
    alone = {
        walk.name: replace(
            part, name=str(names.get(walk.name, walk.name)), walks=(walk,), calibrated=analysis.calibrated_for(walk)
        )
        for part in parts_of(analysis, recordings, agreed=agreed)
        for walk in part.walks
    }
    return {walk.name: alone[walk.name] for walk in analysis.recordings if walk.name in alone}


def beside_walk(shown: Part, other: Part, *, is_simulated: bool) -> Comparison:
    """A walk against another of its session."""
    return Comparison(Contrast.CONDITIONS, (other, shown), is_simulated=is_simulated)


def beside_visit(
    shown: Part, condition: str, visits: Sequence[ComparedVisits], *, is_first: bool, is_simulated: bool
) -> Comparison | None:
    """A condition beside itself on the first or the latest earlier visit that has it; None where none has."""
    for found in visits:
        if found.condition == condition:
            before = found.parts[0] if is_first else found.parts[-2]
            pair = before, replace(shown, visit=found.parts[-1].visit)
            return Comparison(Contrast.VISITS, pair, is_simulated=is_simulated)
    return None


def change_on_curve(row: Compared, called: str, other: str) -> Deviation:
    """A movement on the curve of the walk shown: `called`, its size, and how much that is from `other`."""
    measure, joint = row.measure, JointKind(row.measure.kind).of(row.side)
    curve_deg = row.part.cycle(joint).mean
    high, low = windows_of(measure.column)
    pattern = tr("{size} less than {other}") if row.difference.difference < 0 else tr("{size} more than {other}")
    apart = fixed(abs(row.difference.difference), measure.decimals) + measure.unit
    size = fixed(row.value.mean, measure.decimals) + measure.unit
    return Deviation(
        extreme_of(joint, curve_deg, *low, is_maximum=False),
        extreme_of(joint, curve_deg, *high, is_maximum=True),
        words=f"{called} {size}",
        more=pattern.format(size=apart, other=other),
        is_larger_than_error=True,
    )
