"""What befell the clocks of an imported recording, a sentence each."""

from collections.abc import Sequence

from app.wording.translation import figure_text, joined, tr, tr_n
from core.signal.clock_events import ClockEvent, ClockEventKind


def clock_sentence(event: ClockEvent, names: Sequence[str]) -> str:
    """State an event; `names`: of all sensors of its recording. Losses and sparse samples are of one sensor each."""
    who = joined([names[number] for number in event.sensors])
    values = {"sensor": who, "at": _seconds(event.at_s), "length": _seconds(event.length_s), "count": event.count}
    match event.kind:
        case ClockEventKind.RESTART:
            stated = tr("{sensor}: clock restarts after {at} s, {length} s back.")
        case ClockEventKind.JUMP:
            stated = tr("{sensor}: clock jumps forward by {length} s after {at} s.")
        case ClockEventKind.PAUSE:
            return tr("No sensor recorded for {length} s, from {at} s on.").format(**values)
        case ClockEventKind.LOSS:
            values["longest"] = _seconds(event.longest_s)
            stated = tr_n(
                "{sensor}: samples missing for {length} s, after {at} s.",
                "{sensor}: samples missing {count} times, {length} s in total, longest {longest} s after {at} s.",
                event.count,
            )
        case ClockEventKind.SPARSE:
            values["came"], values["set"] = (figure_text(rate_hz, ".1f") for rate_hz in event.rates_hz)
            stated = tr("{sensor}: {came} samples per second, {set} expected.")
    return stated.format(**values)


def _seconds(seconds: float) -> str:
    return figure_text(seconds, ".2f" if seconds < 1.0 else ".1f")
