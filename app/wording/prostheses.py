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
    None: later("prosthesis"),
    AmputationLevel.PARTIAL_FOOT: later("partial foot prosthesis"),
    AmputationLevel.ANKLE_DISARTICULATION: later("ankle disarticulation (Syme) prosthesis"),
    AmputationLevel.TRANSTIBIAL: later("transtibial prosthesis"),
    AmputationLevel.KNEE_DISARTICULATION: later("knee disarticulation prosthesis"),
    AmputationLevel.TRANSFEMORAL: later("transfemoral prosthesis"),
    AmputationLevel.HIP_DISARTICULATION: later("hip disarticulation prosthesis"),
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
    named = tr("{prosthesis} {side}").format(prosthesis=tr(_PROSTHESES[prosthesis.level]), side=side_name(side))
    return ", ".join([named, *_parts(prosthesis)])


def whole_words(prosthesis: Prosthesis) -> str:
    """The same without its side."""
    return ", ".join([tr(_PROSTHESES[prosthesis.level]), *_parts(prosthesis)])


def _parts(prosthesis: Prosthesis) -> list[str]:
    knee = [tr(_KNEES[prosthesis.knee])] if prosthesis.knee is not None else []
    return knee + ([tr(_FEET[prosthesis.foot])] if prosthesis.foot is not None else [])


def worn_words(patient: "Patient", *, is_whole: bool = True) -> tuple[str, ...]:
    """Say what every prosthetic side wears; without `is_whole` its level alone. Empty where nothing is stated."""
    worn = patient.worn
    if not worn:
        return ()
    stated = {side: worn.get(side, NOT_STATED) for side in Side if side in patient.prosthetic_sides}
    shown = stated if is_whole else {side: Prosthesis(one.level) for side, one in stated.items()}
    return tuple(prosthesis_words(side, one) for side, one in shown.items())
