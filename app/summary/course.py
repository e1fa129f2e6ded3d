"""What a visit adds to the patient's course: a few figures of each condition, with what judging them needs.

They are few enough to be kept beside the session, so that home shows the course of many visits without analysing one.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from app.summary.conditions import Part
from app.summary.visits import by_condition
from app.system.tables import finite
from core.body import Joint, Side
from core.goals import OF_LEGS
from core.parameters import CADENCE, SPEED
from core.results import Analysis, RecordingAnalysis
from core.session import Recording
from core.timed.measures import (
    COLUMNS,
    PROTOCOLS,
    MeanOfAttempts,
    counted_figure,
    have_one_course,
    length_of,
    mean_of_attempts,
    on_one_course,
    rests_on_feet,
)
from core.verdicts.attempts import compare_attempts, error_between_visits
from core.verdicts.measurement_error import Difference, Judgement, compare, whisker
from core.verdicts.model import Assessment, GateReason, Verdict, together, worst
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN
from core.verdicts.quantities import OF_HIPS
from core.verdicts.sigmas import ComparisonKind
from core.verdicts.stride_means import MeanOfStrides

FORMAT = "gaitwright-course/4"
OF_A_LEG = tuple(OF_LEGS)  # all that a goal can be of, so that its course can be shown


@dataclass(frozen=True, slots=True)
class CourseFigure:
    """The mean of one measure. `side` None: of the walk. `gates`: those that were not passed; `found` is NaN where
    it is not reported or was not measured."""

    column: str
    side: Side | None
    found: MeanOfStrides
    verdict: Verdict
    gates: tuple[str, ...] = ()

    @property
    def is_reported(self) -> bool:
        return self.assessment.is_reported and self.found.n >= MIN_STRIDES_FOR_MEAN and math.isfinite(self.found.mean)

    @property
    def assessment(self) -> Assessment:
        """The verdict with the gates that led to it, without what each of them found."""
        return Assessment(self.verdict, tuple(GateReason(gate, self.verdict) for gate in self.gates))

    def whisker_at(self, speed_m_s: float) -> float:
        """Half of the error of a difference between visits walked so fast; NaN where no error is known."""
        return whisker(self.column, ComparisonKind.VISITS, self.found, speed_m_s) if self.is_reported else math.nan


@dataclass(frozen=True, slots=True)
class CourseTest:
    """What a visit's timed test is made for, over its attempts; `found` is NaN if none has it, or not reported."""

    column: str
    found: MeanOfAttempts
    verdict: Verdict
    course_m: float = math.nan  # that of all attempts; NaN where any will do, or none is known

    @property
    def is_reported(self) -> bool:
        return self.assessment.is_reported and math.isfinite(self.found.mean)

    @property
    def assessment(self) -> Assessment:
        return Assessment(self.verdict)

    @property
    def whisker(self) -> float:
        """Half of the error of a difference between visits; NaN where no error is known."""
        return 0.5 * error_between_visits(self.column) if self.is_reported else math.nan


@dataclass(frozen=True, slots=True)
class CourseCondition:
    """One condition of a visit, as it was walked last. `not_reported`: the joints whose curve may not be read.

    `tests`: those that were done under it, each once. Where it was walked in tests from a chair alone, there are no
    `figures`.
    """

    condition: str
    strides: int
    figures: tuple[CourseFigure, ...]
    not_reported: tuple[Joint, ...] = ()
    tests: tuple[CourseTest, ...] = ()

    def test(self, column: str) -> CourseTest | None:
        return next((one for one in self.tests if one.column == column), None)

    def figure(self, column: str, side: Side | None = None) -> CourseFigure | None:
        return next((one for one in self.figures if (one.column, one.side) == (column, side)), None)

    @property
    def speed_m_s(self) -> float:
        """NaN where it is not reported."""
        found = self.figure(SPEED)
        return found.found.mean if found is not None and found.is_reported else math.nan

    def between_legs(self, column: str) -> Difference | None:
        """A figure of the left leg less that of the right, in the column's unit; None where one has none."""
        left, right = (self.figure(column, side) for side in Side)
        if left is None or right is None or Verdict.NOT_MEASURED in (left.verdict, right.verdict):
            return None
        assessments, speeds = (left.assessment, right.assessment), (self.speed_m_s, self.speed_m_s)
        return compare(column, ComparisonKind.LEGS, left.found, right.found, assessments, speeds_m_s=speeds)


@dataclass(frozen=True, slots=True)
class Course:
    """What one visit gives the course. Without conditions: it has no walk with strides."""

    affected: Side | None
    conditions: tuple[CourseCondition, ...]

    def condition(self, name: str) -> CourseCondition | None:
        return next((one for one in self.conditions if one.condition == name), None)


def course_of(analysis: Analysis, recordings: Sequence[Recording]) -> Course:
    """Give a visit's figures by condition, each strapping's last, never pooled; `recordings` in time order."""
    walked, tested = by_condition(analysis, recordings), _tests(analysis, recordings)
    conditions = [
        _condition(name, walked[name], tested.get(name, ()))
        if name in walked
        else CourseCondition(name, 0, (), tests=tested[name])
        for name in dict.fromkeys((*walked, *tested))
    ]
    return Course(analysis.affected_side, tuple(conditions))


def timed_tests_of(analysis: Analysis, recordings: Sequence[Recording]) -> tuple[CourseCondition, ...]:
    """The timed tests of a visit alone, without what its walks give besides."""
    tested = _tests(analysis, recordings)
    return tuple(CourseCondition(name, 0, (), tests=tests) for name, tests in tested.items())


def _tests(analysis: Analysis, recordings: Sequence[Recording]) -> dict[str, tuple[CourseTest, ...]]:
    """The timed tests by condition, in the order of their definitions."""
    stated = {recording.name: recording.returned_to for recording in recordings}
    attempts: dict[str, list[RecordingAnalysis]] = {}
    for walk in analysis.recordings:
        if walk.timed is not None:
            attempts.setdefault(stated.get(walk.name, ""), []).append(walk)
    return {
        condition: tuple(
            _test(column, own)
            for protocol, column in COLUMNS.items()
            if (own := [walk for walk in walks if walk.timed is not None and walk.timed.protocol is protocol])
        )
        for condition, walks in attempts.items()
    }


def timed_test_of(column: str, walks: Sequence[RecordingAnalysis]) -> CourseTest | None:
    """A test over those of some walks that are one; None where none is."""
    own = [walk for walk in walks if walk.timed is not None and COLUMNS.get(walk.timed.protocol) == column]
    return _test(column, own) if own else None


def _test(column: str, walks: Sequence[RecordingAnalysis]) -> CourseTest:
    """A test over its valid attempts; what rests on the feet's way is read as that way is."""
    values, verdicts = [], []
    timed = [walk.timed for walk in walks if walk.timed is not None]
    alike = on_one_course([test for test in timed if test.is_valid] or timed)
    for walk in walks:
        assert walk.timed is not None  # only tests are given
        verdict = Verdict.READ
        if rests_on_feet(walk.timed):
            verdict = together(walk.verdicts.leg(side).distance for side in walk.gait).verdict
        is_reported = Assessment(verdict).is_reported
        values.append(counted_figure(walk.timed) if is_reported and walk.timed in alike else math.nan)
        verdicts.append(verdict)
    found = mean_of_attempts(values)
    reported = [one for one, value in zip(verdicts, values, strict=True) if math.isfinite(value)]
    return CourseTest(column, found, worst(reported) if reported else Verdict.NOT_REPORTED, length_of(alike[-1]))


def change(
    one: CourseCondition,
    first: CourseCondition,
    column: str,
    side: Side | None = None,
    *,
    is_chosen_before: bool = False,
) -> Difference | None:
    """A figure less that of an earlier visit, judged as between visits; None where one of them has none."""
    if column in PROTOCOLS:
        tests = one.test(column), first.test(column)
        if tests[0] is None or tests[1] is None or not have_one_course(tests[0].course_m, tests[1].course_m):
            return None
        wording = (tests[0].assessment, tests[1].assessment)
        return compare_attempts(column, tests[0].found, tests[1].found, wording, is_chosen_before=is_chosen_before)
    pair = one.figure(column, side), first.figure(column, side)
    if pair[0] is None or pair[1] is None:
        return None
    return compare(
        column,
        ComparisonKind.VISITS,
        pair[0].found,
        pair[1].found,
        (pair[0].assessment, pair[1].assessment),
        speeds_m_s=(one.speed_m_s, first.speed_m_s),
        is_chosen_before=is_chosen_before,
    )


def change_between_legs(one: CourseCondition, first: CourseCondition, column: str) -> Difference | None:
    """Give the change of the legs' difference since an earlier visit, with each leg's own change in its error.
    Of 25 healthy people and 21 after stroke at two visits it finds none (`felius_two_visits.csv`, stance).
    """
    now, before = one.between_legs(column), first.between_legs(column)
    if now is None or before is None or not (now.is_reported and before.is_reported):
        return None
    difference = now.difference - before.difference
    legs = [change(one, first, column, side) for side in Side]
    if any(leg is None or not leg.is_judged for leg in legs):
        return Difference(difference, math.nan, Judgement.NO_PUBLISHED_FIGURE)
    error = math.hypot(*(leg.error for leg in legs if leg is not None))
    judgement = Judgement.EXCEEDS_ERROR if abs(difference) > error else Judgement.INSIDE_ERROR
    is_unverified = any(leg.is_unverified for leg in legs if leg is not None)
    return Difference(difference, error, judgement, is_unverified=is_unverified)


def _condition(name: str, part: Part, tests: tuple[CourseTest, ...]) -> CourseCondition:
    figures = [_of_walk(part, column) for column in (SPEED, CADENCE)]
    for side in part.sides:
        for column in (one for one in OF_A_LEG if one not in OF_HIPS or part.is_measured(side, one)):
            found = part.assessment(side, column)
            figures.append(_figure(column, side, part.mean(side, column, ComparisonKind.VISITS), found))
    not_reported = []
    for joint in part.joints:
        wording = part.verdicts.joint(joint)
        if together((wording.shape, wording.sign)).verdict is Verdict.NOT_REPORTED:
            not_reported.append(joint)
    return CourseCondition(name, sum(map(part.strides, part.sides)), tuple(figures), tuple(not_reported), tests)


def _of_walk(part: Part, column: str) -> CourseFigure:
    """Of both legs, as comparisons take it."""
    return _figure(column, None, part.of_walk(column, ComparisonKind.VISITS), part.assessment_of_walk(column))


def _figure(column: str, side: Side | None, found: MeanOfStrides, assessment: Assessment) -> CourseFigure:
    gates = tuple(dict.fromkeys(reason.gate for reason in assessment.reasons))
    if not assessment.is_reported:
        found = MeanOfStrides(math.nan, math.nan, 0, math.nan, math.nan)
    return CourseFigure(column, side, found, assessment.verdict, gates)


# as it is kept


def course_in_json(course: Course) -> dict[str, Any]:
    """A course as JSON can hold it: None for NaN."""
    return {
        "format": FORMAT,
        "affected": course.affected,
        "conditions": [
            {
                "condition": one.condition,
                "strides": one.strides,
                "withheld": list(one.not_reported),
                "figures": [
                    {
                        "column": figure.column,
                        "side": figure.side,
                        "verdict": figure.verdict,
                        "gates": list(figure.gates),
                        "found": {
                            name: value if math.isfinite(value) else None
                            for name, value in asdict(figure.found).items()
                        },
                    }
                    for figure in one.figures
                ],
                "tests": [
                    {
                        "column": test.column,
                        "mean": finite(test.found.mean),
                        "attempts": test.found.attempts,
                        "verdict": test.verdict,
                        "course_m": finite(test.course_m),
                    }
                    for test in one.tests
                ],
            }
            for one in course.conditions
        ],
    }


def course_from_json(content: Any) -> Course:
    """Read what `course_in_json` was given; raises ValueError for another version's or other content."""
    try:
        if content["format"] != FORMAT:
            raise ValueError(content["format"])
        return Course(
            _side(content["affected"]),
            tuple(
                CourseCondition(
                    one["condition"],
                    one["strides"],
                    tuple(_figure_from_json(figure) for figure in one["figures"]),
                    tuple(map(Joint, one["withheld"])),
                    tuple(_test_from_json(test) for test in one["tests"]),
                )
                for one in content["conditions"]
            ),
        )
    except (KeyError, TypeError) as error:
        raise ValueError("this is no course") from error


def _figure_from_json(content: Any) -> CourseFigure:
    found: dict[str, Any] = {name: math.nan if value is None else value for name, value in content["found"].items()}
    return CourseFigure(
        content["column"],
        _side(content["side"]),
        MeanOfStrides(**found),
        Verdict(content["verdict"]),
        tuple(content["gates"]),
    )


def _test_from_json(content: Any) -> CourseTest:
    mean = math.nan if content["mean"] is None else content["mean"]
    course_m = content.get("course_m")  # earlier versions have none
    return CourseTest(
        content["column"],
        MeanOfAttempts(mean, content["attempts"]),
        Verdict(content["verdict"]),
        math.nan if course_m is None else course_m,
    )


def _side(name: str | None) -> Side | None:
    return None if name is None else Side(name)
