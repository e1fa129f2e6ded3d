"""Result of a walk. Its answer and a verdict for each joint, beside the legs, in the words of the results page."""

from collections.abc import Collection, Iterator

from app.summary.facts import Facts
from app.summary.headline import headline_of
from app.summary.interval_words import interval_in_figures
from app.summary.numbers_in_words import in_words, signed
from app.summary.request import AnalysedVisit
from app.summary.status import why
from app.summary.walk_figures import MAY_BE_MIRRORED, doubt_in, reason_in_words, verdict_of
from app.summary.what_differs import what_differs
from app.wording.body import name_of, side_name
from app.wording.translation import capitalised, later, tr
from app.wording.verdicts import verdict_word
from core.body import Joint, Side
from core.results import Analysis, RecordingAnalysis
from core.session import RecordingKind, Session
from core.verdicts.status import WITH_HEIGHT, joint_status

MOST_DIFFERENCES = 5
KEY = later(
    "Thick line in the leg's colour: result. Band around it: uncertainty, 2 SD. Thin light "
    "line: published method. Thin grey line: orientation. Bars below show phases. Full colour: "
    "loading response. Pale: foot flat. Narrow: pre-swing. Thin grey: swing."
)
NOTHING = later("This recording has no joint angles. Choose a walk below.")


def panel(session: Session, analysis: Analysis, recording: RecordingAnalysis, drawn: Collection[Side]) -> str:
    """The answer and the verdicts of one recording in Markdown; `drawn` are the sides whose legs are."""
    lines: list[str] = []
    if recording.kind is RecordingKind.WALKING:
        facts = Facts(AnalysedVisit(session, analysis), recording)
        headline = headline_of(facts)
        lines += [f"### {headline.first}", "", headline.then, "", *_largest(facts), ""]
    joints = [joint for joint in Joint if joint in recording.measured]
    lines += [_line(recording, joint, is_drawn=joint.side in drawn) for joint in joints]
    for side in Side:
        lines += [f"- {stated}" for stated in _slipped(recording, side)]
    return "\n".join([*lines, "", tr(KEY)] if joints else lines or [tr(NOTHING)])


def _largest(facts: Facts) -> Iterator[str]:
    """The largest differences between the legs with their intervals."""
    first, second = facts.first_and_second
    for row in what_differs(facts)[:MOST_DIFFERENCES] if len(facts.gait) == len(Side) else ():
        if row.difference.is_judged:
            size = signed(row.difference.difference, row.decimals) + row.unit
            pattern = tr("- {measure}, {first} − {second}: {size}, likely {interval}. {judged}")
            interval, judged = interval_in_figures(row.column, row.difference), in_words(row.difference)
            yield pattern.format(
                measure=row.name, first=first.letter, second=second.letter, size=size, interval=interval, judged=judged
            )


def _line(recording: RecordingAnalysis, joint: Joint, is_drawn: bool) -> str:
    """A joint's verdict, why it is no better, and what is drawn grey for it; no table, whose cells would not wrap."""
    found = recording.verdicts.joint(joint)
    doubt = doubt_in(found)
    verdict = tr(doubt) if doubt else verdict_word(verdict_of(found))
    reason = why(found.sign) if doubt == MAY_BE_MIRRORED else reason_in_words(found)
    grey = ""
    if is_drawn and not joint.is_hip and joint_status(recording, joint) not in WITH_HEIGHT:
        stated = (
            tr("The {side} leg and foot are shown in grey.")
            if joint.is_knee
            else tr("The {side} foot is shown in grey.")
        )
        grey = stated.format(side=side_name(joint.side))
    pattern = tr("{part}: {verdict}.")
    stated = pattern.format(part=capitalised(name_of(joint)), verdict=verdict)
    return " ".join(filter(None, [f"- **{stated}**", grey, reason]))


def _slipped(recording: RecordingAnalysis, side: Side) -> Iterator[str]:
    from_s = recording.slipped_from_s.get(side)
    if from_s is not None and len(recording.time_s) and from_s <= recording.time_s[-1]:
        stated = tr(
            "Strap moved on the {side} leg. From {time:.1f} s on, the curves of this leg are not "
            "reported; the leg is grey."
        )
        yield stated.format(side=side_name(side), time=from_s)
