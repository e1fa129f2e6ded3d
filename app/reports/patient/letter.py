"""The patient letter: one number in plain words, in the patient's language, on a page of its own.

Sentences are short, and only what can be read without care is reported. Where no knee is, walking speed is the number.
"""

import datetime
import math
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files

from app.charts.cycles import is_spread_enough
from app.charts.drawing import Picture
from app.reports.patient.document import PAGES, draw_pages, facts_of, set_pages
from app.reports.patient.letter_pictures import LetterValue, goal_bar, leg_picture, speed_picture
from app.summary.course import CourseCondition, change
from app.summary.facts import Facts
from app.summary.goals import GoalFigure
from app.summary.plain_text import shortened, typed
from app.summary.report_dates import date_of
from app.summary.request import ReportRequest
from app.wording.dates import MONTHS, day_and_month, long_date
from app.wording.translation import figure_text, later, spoken_in
from core.body import Side
from core.goals import GoalOf, held
from core.parameters import KNEE, SPEED
from core.verdicts.goals import GoalStanding
from core.verdicts.measurement_error import Difference
from core.verdicts.model import Verdict
from core.verdicts.quantities import assessment_of_both

TEMPLATE = files("resources") / "report" / "letter.typ"
Say = Callable[[str], str]
NAME_LENGTH, CODE_LENGTH = 32, 24
STEPS = {KNEE: 10.0, SPEED: 0.2}  # what the ends of the goal's bar are rounded to

NUMBERS = {
    (KNEE, Side.LEFT, True): later("Your left knee now bends {now} degrees."),
    (KNEE, Side.RIGHT, True): later("Your right knee now bends {now} degrees."),
    (KNEE, Side.LEFT, False): later("Your left knee bends {now} degrees."),
    (KNEE, Side.RIGHT, False): later("Your right knee bends {now} degrees."),
    (SPEED, None, True): later("You now walk {now} metres in a second."),
    (SPEED, None, False): later("You walk {now} metres in a second."),
}
NOTHING = later("Today's measurement gave no number.")
NOT_YOU = later("The measurement was not good enough. This does not reflect how you walk.")
WAS_IN = {
    KNEE: later("In {month} it was {first} degrees."),
    SPEED: later("In {month} it was {first} metres in a second."),
}
WAS_ON = {
    KNEE: later("On {day} it was {first} degrees."),
    SPEED: later("On {day} it was {first} metres in a second."),
}
IS_LARGER = later("The change is larger than our measuring error.")
IS_WITHIN = later("The change may be measuring error.")
FIRST_TIME = later("This is your first measurement.")
MEANING = {
    KNEE: later("The knee bends as you swing the leg forward. Then your foot clears the floor."),
    SPEED: later("Walking speed is how far you come in one second."),
}
GOALS = {KNEE: later("Your goal: {value} degrees"), SPEED: later("Your goal: {value} metres in a second")}
NO_GOAL = {KNEE: later("How far your knee bends, in degrees"), SPEED: later("How far you walk in a second, in metres")}
LEFT_TO_GOAL = {
    KNEE: later("{left} degrees are left to the goal we agreed."),
    SPEED: later("{left} metres in a second are left to the goal we agreed."),
}
ABOUT_GOAL = later("You are about at your goal.")
GOAL_REACHED = later("You have reached the goal we agreed.")
FASTER_IN = later("You also walk faster than in {month}.")
FASTER_ON = later("You also walk faster than on {day}.")
SLOWER_IN = later("You walk slower than in {month}.")
SLOWER_ON = later("You walk slower than on {day}.")
AS_FAST_IN = later("You walk about as fast as in {month}.")
AS_FAST_ON = later("You walk about as fast as on {day}.")
SPEED_GOAL_REACHED = later("You have reached your goal for walking speed.")
SPEED_GOAL_ABOUT = later("You are about at your goal for walking speed.")
SPEED_GOAL_LEFT = later("Your goal for walking speed is still ahead.")


@dataclass(frozen=True, slots=True)
class _Number:
    """The letter's one number, what it was at the first visit that can be read, and what is agreed about it."""

    column: str
    side: Side | None
    now: float
    goal: GoalFigure | None
    before: float = math.nan
    day: datetime.date | None = None
    since: Difference | None = None


def make_letter(request: ReportRequest, language: str) -> bytes:
    """Make the letter's PDF, in a language as "de"; errors as in `make_report`."""
    return set_pages(_template(), letter_data(request, language), request.made_at)


def letter_pages(request: ReportRequest, language: str, ppi: float) -> list[bytes]:
    """The letter as PNG, of so many px an inch."""
    return draw_pages(_template(), letter_data(request, language), request.made_at, ppi)


def letter_data(request: ReportRequest, language: str) -> dict[str, object]:
    """All that the template sets."""
    say, facts = spoken_in(language), facts_of(request)
    today = date_of(request.visit.recording(request.shown).started or request.visit.session.started)
    number = _knee(request, facts) or _speed(request, facts)
    words = _LetterWords(say, language, today, number)
    session = request.visit.session
    title = say(later("Your walking"))
    return {
        "paper": "us-letter" if request.paper == "letter" else "a4",
        "language": language,
        "title": title,
        "subject": say(later("How you walk, measured with small sensors on your legs.")),
        "head": {
            "brand": "Gaitwright",
            "kind": title,
            "simulated": say(later("SIMULATED DATA, not a person")) if facts.is_simulated else "",
            "code": typed(shortened(session.patient.code, CODE_LENGTH), CODE_LENGTH),
            "date": long_date(today, say) if today is not None else "",
        },
        "foot": {"use": say(later("Research use. Not a medical device.")), "software": "", "page": ""},
        "number": words.number(),
        "beside": words.beside(has_earlier=len(request.course) > 1),
        "picture": None if number is None else words.picture().as_data(),
        "bar_title": "" if number is None else words.bar_title(),
        "bar": None if number is None else words.bar().as_data(),
        "texts": [] if number is None else words.texts(_speed(request, facts), facts),
        "agreed": say(later("What we agreed")),
        "questions": _questions(request, say),
    }


def _template() -> bytes:
    return PAGES.read_bytes() + TEMPLATE.read_bytes()


def _knee(request: ReportRequest, facts: Facts) -> _Number | None:
    """The knee of the affected side, else of the first; None unless it can be read without care."""
    side = facts.first_and_second[0]
    found = facts.value(side, KNEE)
    is_read = facts.is_worn(side, KNEE) and facts.assessment(side, KNEE).verdict is Verdict.READ
    if side not in facts.gait or not is_read or not is_spread_enough(found.n) or not math.isfinite(found.mean):
        return None
    return _with_first(request, _Number(KNEE, side, found.mean, _goal(facts, KNEE, GoalOf(side.value))))


def _speed(request: ReportRequest, facts: Facts) -> _Number | None:
    now = facts.speed_m_s
    if not math.isfinite(now) or assessment_of_both(facts.verdicts, "speed_m_s").verdict is not Verdict.READ:
        return None
    return _with_first(request, _Number(SPEED, None, now, _goal(facts, SPEED, GoalOf.WALK)))


def _goal(facts: Facts, column: str, of: GoalOf) -> GoalFigure | None:
    return next((one for one in facts.goals if one.goal.key == (column, of)), None)


def _with_first(request: ReportRequest, number: _Number) -> _Number:
    """With the first of the earlier visits at which this can be read under the same condition."""
    *earlier, now = request.course or (None,)
    condition = request.visit.recording(request.shown).returned_to
    current = now.course.condition(condition) if now is not None and now.course is not None else None
    for visit in earlier if current is not None else ():
        walked = visit.course.condition(condition) if visit is not None and visit.course is not None else None
        if visit is None or walked is None or current is None:
            continue
        found = _read(walked, number)
        since = change(current, walked, number.column, number.side)
        if math.isfinite(found) and since is not None and since.is_judged:
            return _Number(number.column, number.side, number.now, number.goal, found, visit.day, since)
    return number


def _read(walked: CourseCondition, number: _Number) -> float:
    figure = walked.figure(number.column, number.side)
    is_read = figure is not None and figure.verdict is Verdict.READ and figure.is_reported
    return figure.found.mean if figure is not None and is_read else math.nan


@dataclass(frozen=True, slots=True)
class _LetterWords:
    """What is stated of a number, in the letter's language; values are rounded once and subtracted as printed."""

    say: Say
    language: str
    today: datetime.date | None
    found: _Number | None

    def number(self) -> str:
        if (found := self.found) is None:
            return self.say(NOTHING)
        now = self.value(found.now)
        stated = self.say(NUMBERS[found.column, found.side, found.day is not None]).format(now=now)
        return stated.replace(f"{now} ", f"{now}\N{NO-BREAK SPACE}")

    def beside(self, *, has_earlier: bool) -> list[str]:
        found = self.found
        if found is None:
            return [self.say(NOT_YOU)]
        if found.day is None or found.since is None:
            return [] if has_earlier else [self.say(FIRST_TIME)]
        first = self.value(found.before)
        stated = [self.since(WAS_IN[found.column], WAS_ON[found.column], found.day).replace("{first}", first)]
        if self.value(found.now) != first:
            apart = abs(float(self.rounded(found.now)) - float(self.rounded(found.before)))
            is_larger = found.since.exceeds and apart > found.since.error
            stated.append(self.say(IS_LARGER if is_larger else IS_WITHIN))
        return stated

    def picture(self) -> Picture:
        found = self._found
        now, before, _ = self.shown()
        alt = " ".join([self.number(), *self.beside(has_earlier=True)])
        if found.side is not None:
            return leg_picture(found.side, now, before, alt)
        return speed_picture(now, before, alt)

    def bar_title(self) -> str:
        goal = self._goal_value
        if math.isnan(goal):
            return self.say(NO_GOAL[self._found.column])
        return self.say(GOALS[self._found.column]).format(value=self.value(goal))

    def bar(self) -> Picture:
        now, before, goal = self.shown()
        stated = [one for one in (before, now, goal) if one is not None]
        alt = f"{self.bar_title()}. " + ", ".join(f"{one.when} {one.printed}" for one in stated) + "."
        return goal_bar(now, before, goal, STEPS[self._found.column], self._found.side, alt)

    def texts(self, speed: _Number | None, facts: Facts) -> list[list[str]]:
        found = self._found
        stated = [
            [self.say(later("What this means")), " ".join([self.say(MEANING[found.column]), *self._to_goal(facts)])]
        ]
        if found.column != SPEED and speed is not None and (words := self._of_speed(speed, facts)):
            stated.append([self.say(later("Your walking speed")), words])
        return stated

    def shown(self) -> tuple[LetterValue, LetterValue | None, LetterValue | None]:
        """Today's value, that of the first visit, and the goal, as pictures have them."""
        found, unit = self._found, "°" if self._found.column == KNEE else ""
        now = LetterValue(found.now, self.value(found.now) + unit, self.say(later("Today")))
        before, goal = None, None
        if found.day is not None:
            before = LetterValue(found.before, self.value(found.before) + unit, self.when(found.day))
        if not math.isnan(self._goal_value):
            goal = LetterValue(self._goal_value, self.value(self._goal_value) + unit, self.say(later("Goal")))
        return now, before, goal

    def when(self, day: datetime.date) -> str:
        """The month, with its year where it is another; within the month of today the day."""
        if self.today is None or (day.year, day.month) != (self.today.year, self.today.month):
            month = self.say(MONTHS[day.month - 1])
            return month if self.today is not None and day.year == self.today.year else f"{month} {day.year}"
        return day_and_month(day, self.say)

    def since(self, of_month: str, of_day: str, day: datetime.date) -> str:
        is_same_month = self.today is not None and (day.year, day.month) == (self.today.year, self.today.month)
        words = self.when(day)
        return (
            self.say(of_day).replace("{day}", words) if is_same_month else self.say(of_month).replace("{month}", words)
        )

    def rounded(self, value: float) -> str:
        return figure_text(value, ".0f" if self._found.column == KNEE else ".1f", "en")

    def value(self, value: float) -> str:
        """In the letter's language; a goal with the digits that it has."""
        is_goal = value == self._goal_value
        form = "g" if is_goal else ".0f" if self._found.column == KNEE else ".1f"
        return figure_text(value, form, self.language)

    @property
    def _found(self) -> _Number:
        assert self.found is not None
        return self.found

    @property
    def _goal_value(self) -> float:
        goal = self._found.goal
        return math.nan if goal is None or not held([goal.goal]) else goal.goal.value

    def _to_goal(self, facts: Facts) -> list[str]:
        goal = self._found.goal
        if goal is None or goal.verdict is not Verdict.READ or goal not in facts.reported_goals:
            return []
        if goal.standing is GoalStanding.REACHED:
            return [self.say(GOAL_REACHED)]
        if goal.standing in (GoalStanding.REACHED_INSIDE, GoalStanding.SHORT_INSIDE):
            return [self.say(ABOUT_GOAL)]
        if goal.standing is not GoalStanding.SHORT:
            return []
        left = abs(float(self.rounded(self._found.now)) - goal.goal.value)
        return [self.say(LEFT_TO_GOAL[self._found.column]).format(left=figure_text(left, ".3g", self.language))]

    def _of_speed(self, speed: _Number, facts: Facts) -> str:
        """How the speed has changed and where its goal is, without a number: the letter has one."""
        stated = []
        if speed.day is not None and speed.since is not None:
            is_more = speed.now > speed.before
            patterns = (FASTER_IN, FASTER_ON) if is_more else (SLOWER_IN, SLOWER_ON)
            stated.append(self.since(*(patterns if speed.since.exceeds else (AS_FAST_IN, AS_FAST_ON)), speed.day))
        goal = speed.goal
        if goal is not None and goal.verdict is Verdict.READ and goal in facts.reported_goals:
            of_standing = {
                GoalStanding.REACHED: SPEED_GOAL_REACHED,
                GoalStanding.REACHED_INSIDE: SPEED_GOAL_ABOUT,
                GoalStanding.SHORT_INSIDE: SPEED_GOAL_ABOUT,
                GoalStanding.SHORT: SPEED_GOAL_LEFT,
            }
            stated.append(self.say(of_standing.get(goal.standing, "")))
        return " ".join(filter(None, stated))


def _questions(request: ReportRequest, say: Say) -> str:
    operator = request.operator or request.visit.session.operator
    who = [typed(one, NAME_LENGTH) for one in (operator, request.clinic) if one.strip()]
    if not who:
        return say(later("Questions? Ask your therapist."))
    return say(later("Questions? {who}")).format(who=", ".join(who))
