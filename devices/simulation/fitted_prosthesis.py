"""The demonstration's prosthesis, above the knee if not stated otherwise: how it is set after the changes entered."""

from collections.abc import Mapping
from dataclasses import replace

from core.alignment import NetChange, ProsthesisPart
from core.prosthesis import NOT_STATED, Prosthesis
from devices.simulation.walker_prosthesis import HELD_STRAIGHT, ProsthesisSetting, built

SPEED_M_S = 1.05  # at which its user walks
BUILT = HELD_STRAIGHT
DEG_PER_TURN = 6.0  # of the peak in swing, by a turn of this knee's valve out
_FOOT = (ProsthesisPart.FOOT_FRONT_SCREW, ProsthesisPart.FOOT_BACK_SCREW)
_PILLAR = (*_FOOT, ProsthesisPart.PYLON)


def setting_of(changes: Mapping[ProsthesisPart, NetChange], fitted: Prosthesis = NOT_STATED) -> ProsthesisSetting:
    """How the demonstration's prosthesis is set after these changes of its first alignment."""
    first = BUILT if fitted.knee is None else built(fitted)
    foot = [changes[part] for part in _FOOT if part in changes]
    knee = changes.get(ProsthesisPart.KNEE_UNIT, NetChange(ProsthesisPart.KNEE_UNIT))
    return replace(
        first,
        plantar_deg=sum(change.angle_deg for change in foot),
        back_mm=sum(change.shift_mm for change in foot),
        height_mm=sum(changes[part].height_mm for part in _PILLAR if part in changes),
        stop_deg=max(knee.angle_deg, 0.0),
        swing_flexion_deg=first.swing_flexion_deg + DEG_PER_TURN * knee.turns,
    )
