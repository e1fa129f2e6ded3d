"""The demonstration's above-knee prosthesis: how it is built, and how it is set after the changes entered."""

from collections.abc import Mapping
from dataclasses import replace

from core.alignment import NetChange, ProsthesisPart
from devices.simulation.walker_prosthesis import ProsthesisSetting

SPEED_M_S = 1.05  # at which its user walks
# a knee that is held nearly straight in stance, and swings less than a sound one
BUILT = ProsthesisSetting(stance_flexion=0.2, swing_flexion_deg=-6.0)
DEG_PER_TURN = 6.0  # of the peak in swing, by a turn of this knee's valve out
_FOOT = (ProsthesisPart.FOOT_FRONT_SCREW, ProsthesisPart.FOOT_BACK_SCREW)
_PILLAR = (*_FOOT, ProsthesisPart.PYLON)


def setting_of(changes: Mapping[ProsthesisPart, NetChange]) -> ProsthesisSetting:
    """How the demonstration's prosthesis is set after these changes of its first alignment."""
    foot = [changes[part] for part in _FOOT if part in changes]
    knee = changes.get(ProsthesisPart.KNEE_UNIT, NetChange(ProsthesisPart.KNEE_UNIT))
    return replace(
        BUILT,
        plantar_deg=sum(change.angle_deg for change in foot),
        back_mm=sum(change.shift_mm for change in foot),
        height_mm=sum(changes[part].height_mm for part in _PILLAR if part in changes),
        stop_deg=max(knee.angle_deg, 0.0),
        swing_flexion_deg=BUILT.swing_flexion_deg + DEG_PER_TURN * knee.turns,
    )
