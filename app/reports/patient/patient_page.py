"""A page that the patient takes home: one number in plain words, in the patient's language, and what was agreed.

Sentences are short, and only what can be read without care is reported.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from app.charts.cycles import is_spread_enough
from app.charts.drawing import COLOURS, MM, Picture, line, picture
from app.reports.blocks import Block
from app.summary.comparison import compare_legs
from app.summary.course import CourseCondition, change
from app.summary.course_lanes import CourseVisit
from app.summary.facts import Facts
from app.summary.plain_text import isolated, shortened, typed
from app.summary.report_dates import date_of
from app.summary.request import ReportRequest
from app.theme.colours import PAPER
from app.wording.dates import day_and_month, long_date
from app.wording.translation import figure_text, later, spoken_in
from core.body import Side
from core.goals import GoalOf
from core.parameters import KNEE, SPEED
from core.verdicts.goals import GoalStanding
from core.verdicts.measurement_error import Difference
from core.verdicts.model import Verdict
from core.verdicts.quantities import assessment_of_both

Say = Callable[[str], str]
NAME_LENGTH = 24
FASTER_M_S = 0.1  # what a person notices, and what moves a knee by a degree
LEG_WIDTH, LEG_HEIGHT = 46 * MM, 57 * MM
THIGH, SHANK, FOOT = 68.0, 62.0, 26.0  # points
LEAN_DEG = 22.0  # of the thigh, forward, when the leg swings through
WIDE = ((THIGH, 17.0), (SHANK, 13.0), (FOOT, 9.0))

LEFT_NOW = later("Your left knee now bends {now} degrees. At your first visit it was {first}.")
RIGHT_NOW = later("Your right knee now bends {now} degrees. At your first visit it was {first}.")
LEFT_ALONE = later("Your left knee bends {now} degrees.")
RIGHT_ALONE = later("Your right knee bends {now} degrees.")
UNREADABLE = later("Today's measurement was not good enough to give a number. This does not reflect how you walk.")
MEANING = later("When you swing your leg, the knee must bend so that your foot clears the floor.")
OFF_BY = later("Our measurement can be off by about {error} degrees.")
MORE = later("Your knee now bends {change}° more than at the first visit.")
LESS = later("Your knee now bends {change}° less than at the first visit.")
SAME = later("At the first visit it was the same.")
REAL = later("{change}° is clearly more than that: this is a real change.")
UNSURE = later("So we cannot say that it has changed.")
LEFT_OTHER = later("Your left knee bends {other} degrees.")
RIGHT_OTHER = later("Your right knee bends {other} degrees.")
APART = later("The difference is {change}°. Our measurement can be off by about {error} degrees.")
DIFFERENT = later("So your knees clearly differ.")
ALIKE = later("So we cannot say that your knees differ.")
SPEED_NOW = later("You now walk {now} metres in a second. At the first visit it was {first}.")
SPEED_ALONE = later("You walk {now} metres in a second.")
BY_ITSELF = later("When people walk faster, their knees bend a little more by themselves.")
GOALS_OF = {
    (KNEE, GoalOf.LEFT): later("Bend of your left knee"),
    (KNEE, GoalOf.RIGHT): later("Bend of your right knee"),
    (SPEED, GoalOf.WALK): later("Walking speed"),
}
AT_LEAST = later("{what}: at least {value}. We agreed this on {day}.")
AT_MOST = later("{what}: at most {value}. We agreed this on {day}.")
DEGREES, METRES = later("{value} degrees"), later("{value} metres in a second")
REACHED = later("You have reached this goal.")
LIMITS = later(
    "The sensors do not measure pain or strength. They cannot show how you will walk in a month. "
    "Your therapist looks at this together with everything else."
)


@dataclass(frozen=True, slots=True)
class _First:
    """The first visit that can be read: its day, its condition's figures, and what the knee has changed by since."""

    visit: CourseVisit
    walked: CourseCondition
    knee_deg: float
    since: Difference


def patient_page(request: ReportRequest, facts: Facts) -> Block:
    """All of the page, in the language that the request names."""
    say = spoken_in(request.patient_language)
    side = facts.first_and_second[0]
    other = facts.first_and_second[1]
    shown = _knee_deg(facts, side)
    first = _first_visit(request, side) if math.isfinite(shown) else None
    started = date_of(request.visit.recording(request.shown).started or request.visit.session.started)
    title = (
        say(later("Your walking, {day}")).format(day=long_date(started, say)) if started else say(later("Your walking"))
    )
    code = typed(shortened(request.visit.session.patient.code, NAME_LENGTH), NAME_LENGTH)
    has_code = bool(request.visit.session.patient.code.strip())
    head = {
        "kind": "patient",
        "language": request.patient_language,
        "title": title,
        "who": " · ".join(
            [
                *([say(later("For {code}")).format(code=code)] if has_code else []),
                say(later("measured with small sensors on your legs")),
            ]
        ),
        "question": say(later("How far does your knee bend when you swing the leg forward?")),
        "simulated": say(later("SIMULATED DATA, not a person")) if facts.is_simulated else "",
        "agreed": say(later("What we agreed")),
        "goals": _goals(facts, say, request.patient_language),
        "questions": _questions(request, say),
    }
    if not math.isfinite(shown):
        limits = [say(later("What we cannot say")), say(LIMITS)]
        return head | {"answer": say(UNREADABLE), "figures": [], "texts": [limits]}
    return head | {
        "answer": _answer(side, shown, first, say),
        "figures": _figures(facts, side, other, shown, first, say),
        "texts": _texts(facts, side, other, shown, first, say, request.patient_language),
    }


def _knee_deg(facts: Facts, side: Side) -> float:
    """The mean; NaN unless it can be read without care."""
    found = facts.value(side, KNEE)
    is_read = facts.is_worn(side, KNEE) and facts.assessment(side, KNEE).verdict is Verdict.READ
    return found.mean if side in facts.gait and is_read and is_spread_enough(found.n) else math.nan


def _first_visit(request: ReportRequest, side: Side) -> _First | None:
    """The first of the earlier visits whose knee can be read under the same condition."""
    *earlier, now = request.course or (None,)
    condition = request.visit.recording(request.shown).condition
    current = now.course.condition(condition) if now is not None and now.course is not None else None
    if current is None:
        return None
    for visit in earlier:
        walked = visit.course.condition(condition) if visit is not None and visit.course is not None else None
        figure = walked.figure(KNEE, side) if walked is not None else None
        if (
            visit is None
            or walked is None
            or figure is None
            or figure.verdict is not Verdict.READ
            or not figure.is_reported
        ):
            continue
        since = change(current, walked, KNEE, side)
        if since is not None and since.is_judged:
            return _First(visit, walked, figure.found.mean, since)
    return None


def _answer(side: Side, now_deg: float, first: _First | None, say: Say) -> str:
    if first is None:
        return say(LEFT_ALONE if side is Side.LEFT else RIGHT_ALONE).format(now=round(now_deg))
    stated = say(LEFT_NOW if side is Side.LEFT else RIGHT_NOW)
    return stated.format(now=round(now_deg), first=round(first.knee_deg))


def _figures(
    facts: Facts, side: Side, other: Side, now_deg: float, first: _First | None, say: Say
) -> list[dict[str, object]]:
    today = {Side.LEFT: say(later("Today, left leg")), Side.RIGHT: say(later("Today, right leg"))}
    found = []
    if first is not None:
        label = say(later("First visit, {day}")).format(day=day_and_month(first.visit.day, say))
        found.append(_figure(first.knee_deg, None, label))
    found.append(_figure(now_deg, side, today[side]))
    if math.isfinite(other_deg := _knee_deg(facts, other)):
        found.append(_figure(other_deg, other, today[other]))
    return found


def _figure(knee_deg: float, side: Side | None, label: str) -> dict[str, object]:
    drawn = leg_picture(knee_deg, side, f"{label}: {round(knee_deg)}°.")
    return {"picture": drawn.as_data(), "value": f"{round(knee_deg)}°", "label": label}


def _texts(
    facts: Facts, side: Side, other: Side, now_deg: float, first: _First | None, say: Say, language: str
) -> list[list[str]]:
    meaning = [say(MEANING)]
    if first is not None:
        meaning += _changed(now_deg, first, say)
    texts = [[say(later("What this means")), " ".join(meaning)]]
    other_deg = _knee_deg(facts, other)
    between = compare_legs(facts.part, KNEE, (side, other)) if math.isfinite(other_deg) else None
    if between is not None and between.is_judged:
        apart = abs(round(now_deg) - round(other_deg))
        stated = [
            say(LEFT_OTHER if other is Side.LEFT else RIGHT_OTHER).format(other=round(other_deg)),
            say(APART).format(change=apart, error=math.ceil(between.error)),
            say(DIFFERENT if between.exceeds else ALIKE),
        ]
        texts.append([say(later("Your other leg")), " ".join(stated)])
    if speed := _speed(facts, first, say, language):
        texts.append([say(later("How fast you walk")), speed])
    texts.append([say(later("What we cannot say")), say(LIMITS)])
    return texts


def _changed(now_deg: float, first: _First, say: Say) -> list[str]:
    """The difference stated is that of the printed values, so that whoever subtracts finds the same."""
    apart, error = round(now_deg) - round(first.knee_deg), math.ceil(first.since.error)
    stated = say(MORE if apart > 0 else LESS).format(change=abs(apart)) if apart else say(SAME)
    is_real = first.since.exceeds and abs(apart) > error
    verdict = say(REAL).format(change=abs(apart)) if is_real else say(UNSURE)
    return [stated, say(OFF_BY).format(error=error), verdict]


def _speed(facts: Facts, first: _First | None, say: Say, language: str) -> str:
    now = facts.speed_m_s
    if not math.isfinite(now) or assessment_of_both(facts.verdicts, "speed_m_s").verdict is not Verdict.READ:
        return ""
    before = first.walked.figure(SPEED) if first is not None else None
    if before is None or before.verdict is not Verdict.READ or not before.is_reported:
        return say(SPEED_ALONE).format(now=figure_text(now, ".1f", language))
    stated = say(SPEED_NOW).format(
        now=figure_text(now, ".1f", language), first=figure_text(before.found.mean, ".1f", language)
    )
    return f"{stated} {say(BY_ITSELF)}" if now - before.found.mean > FASTER_M_S else stated


def _goals(facts: Facts, say: Say, language: str) -> list[str]:
    """What was agreed about the measures on this page; a goal is called reached only where it is read without care."""
    stated = []
    for found in facts.goals:
        goal = found.goal
        what = GOALS_OF.get(goal.key)
        if what is None:
            continue
        is_angle = goal.column == KNEE
        value = figure_text(goal.value, "g", language)
        words = say(AT_MOST if goal.is_at_most else AT_LEAST).format(
            what=say(what),
            value=say(DEGREES if is_angle else METRES).format(value=value),
            day=day_and_month(goal.agreed, say),
        )
        is_read = found.verdict is Verdict.READ and found in facts.reported_goals
        stated.append(f"{words} {say(REACHED)}" if is_read and found.standing is GoalStanding.REACHED else words)
    return stated


def _questions(request: ReportRequest, say: Say) -> str:
    operator = request.operator or request.visit.session.operator
    if not operator:
        return say(later("Questions? Ask your therapist."))
    return say(later("Questions? Ask your therapist: {name}.")).format(name=isolated(typed(operator, NAME_LENGTH)))


def leg_picture(knee_deg: float, side: Side | None, alt: str) -> Picture:
    """A leg that swings through with its knee bent by so much: grey of an earlier visit, an outline if it is right."""
    hip = (LEG_WIDTH / 2 - 14, 16.0)
    knee = _from(hip, THIGH, LEAN_DEG)
    ankle = _from(knee, SHANK, LEAN_DEG - knee_deg)
    toes = _from(ankle, FOOT, LEAN_DEG - knee_deg + 80)
    joints = (hip, knee, ankle, toes)
    colour = COLOURS[side] if side is not None else PAPER.grid
    parts = []
    outline = 2.2 if side is Side.RIGHT else 0.0
    for paint, thinner in ((colour, 0.0), *([(PAPER.paper, 2 * outline)] if outline else [])):
        for (_, width), start, end in zip(WIDE, joints, joints[1:], strict=False):
            ends = f'x1="{start[0]:.2f}" y1="{start[1]:.2f}" x2="{end[0]:.2f}" y2="{end[1]:.2f}"'
            parts.append(f'<line {ends} stroke="{paint}" stroke-width="{width - thinner}" stroke-linecap="round"/>')
    straight = _from(knee, 58.0, LEAN_DEG)
    parts.append(line(*knee, *straight, PAPER.note, 0.8, "2 2"))
    start, end = _from(knee, 44.0, LEAN_DEG), _from(knee, 44.0, LEAN_DEG - knee_deg)
    arc = f"M{start[0]:.2f} {start[1]:.2f}A44 44 0 0 1 {end[0]:.2f} {end[1]:.2f}"
    parts.append(f'<path d="{arc}" fill="none" stroke="{PAPER.ink}" stroke-width="1.6"/>')
    look = f'fill="{PAPER.paper}" stroke="{PAPER.ink}" stroke-width="1.4"'
    parts.append(f'<circle cx="{knee[0]:.2f}" cy="{knee[1]:.2f}" r="4" {look}/>')
    parts.append(line(0, LEG_HEIGHT - 1, LEG_WIDTH, LEG_HEIGHT - 1, PAPER.note, 0.6))
    return picture(parts, LEG_WIDTH, LEG_HEIGHT, alt)


def _from(point: tuple[float, float], length: float, forward_deg: float) -> tuple[float, float]:
    """The other end of a segment that hangs down, tilted forward by so much; forward is to the right, y downwards."""
    tilt = math.radians(forward_deg)
    return point[0] + length * math.sin(tilt), point[1] + length * math.cos(tilt)
