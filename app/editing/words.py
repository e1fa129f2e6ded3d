"""What two stations stated of the same thing, in words: the fields, their values, and who stated them when."""

import datetime
import json
from collections.abc import Sequence

import numpy as np

from app.editing.confirmation import confirmed_by
from app.storage.edited_fields import ALIGNMENT, CONFIRMED, GOALS, KEPT, PLACEMENT, PROSTHESIS, TEST
from app.storage.three_way import OtherChange, Value
from app.wording.alignment import since_in_words
from app.wording.body import name_of, side_name
from app.wording.measures import goal_in_words, measure_name, whose_name
from app.wording.numbers import MINUS
from app.wording.patients import when
from app.wording.prostheses import whole_words
from app.wording.timed_tests import planned_words
from app.wording.translation import capitalised, figure_text, short_figure, tr, tr_n
from core.alignment import alignment_of_text
from core.body import Joint, Side, Site
from core.goals import GoalOf, goals_of_text, held
from core.prosthesis import prostheses_of_text
from core.timed.protocols import planned_of_text


def field_word(field: str) -> str:
    """Name a field as the pages do: "Body height", "Zero, left knee"."""
    name, _, part = field.partition(".")
    if name == GOALS:
        column, _, of = part.partition(".")
        whose = ", ".join(filter(None, [measure_name(column), whose_name(GoalOf(of))]))
        return tr("Goal, {whose}").format(whose=whose)
    if part in list(Joint):
        of_joint = {"zero_rad": tr("Goniometer, {joint}"), "turned_sign": tr("Angle sign, {joint}")}
        return of_joint[name].format(joint=name_of(Joint(part)))
    if part in list(Side):
        of_side = {
            "without_ankle": tr("Ankle joint, {side}"),
            "left_out_s": tr("Strides excluded, {side}"),
            PROSTHESIS: tr("Prosthesis, {side}"),
        }
        return of_side[name].format(side=side_name(Side(part)))
    return {
        "code": tr("Patient code"),
        "birth_year": tr("Birth year"),
        "sex": tr("Sex"),
        "height_m": tr("Height"),
        "mass_kg": tr("Weight"),
        "device": tr("Device"),
        "aids": tr("Aids and footwear"),
        "sides": tr("Side"),
        "started": tr("Started"),
        "operator": tr("User"),
        "surface": tr("Surface"),
        "notes": tr("Notes"),
        "software": tr("Software"),
        "comment": tr("Clinical comment"),
        CONFIRMED: tr("Clinical comment confirmed"),
        "cannot_stand": tr("Standing"),
        "name": tr("Name"),
        "kind": tr("Type"),
        "condition": tr("Condition"),
        KEPT: tr("Analysis"),
        "note": tr("Note"),
        "is_restrapped_before": tr("Sensors"),
        ALIGNMENT: tr("Alignment change"),
        TEST: tr("Timed test"),
        PLACEMENT: tr("Sensor positions"),
    }[name]


def value_words(field: str, value: Value) -> str:
    """Say a field's value as the pages do: "180 cm", "-1.5°", "turned by hand"."""
    name = field.partition(".")[0]
    if isinstance(value, bool):
        yes, no = {
            "without_ankle": (tr("none"), tr("present")),
            "cannot_stand": (tr("cannot stand"), tr("can stand")),
            KEPT: (tr("included"), tr("excluded")),
            "is_restrapped_before": (tr("reattached before the recording"), tr("not reattached before the recording")),
        }[name]
        return yes if value else no
    if name == "turned_sign":
        return tr("reversed by hand") if value == -1 else tr("confirmed by hand") if value == 1 else tr("as detected")
    if isinstance(value, tuple):
        amount = tr_n("{count} stride", "{count} strides", len(value)).format(count=len(value))
        at = ", ".join(tr("{time} s").format(time=figure_text(time_s, ".1f")) for time_s in value)
        return f"{amount}: {at}" if value else tr("none")
    if value is None or value == "":
        return tr("not recorded")
    if isinstance(value, str):
        return _text(name, value)
    number = {
        "height_m": lambda: tr("{height} cm").format(height=short_figure(value * 100, 1)),
        "mass_kg": lambda: tr("{mass} kg").format(mass=short_figure(value, 1)),
        "zero_rad": lambda: f"{short_figure(np.rad2deg(value), 1)}°".replace("-", MINUS),
    }.get(name)
    return number() if number is not None else str(value)


def by_words(by: str, at: datetime.datetime | None, now: datetime.datetime) -> str:
    """Say who changed it, and when, as far as that is known: "B. Berger, today 10:32"."""
    return ", ".join(filter(None, [by or tr("another user"), when(at.isoformat(), now) if at is not None else ""]))


def others_message(subject: str, others: Sequence[OtherChange], now: datetime.datetime) -> tuple[str, str]:
    """Report what another station changed of `subject` while it was edited here: what happened, and the values."""
    what = tr("Saved. {subject} was also changed at another workstation.").format(subject=subject)
    stated = [
        tr("{field}: {value} ({who}).").format(
            field=field_word(one.field), value=value_words(one.field, one.value), who=by_words(one.by, one.at, now)
        )
        for one in others
    ]
    return what, " ".join(stated)


def _text(name: str, value: str) -> str:
    if name == "sex":
        return {"female": tr("Female"), "male": tr("Male")}.get(value, value)
    if name == "sides":
        affected, prosthetic = value.split(",")
        sides = {"left": tr("left"), "right": tr("right"), "both": tr("both sides")}
        if prosthetic in sides:
            return capitalised(tr("{side} prosthetic").format(side=sides[prosthetic]))
        if affected in sides:
            return capitalised(tr("{side} affected").format(side=sides[affected]))
        return tr("Neither") if "none" in (affected, prosthetic) else tr("not recorded")
    if name == GOALS:
        return "; ".join(map(goal_in_words, held(goals_of_text(value)))) or tr("withdrawn")
    if name == ALIGNMENT:
        return since_in_words(alignment_of_text(value))
    if name == CONFIRMED:
        return confirmed_by(value) or tr("another user")
    if name == TEST:
        return planned_words(planned_of_text(value))
    if name == PROSTHESIS:
        ((_, prosthesis),) = prostheses_of_text(value).items()
        return capitalised(whole_words(prosthesis))
    if name == PLACEMENT:
        worn = json.loads(value).items()
        return ", ".join(f"{name_of(Site(site))} {sensor}" for site, sensor in worn) or tr("not recorded")
    return value
