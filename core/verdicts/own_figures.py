"""A clinic's own error figures in place of the published ones, and the file that holds them (`repeatability.json`).

How they are found: `core.verdicts.repeatability`.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, NamedTuple

from core.parameters import QuantityKind
from core.verdicts.sigmas import (
    HEALTHY_BETWEEN_LEGS,
    SIGMAS,
    ComparisonKind,
    ErrorFigures,
    OwnStudy,
    Sigma,
    Source,
)

FORMAT = "gaitwright-repeatability/1"
MIN_PEOPLE = 5  # with fewer, the upper limit is over 2.5 times the figure
MIN_PEOPLE_SETTLED = 10  # with fewer, a study is preliminary
MOST_FACTOR, MOST_LIMIT, MOST_PEOPLE = 20.0, 1000.0, 100_000  # of a file that holds figures
PUBLISHED_SIGMAS = SIGMAS[ComparisonKind.STRAPPINGS]
_AGAIN = (ComparisonKind.LEGS, ComparisonKind.STRAPPINGS, ComparisonKind.VISITS)


class Between(StrEnum):
    """What lies between one person's attachments."""

    STRAPPINGS = "strappings"
    DAYS = "days"


class OwnEstimate(NamedTuple):
    """A figure, where it lies in 95 of 100 such studies, and of how many people it is."""

    value: float
    low: float
    high: float
    people: int

    def times(self, unit: float) -> "OwnEstimate":
        return OwnEstimate(unit * self.value, unit * self.low, unit * self.high, self.people)

    @property
    def judged_by(self) -> float:
        """Give what differences are judged by: at least half of the upper limit, as few people may show none."""
        return max(self.value, 0.5 * self.high)

    def holds(self, value: float) -> bool:
        return self.low <= value <= self.high


@dataclass(frozen=True, slots=True)
class OwnSigma:
    """Of one kind of quantity: by what factor of the published sigma one mean differs, and of means of which size."""

    factor: OwnEstimate
    mean: float
    published: float

    @property
    def sigma(self) -> OwnEstimate:
        """At the size that the study's means have, in the quantity's unit."""
        return self.factor.times(self.published)


@dataclass(frozen=True, slots=True)
class OwnFigures:
    """What a study found, and how it came about. `days`: the first and the last, ISO 8601."""

    people: int
    between: Between
    sigmas: Mapping[QuantityKind, OwnSigma]
    healthy: Mapping[str, OwnEstimate]
    days: tuple[str, str] = ("", "")
    made_by: str = ""
    software: str = ""
    is_simulated: bool = False

    @property
    def is_preliminary(self) -> bool:
        return self.people < MIN_PEOPLE_SETTLED

    @property
    def figures(self) -> ErrorFigures:
        """Give the figures that differences are judged by, published ones where the study has none.
        Never below: slow walks and one-day visits as published, re-attaching as leaving sensors on.
        """
        study = OwnStudy(self.people, self.days[1])
        return ErrorFigures(
            {
                kind: {**published, **self._sigmas(kind, published)} if kind in _AGAIN else published
                for kind, published in SIGMAS.items()
            },
            {**HEALTHY_BETWEEN_LEGS, **{column: found.judged_by for column, found in self.healthy.items()}},
            study,
        )

    def _sigmas(self, comparison: ComparisonKind, published: Mapping[QuantityKind, Sigma]) -> dict[QuantityKind, Sigma]:
        is_of_one_day = comparison is ComparisonKind.VISITS and self.between is not Between.DAYS
        least = SIGMAS[ComparisonKind.VISITS if is_of_one_day else ComparisonKind.ATTACHED]
        return {
            kind: _scaled(published[kind], found.factor, least[kind])
            for kind, found in self.sigmas.items()
            if kind in published
        }


def _scaled(published: Sigma, factor: OwnEstimate, least: Sigma) -> Sigma:
    times = factor.judged_by
    slower = max(times, 1.0)
    return replace(
        published,
        source=Source("own study", "healthy", factor.people),
        constant=times * published.constant,
        share_percent=times * published.share_percent,
        slow=(slower * published.slow[0], slower * published.slow[1]) if published.slow is not None else None,
        least=least,
    )


def figures_in_json(own: OwnFigures) -> dict[str, Any]:
    """As `repeatability.json` and a library hold it; units as of the columns, published figures beside."""

    def limits(found: OwnEstimate) -> dict[str, float]:
        return {"low": found.low, "high": found.high}

    return {
        "format": FORMAT,
        "simulated": own.is_simulated,
        "people": own.people,
        "between": str(own.between),
        "first_day": own.days[0],
        "last_day": own.days[1],
        "made_by": own.made_by,
        "software": own.software,
        "sigmas": {
            str(kind): {
                "sigma": found.sigma.value,
                **limits(found.sigma),
                "people": found.factor.people,
                "published": found.published,
                "mean": found.mean,
            }
            for kind, found in own.sigmas.items()
        },
        "between_legs": {
            column: {
                "limit": found.value,
                **limits(found),
                "people": found.people,
                "published": HEALTHY_BETWEEN_LEGS[column],
            }
            for column, found in own.healthy.items()
        },
    }


def figures_from_json(content: object) -> OwnFigures:
    """Read `figures_in_json` output, leaving unknown quantities out; ValueError for a bad file or figure."""
    try:
        return _figures_from(content)
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError("these are no figures of repeatability") from error


def figures_from_text(text: str) -> OwnFigures:
    """The same of a file's text; raises as `figures_from_json`."""
    try:
        return figures_from_json(json.loads(text))
    except RecursionError as error:
        raise ValueError("these are no figures of repeatability") from error


def _figures_from(content: Any) -> OwnFigures:
    if content["format"] != FORMAT:
        raise ValueError(f"this is not {FORMAT}")
    sigmas, legs = content["sigmas"], content["between_legs"]
    found = {}
    for kind in PUBLISHED_SIGMAS:
        if (one := sigmas.get(str(kind))) is not None:
            published = _number(one["published"], MOST_LIMIT)
            if published <= 0:
                raise ValueError("a published figure is none")
            of = _estimate(one, "sigma").times(1 / published)
            _number(of.value, MOST_FACTOR)
            found[kind] = OwnSigma(of, _number(one["mean"], MOST_LIMIT), published)
    return OwnFigures(
        people=_count(content["people"]),
        between=Between(content["between"]),
        sigmas=found,
        healthy={column: _estimate(legs[column], "limit") for column in HEALTHY_BETWEEN_LEGS if column in legs},
        days=(str(content["first_day"]), str(content["last_day"])),
        made_by=str(content["made_by"]),
        software=str(content["software"]),
        is_simulated=content["simulated"] is True,
    )


def _estimate(one: Mapping[str, Any], name: str) -> OwnEstimate:
    value, low, high = (_number(one[key], MOST_LIMIT) for key in (name, "low", "high"))
    if not low <= value <= high:
        raise ValueError("a figure is not within its limits")
    return OwnEstimate(value, low, high, _count(one["people"]))


def _number(value: Any, most: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= most:
        raise ValueError("a figure is no number, or too large")
    return float(value)


def _count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not MIN_PEOPLE <= value <= MOST_PEOPLE:
        raise ValueError("too few people, or no number of them")
    return value
