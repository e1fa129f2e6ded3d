"""A study whose figures are known."""

from core.parameters import STANCE, QuantityKind
from core.verdicts.own_figures import Between, OwnEstimate, OwnFigures, OwnSigma


def own_study(factor: float = 1.5, *, is_simulated: bool = False, people: int = 20) -> OwnFigures:
    """Stance repeats `factor` times as badly as published, and healthy legs differ by 3.2 points."""
    limits = OwnEstimate(factor, 0.8 * factor, 1.4 * factor, people)
    return OwnFigures(
        people,
        Between.DAYS,
        {QuantityKind.STANCE: OwnSigma(limits, 61.0, 1.1)},
        {STANCE: OwnEstimate(3.2, 2.5, 4.3, people)},
        ("2026-11-10", "2026-11-12"),
        "hk",
        "1.0",
        is_simulated,
    )
