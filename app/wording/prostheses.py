"""Prostheses in words: level of amputation, knee and foot, as choices and within a sentence."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from app.wording.body import side_name
from app.wording.translation import later, tr
from core.body import Side
from core.prosthesis import NOT_STATED, AmputationLevel, FootKind, KneeKind, Prosthesis

if TYPE_CHECKING:
    from core.session import Patient

LEVELS: Mapping[AmputationLevel, str] = {
    AmputationLevel.PARTIAL_FOOT: later("Partial foot"),
    AmputationLevel.ANKLE_DISARTICULATION: later("Ankle disarticulation (Syme)"),
    AmputationLevel.TRANSTIBIAL: later("Transtibial"),
    AmputationLevel.KNEE_DISARTICULATION: later("Knee disarticulation"),
    AmputationLevel.TRANSFEMORAL: later("Transfemoral"),
    AmputationLevel.HIP_DISARTICULATION: later("Hip disarticulation"),
}
KNEES: Mapping[KneeKind, str] = {
    KneeKind.LOCKED: later("Manual lock"),
    KneeKind.SINGLE_AXIS: later("Single-axis"),
    KneeKind.POLYCENTRIC: later("Polycentric"),
    KneeKind.FLUID_CONTROLLED: later("Fluid-controlled"),
    KneeKind.MICROPROCESSOR: later("Microprocessor"),
}
FEET: Mapping[FootKind, str] = {
    FootKind.SACH: later("SACH"),
    FootKind.SINGLE_AXIS: later("Single-axis"),
    FootKind.MULTI_AXIAL: later("Multi-axial"),
    FootKind.ENERGY_STORING: later("Energy-storing"),
    FootKind.HYDRAULIC_ANKLE: later("Hydraulic ankle"),
    FootKind.MICROPROCESSOR_ANKLE: later("Microprocessor ankle"),
}
# as they are written within a sentence
_PROSTHESES: Mapping[AmputationLevel | None, str] = {
    None: later("prosthesis {side}"),
    AmputationLevel.PARTIAL_FOOT: later("partial foot prosthesis {side}"),
    AmputationLevel.ANKLE_DISARTICULATION: later("ankle disarticulation (Syme) prosthesis {side}"),
    AmputationLevel.TRANSTIBIAL: later("transtibial prosthesis {side}"),
    AmputationLevel.KNEE_DISARTICULATION: later("knee disarticulation prosthesis {side}"),
    AmputationLevel.TRANSFEMORAL: later("transfemoral prosthesis {side}"),
    AmputationLevel.HIP_DISARTICULATION: later("hip disarticulation prosthesis {side}"),
}
_KNEES: Mapping[KneeKind, str] = {
    KneeKind.LOCKED: later("manual-lock knee"),
    KneeKind.SINGLE_AXIS: later("single-axis knee"),
    KneeKind.POLYCENTRIC: later("polycentric knee"),
    KneeKind.FLUID_CONTROLLED: later("fluid-controlled knee"),
    KneeKind.MICROPROCESSOR: later("microprocessor knee"),
}
_FEET: Mapping[FootKind, str] = {
    FootKind.SACH: later("SACH foot"),
    FootKind.SINGLE_AXIS: later("single-axis foot"),
    FootKind.MULTI_AXIAL: later("multi-axial foot"),
    FootKind.ENERGY_STORING: later("energy-storing foot"),
    FootKind.HYDRAULIC_ANKLE: later("foot with hydraulic ankle"),
    FootKind.MICROPROCESSOR_ANKLE: later("foot with microprocessor ankle"),
}


def prosthesis_words(side: Side, prosthesis: Prosthesis) -> str:
    """Say what is stated of one prosthesis: "transtibial prosthesis left, energy-storing foot"."""
    words = [tr(_PROSTHESES[prosthesis.level]).format(side=side_name(side)), parts_words(prosthesis)]
    return ", ".join(filter(None, words))


def parts_words(prosthesis: Prosthesis) -> str:
    """Say knee and foot, as far as they are stated: "polycentric knee, SACH foot"."""
    knee = tr(_KNEES[prosthesis.knee]) if prosthesis.knee is not None else ""
    foot = tr(_FEET[prosthesis.foot]) if prosthesis.foot is not None else ""
    return ", ".join(filter(None, [knee, foot]))


def worn_words(patient: "Patient", *, is_whole: bool = True) -> tuple[str, ...]:
    """Say what every prosthetic side wears; without `is_whole` its level alone. Empty where nothing is stated."""
    worn = patient.worn
    if not worn:
        return ()
    stated = {side: worn.get(side, NOT_STATED) for side in Side if side in patient.prosthetic_sides}
    shown = stated if is_whole else {side: Prosthesis(one.level) for side, one in stated.items()}
    return tuple(prosthesis_words(side, one) for side, one in shown.items())
