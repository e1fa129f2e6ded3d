"""How a prosthesis' foot was set between two conditions, beside what is measured of it.

While the sensors stay on, the foot's angle against the shank in swing, where nothing bends it, changes by what was set.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from app.summary.comparison import Compared, Comparison
from app.summary.conditions import Part
from app.summary.measures import Measure
from app.wording.measures import NAMES
from app.wording.numbers import MINUS
from app.wording.translation import figure_text, tr
from core.alignment import AlignmentChange, NetChange, ProsthesisPart, changed_between
from core.body import Side
from core.verdicts.quantities import SHANK_TO_FOOT

MEASURE = Measure(SHANK_TO_FOOT, NAMES[SHANK_TO_FOOT])
SAGITTAL = (ProsthesisPart.FOOT_FRONT_SCREW, ProsthesisPart.FOOT_BACK_SCREW)


@dataclass(frozen=True, slots=True)
class SetAngle:
    """Plantarflexion is positive; `error_deg`: half of the measured angle's likely interval; both NaN if not judged."""

    set_deg: float
    measured_deg: float
    error_deg: float
    has_other_parts: bool  # something else was changed, of which nothing is measured

    @property
    def is_measured(self) -> bool:
        return math.isfinite(self.measured_deg)

    @property
    def agrees(self) -> bool:
        """Whether what was set lies in the likely interval of what is measured."""
        return abs(self.measured_deg - self.set_deg) <= self.error_deg


def set_angle(
    found: Comparison, part: Part, base: Part, side: Side, changes: Mapping[str, AlignmentChange | None]
) -> SetAngle | None:
    """Compare what was set between two conditions with what is measured; None where no chain of changes ties them."""
    net: tuple[NetChange, ...] | None = () if part.is_again(base) else changed_between(changes, base.name, part.name)
    if net is None:
        return None
    compared: Compared = found.compare(MEASURE, side, part, base)
    is_judged = compared.is_reported and compared.difference.is_judged
    return SetAngle(
        set_deg=sum(change.angle_deg for change in net if change.part in SAGITTAL),
        measured_deg=-compared.difference.difference if is_judged else math.nan,
        error_deg=compared.difference.error if is_judged else math.nan,
        has_other_parts=any(
            change.part not in SAGITTAL or change.shift_mm or change.height_mm or change.done or change.undone
            for change in net
        ),
    )


def set_angle_in_words(found: SetAngle) -> str:
    """Say what was set and what is measured: "Set 3.0° plantarflexion, measured 2.9° (±0.4°)."."""
    stated = _in_words(found)
    if not found.has_other_parts:
        return stated
    return f"{stated} {tr('Other changes are not measured.')}" if stated else tr("The change itself is not measured.")


def _in_words(found: SetAngle) -> str:
    if not found.is_measured:
        return tr("The set foot angle cannot be measured here.") if found.set_deg else ""
    set_words = _direction(found.set_deg) if found.set_deg else ""
    measured = figure_text(abs(found.measured_deg), ".1f")
    error = figure_text(found.error_deg, ".1f")
    sign = "" if found.measured_deg * (found.set_deg or found.measured_deg) >= 0 else MINUS
    if found.set_deg:
        stated = tr("Set {set} {direction}, measured {sign}{measured}° (±{error}°).").format(
            set=figure_text(abs(found.set_deg), ".1f") + "°",
            direction=set_words,
            sign=sign,
            measured=measured,
            error=error,
        )
        return stated if found.agrees else f"{stated} {tr('Check the setting.')}"
    if found.agrees:
        return tr("Foot angle unchanged (measured {measured}°, ±{error}°).").format(measured=measured, error=error)
    return tr("Foot angle not set, measured {measured}° {direction} (±{error}°). Check the foot.").format(
        measured=measured, direction=_direction(found.measured_deg), error=error
    )


def _direction(angle_deg: float) -> str:
    return tr("plantarflexion") if angle_deg >= 0 else tr("dorsiflexion")
