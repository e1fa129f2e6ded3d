"""What the patient is shown at one moment, and its words. No praise: what was reached is stated, nothing else."""

from dataclasses import dataclass

from app.wording.numbers import MINUS
from app.wording.translation import tr, tr_n
from core.body import Side
from core.targets import Target, TargetMeasure

SHOWN_STRIDES = 10
NO_VALUE = "\N{EN DASH}"


@dataclass(frozen=True, slots=True)
class PatientView:
    """`last` are the values of the last strides, SHOWN_STRIDES at most, the newest last.

    `is_waiting`: what is aimed at cannot be measured now, so no value is shown, old ones neither. `is_standing`: the
    patient is, so the last stride is over; while somebody walks it stays until the next. `has_sound`: whether a tone is
    audible where the target is reached. `steps`: of the walk that goes on, as the operator sees them; None between
    walks.
    """

    target: Target | None = None
    last: tuple[int, ...] = ()
    is_waiting: bool = False
    has_sound: bool = True
    steps: int | None = None
    is_standing: bool = False

    @property
    def value(self) -> int | None:
        """Of the last stride, until the next or until the patient is standing."""
        return self.last[-1] if self.last and not self.is_waiting and not self.is_standing else None

    @property
    def in_words(self) -> str:
        """All of it, for who cannot see it."""
        if self.target is None:
            is_counted = self.steps is not None and not self.is_waiting
            return f"{self.steps} {so_far_words(self.steps or 0)}" if is_counted else tr("One moment")
        stated = [f"{title_of(self.target)}."]
        stated.append(tr("Target {value}.").format(value=figure(self.target.value, self.target.measure)))
        if self.is_waiting:
            return " ".join([*stated, tr("One moment")])
        if self.is_standing:
            stated.append(f"{next_step_words()}.")
        elif self.value is not None:
            stated.append(tr("Now {value}.").format(value=figure(self.value, self.target.measure)))
        if self.last:
            stated.append(f"{steps_words(len(self.last))}: {reached_words(self)}.")
        return " ".join(stated)


def title_of(target: Target) -> str:
    """What to do, in words for the patient."""
    if target.measure is TargetMeasure.CADENCE:
        return tr("Both legs: take quicker steps")
    left, right = {
        TargetMeasure.KNEE_SWING_PEAK: (
            tr("Left knee: bend it as the leg swings"),
            tr("Right knee: bend it as the leg swings"),
        ),
        TargetMeasure.FOOT_STRIKE: (tr("Left foot: toes up as it lands"), tr("Right foot: toes up as it lands")),
        TargetMeasure.STANCE_RATIO: (tr("Left leg: stand on it longer"), tr("Right leg: stand on it longer")),
    }[target.measure]
    return left if target.side is Side.LEFT else right


def unit_words(measure: TargetMeasure) -> str:
    """What the bare figure of a measure is, where that is not given by its sign."""
    return {
        TargetMeasure.STANCE_RATIO: tr("of the other leg's standing time"),
        TargetMeasure.CADENCE: tr("steps per minute"),
    }.get(measure, "")


def figure(value: int, measure: TargetMeasure) -> str:
    """A value as it is shown large: "54°", "96 %", "110"."""
    number = str(value).replace("-", MINUS)
    if measure in (TargetMeasure.KNEE_SWING_PEAK, TargetMeasure.FOOT_STRIKE):
        return f"{number}°"
    return f"{number}\N{NO-BREAK SPACE}%" if measure is TargetMeasure.STANCE_RATIO else number


def next_step_words() -> str:
    """In the place of a value while the patient is standing."""
    return tr("Waiting for the next step")


def so_far_words(count: int) -> str:
    """Behind the number of steps of a walk without a target."""
    return tr_n("step so far", "steps so far", count)


def steps_words(count: int) -> str:
    if not count:
        return tr("No steps yet")
    return tr_n("Last {count} step", "Last {count} steps", count).format(count=count)


def reached_words(view: PatientView) -> str:
    """How many of the last strides reached the target."""
    assert view.target is not None
    reached = sum(view.target.is_reached(value) for value in view.last)
    target = figure(view.target.value, view.target.measure)
    return tr("{count} reached {target}").format(count=reached, target=target)


def tone_words(target: Target) -> str:
    return tr("tone at {target}").format(target=figure(target.value, target.measure))
