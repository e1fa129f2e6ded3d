"""What was changed at a prosthesis, signs as words too: "½ out, +2° plantar", "program Walk 2, was Walk 1"."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from app.wording.numbers import MINUS
from app.wording.recordings import name_in_words
from app.wording.translation import capitalised, figure_text, later, tr, within_sentence
from core.alignment import (
    FIGURES,
    MOST_PARTS,
    MOST_TEXT,
    AlignmentChange,
    NetChange,
    PartChange,
    ProsthesisPart,
    Switched,
    net_of,
)

EIGHTHS = ("", "⅛", "¼", "⅜", "½", "⅝", "¾", "⅞")
NAMES = {
    ProsthesisPart.FOOT_FRONT_SCREW: later("Foot, anterior screw"),
    ProsthesisPart.FOOT_BACK_SCREW: later("Foot, posterior screw"),
    ProsthesisPart.FOOT_INNER_SCREW: later("Foot, medial screw"),
    ProsthesisPart.FOOT_OUTER_SCREW: later("Foot, lateral screw"),
    ProsthesisPart.FOOT_ROTATION: later("Foot, rotation"),
    ProsthesisPart.FOOT: later("Foot"),
    ProsthesisPart.SOCKET_FRONT_SCREW: later("Socket, anterior screw"),
    ProsthesisPart.SOCKET_BACK_SCREW: later("Socket, posterior screw"),
    ProsthesisPart.SOCKET_INNER_SCREW: later("Socket, medial screw"),
    ProsthesisPart.SOCKET_OUTER_SCREW: later("Socket, lateral screw"),
    ProsthesisPart.KNEE_UNIT: later("Knee unit"),
    ProsthesisPart.PYLON: later("Pylon"),
    ProsthesisPart.SHOE: later("Heel or shoe"),
    ProsthesisPart.OTHER: later("Other part"),
}
# Jonkergouw et al. 2019, Gait Posture 68:122-129, doi:10.1016/j.gaitpost.2018.11.004; its abstract and highlights were
# read, not the figures
NO_PROOF = later(
    "Joint angles and times may not reflect an alignment change. In ten people with a transtibial "
    "prosthesis, induced changes affected neither (Jonkergouw 2019, Gait Posture 68:122; from "
    "abstract and highlights)."
)
NO_PROOF_BRIEF = later("Angles and times may not reflect an alignment change (Jonkergouw 2019).")
OF_FOOT, OF_SOCKET = later("Foot"), later("Socket")  # what a screw's shift and height are of
PLANTAR = later("plantar"), later("dorsal")
EVERTED = later("eversion"), later("inversion")
FLEXED = later("flexion"), later("extension")
ABDUCTED = later("abduction"), later("adduction")
DIRECTIONS: Mapping[ProsthesisPart, tuple[str, str]] = {
    ProsthesisPart.FOOT_FRONT_SCREW: PLANTAR,
    ProsthesisPart.FOOT_BACK_SCREW: PLANTAR,
    ProsthesisPart.FOOT_INNER_SCREW: EVERTED,
    ProsthesisPart.FOOT_OUTER_SCREW: EVERTED,
    ProsthesisPart.FOOT_ROTATION: (later("toe-out"), later("toe-in")),
    ProsthesisPart.SOCKET_FRONT_SCREW: FLEXED,
    ProsthesisPart.SOCKET_BACK_SCREW: FLEXED,
    ProsthesisPart.SOCKET_INNER_SCREW: ABDUCTED,
    ProsthesisPart.SOCKET_OUTER_SCREW: ABDUCTED,
}


def part_name(part: ProsthesisPart) -> str:
    """Name a part: "Foot, front screw"."""
    return tr(NAMES[part])


def angle_words(part: ProsthesisPart, angle_deg: float) -> str:
    """Say an angle with its direction, "+2° plantar"; of a part whose maker counts, with its sign."""
    amount = figure_text(abs(angle_deg), "g") + "°"
    if part not in DIRECTIONS:
        return ("+" if angle_deg >= 0 else MINUS) + amount
    return f"+{amount} {tr(DIRECTIONS[part][angle_deg < 0])}"


def direction_words(part: ProsthesisPart) -> tuple[str, str]:
    """Say which way an angle and a shift of a part are positive, as captions: "Angle, plantar +", "Shift, back +"."""
    angle = tr("Angle")
    if part in DIRECTIONS:
        angle = tr("Angle, {direction} +").format(direction=tr(DIRECTIONS[part][0]))
    return angle, tr("Shift, lateral +") if part.is_frontal else tr("Shift, posterior +")


def turns_words(turns: float) -> str:
    """Say how far a screw was turned: "½ out", "1¼ in"."""
    return (tr("{amount} in") if turns < 0 else tr("{amount} out")).format(amount=_eighths(turns))


def shift_words(part: ProsthesisPart, shift_mm: float) -> str:
    """Say a shift: "4 mm back", or "2 mm inwards" at an inner or outer screw."""
    if part.is_frontal:
        stated = tr("{amount} mm medial") if shift_mm < 0 else tr("{amount} mm lateral")
    else:
        stated = tr("{amount} mm anterior") if shift_mm < 0 else tr("{amount} mm posterior")
    return stated.format(amount=figure_text(abs(shift_mm), "g"))


def height_words(height_mm: float) -> str:
    return tr("{sign}{amount} mm").format(sign=MINUS if height_mm < 0 else "+", amount=figure_text(abs(height_mm), "g"))


def change_lines(change: AlignmentChange | None) -> list[tuple[str, str]]:
    """Say a change as a list shows it: name of the part and what was done."""
    return [] if change is None else net_lines(net_of(change.parts))


def net_lines(changes: Sequence[NetChange]) -> list[tuple[str, str]]:
    """The same of changes that were added up."""
    return [line for change in changes for line in _lines(change)]


def change_in_words(change: AlignmentChange | Sequence[PartChange] | None) -> str:
    """Say a change in one line: "Foot, front screw ½ turn out, +2° plantar; foot 4 mm back"; empty for none."""
    if change is None:
        return ""
    parts = change.parts if isinstance(change, AlignmentChange) else change
    return _line(net_of(parts))


def since_in_words(change: AlignmentChange | None) -> str:
    """Say a change and since when: "Changed from Alignment A: pylon +3 mm"; of a return where it leads."""
    if change is None:
        return ""
    stated = change_in_words(change)
    if change.returns_to:
        words = tr("Back to {condition}: {changes}") if stated else tr("Back to {condition}")
        return words.format(condition=name_in_words(change.returns_to), changes=stated)
    if not change.since:
        return tr("Changed: {changes}").format(changes=stated)
    return tr("Changed from {condition}: {changes}").format(condition=name_in_words(change.since), changes=stated)


def to_do_in_words(changes: Sequence[NetChange]) -> str:
    """State what to do: "Foot, front screw ½ turn in; knee unit: set program Walk 1 again"; turned screws, no angle."""
    return _line(changes, is_to_do=True)


def as_entered(changes: Sequence[NetChange]) -> tuple[PartChange, ...]:
    """The same as somebody would enter it, within the limits of one entry; beyond those of one change it is cut."""
    parts = []
    for change in changes:
        left: dict[str, Any] = {name: getattr(change, name) for name in FIGURES}
        while any(left.values()):
            once: dict[str, Any] = {
                name: min(max(left[name], -limits.most), limits.most) for name, limits in FIGURES.items()
            }
            parts.append(PartChange(change.part, **once))
            left = {name: left[name] - once[name] for name in FIGURES}
        parts += [PartChange(change.part, text=text[:MOST_TEXT]) for text in _texts(change)]
        parts += [_switch_entered(change.part, one) for one in change.switched]
    return tuple(parts[:MOST_PARTS])


def setting_text(value: float) -> str:
    """A setting's number as it is read: "45", "−2.5"."""
    return figure_text(value, "g").replace("-", MINUS)


def _lines(change: NetChange) -> list[tuple[str, str]]:
    own = [turns_words(change.turns)] if change.turns else []
    own += [angle_words(change.part, change.angle_deg)] if change.angle_deg else []
    name, body = part_name(change.part), _body(change.part)
    lines = [(name, ", ".join(own))] if own else []
    if change.shift_mm:
        lines.append((tr("{part}, shift").format(part=body), shift_words(change.part, change.shift_mm)))
    if change.height_mm:
        lines.append((tr("{part}, height").format(part=body), height_words(change.height_mm)))
    lines += [(name, _switched_words(one)) for one in change.switched]
    return lines + [(name, text) for text in _texts(change)]


def _line(changes: Iterable[NetChange], *, is_to_do: bool = False) -> str:
    stated: list[str] = []
    for change in changes:
        has_angle = bool(change.angle_deg) and not (is_to_do and change.turns)
        own = [_turn(change.turns)] if change.turns else []
        own += [angle_words(change.part, change.angle_deg)] if has_angle else []
        name, body = within_sentence(part_name(change.part)), within_sentence(_body(change.part))
        if own:
            stated.append(f"{name} {', '.join(own)}")
        if change.shift_mm:
            stated.append(f"{body} {shift_words(change.part, change.shift_mm)}")
        if change.height_mm:
            stated.append(f"{body} {height_words(change.height_mm)}")
        switched = map(_to_switch_words if is_to_do else _switched_words, change.switched)
        stated += [f"{name}: {text}" for text in (*switched, *_texts(change))]
    return capitalised("; ".join(stated))


def _switched_words(switched: Switched) -> str:
    """What a program or a setting was set to: "program Walk 2, was Walk 1", "Swing flexion 50, was 45"."""
    before, after = map(_state, (switched.before, switched.after))
    words = tr("{what} {after}, was {before}") if before and after else tr("{what} {after}")
    if not after:
        words = tr("{what} no longer {before}")
    return words.format(what=switched.name or tr("program"), before=before, after=after)


def _to_switch_words(switched: Switched) -> str:
    """What is to be set: "set program Walk 1 again", "set Swing flexion to 45 again"."""
    before, after = map(_state, (switched.before, switched.after))
    if not after:
        words = tr("set {what} back from {before}; what it was is not recorded")
    else:
        words = tr("set {what} to {after} again") if switched.name else tr("set {what} {after} again")
    return words.format(what=switched.name or tr("program"), before=before, after=after)


def _state(state: str | float | None) -> str:
    return setting_text(state) if isinstance(state, float) else state or ""


def _switch_entered(part: ProsthesisPart, one: Switched) -> PartChange:
    before, after = one.before, one.after
    if one.name:
        return PartChange(
            part,
            setting=one.name,
            setting_before=before if isinstance(before, float) else None,
            setting_value=after if isinstance(after, float) else None,
        )
    return PartChange(part, program_before=_state(before), program=_state(after))


def _texts(change: NetChange) -> list[str]:
    return [*change.done, *(tr("undo: {text}").format(text=text) for text in change.undone)]


def _turn(turns: float) -> str:
    return (tr("{amount} turn in") if turns < 0 else tr("{amount} turn out")).format(amount=_eighths(turns))


def _eighths(turns: float) -> str:
    whole, eighths = divmod(round(abs(turns) * 8), 8)
    return f"{whole or ''}{EIGHTHS[eighths]}" or "0"


def _body(part: ProsthesisPart) -> str:
    if part.startswith("foot"):
        return tr(OF_FOOT)
    return tr(OF_SOCKET) if part.startswith("socket_") else part_name(part)
