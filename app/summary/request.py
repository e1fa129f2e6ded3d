"""Contents of a report request: a visit, the walks chosen from it, and what the clinic stated about it."""

from dataclasses import dataclass
from datetime import datetime

from app.summary.alignments import alignments_of
from app.summary.conditions import Part
from app.summary.course_lanes import CourseVisit
from app.summary.visits import by_stated_condition
from app.wording.recordings import ShownName, shown_names
from core.alignment import root_of
from core.results import Analysis, RecordingAnalysis
from core.session import Recording, RecordingKind, Session
from core.video.key_frames import KeyFrame

MAX_CONDITIONS = 3  # more lines in one panel cannot be distinguished
PAPERS = ("a4", "letter")


@dataclass(frozen=True, slots=True)
class AnalysedVisit:
    """One session and its analysis."""

    session: Session
    analysis: Analysis

    def walk(self, name: str) -> RecordingAnalysis:
        """Give the analysis of one walk; raises KeyError where it was not analysed."""
        for recording in self.analysis.recordings:
            if recording.name == name and recording.kind is RecordingKind.WALKING:
                return recording
        raise KeyError(name)

    def recording(self, name: str) -> Recording:
        """Give the recording as it was entered."""
        return next(recording for recording in self.session.recordings if recording.name == name)

    def condition_of(self, name: str) -> str:
        """Under which condition a recording was walked, as it was typed; empty where none was stated."""
        return next((one.condition for one in self.session.recordings if one.name == name), "")

    @property
    def shown_names(self) -> dict[str, ShownName]:
        """What each recording is called, by its name."""
        return shown_names(self.session.recordings)

    def walk_names(self) -> tuple[str, ...]:
        return tuple(r.name for r in self.analysis.recordings if r.kind is RecordingKind.WALKING)


@dataclass(frozen=True, slots=True)
class ReportRequest:
    """What the report of a visit shows.

    `walks`: names of the walks: one, or up to three conditions in the order of their letters. The last one is shown on
    every page.
    `comment`, `comment_by`: the clinical comment that was confirmed, and who confirmed it; empty: none is printed.
    `course`: the patient's visits in order of time, this one the last: page one states what has changed.
    """

    visit: AnalysedVisit
    walks: tuple[str, ...]
    made_at: datetime  # when the report is made; must know its time zone
    software_version: str
    comment: str = ""
    operator: str = ""
    clinic: str = ""
    paper: str = "a4"
    earlier: AnalysedVisit | None = None  # A visit before this one to compare with, in place of the conditions
    course: tuple[CourseVisit, ...] = ()
    comment_by: str = ""
    thin: Part | None = None  # the condition at the earlier visit whose curves page one draws thin; None: none is
    has_course_page: bool = True  # whether a page shows the course, from two visits on
    key_frames: tuple[KeyFrame, ...] = ()  # of the shown walk's video, where they were asked for

    def __post_init__(self) -> None:
        if self.made_at.tzinfo is None:
            raise ValueError("made_at has no time zone")
        if self.paper not in PAPERS:
            raise ValueError(f"paper is {self.paper}, expected one of {PAPERS}")
        if not 1 <= len(self.walks) <= MAX_CONDITIONS:
            raise ValueError(f"{len(self.walks)} walks, expected 1 to {MAX_CONDITIONS}")

    @property
    def shown(self) -> str:
        return self.walks[-1]


def default_walks(visit: AnalysedVisit) -> tuple[str, ...]:
    """Choose the walk with most usable strides for each of the last conditions; empty: no walk was analysed.

    Of a chain of alignments the one that it began with comes first.
    """
    names = visit.walk_names()
    parts = by_stated_condition(visit.analysis, visit.session.recordings).values()
    by_time = sorted(parts, key=lambda part: max(names.index(walk.name) for walk in part.walks))
    chosen = by_time[-MAX_CONDITIONS:]
    changes = alignments_of(visit.session.recordings)
    start = root_of(changes, chosen[-1].name) if chosen else ""
    first = next((part for part in by_time if part.name == start and changes.get(chosen[-1].name) is not None), None)
    if first is not None and first not in chosen:
        chosen = [first, *chosen[1:]]
    most = [max(part.walks, key=_usable_strides).name for part in chosen]
    return tuple(most) or names[-1:]


def _usable_strides(walk: RecordingAnalysis) -> int:
    return sum(int(gait.strides.is_used.sum()) for gait in walk.gait.values())
