"""Sentences about the live output: what is on, and why something is not."""

from app.live_output.output import LiveOutput
from app.live_output.status import OutputRefusedError
from app.wording.translation import tr, tr_n


def refusal_words(problem: OutputRefusedError, port: int) -> str:
    """Say why an outlet is off, and what to do."""
    if problem.extra:
        return install_words(problem.extra)
    if problem.other:
        return tr(
            "Lab Streaming Layer already searches the network of {other}. To use it here, close Gaitwright and start "
            "it again."
        ).format(other=problem.other)
    return tr("Another program uses port {port}. Enter another port.").format(port=port)


def install_words(extra: str) -> str:
    """Say what is missing on this computer."""
    return tr("Not installed on this computer. Install gaitwright[{extra}].").format(extra=extra)


def output_words(output: LiveOutput, *, is_in_memory: bool = False) -> str:
    """Say for whoever is recording what is sent, or why nothing is; empty where nothing was switched on.

    `is_in_memory`: the sensors store the walk and send nothing of it.
    """
    if is_in_memory and output.is_on:
        return tr("Live output: nothing is sent while the sensors store the walk.")
    on = ["LSL"] if output.has_lsl else []
    if output.port:
        on.append(tr("WebSocket ({count} connected)").format(count=output.status.clients))
    stated = [tr("Live output is on: {outlets}.").format(outlets=", ".join(on))] if on else []
    if count := output.status.dropped:
        stated.append(tr_n("{count} sample was dropped.", "{count} samples were dropped.", count).format(count=count))
    if output.status.latest_closed:
        stated.append(tr("A program was too slow and was disconnected."))
    for name in output.trouble:
        off = tr("Live output is off: {reason}")
        stated.append(off.format(reason=refusal_words(output.trouble[name], output.settings.port)))
    return " ".join(stated)
