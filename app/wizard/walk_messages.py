"""What is to be said of a walk, while it goes on and once it has stopped, apart from sensors that fall silent."""

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

from app.wizard.losses import NOTHING, Message
from app.wording.numbers import clock
from app.wording.translation import capitalised, name_of, tr
from core.body import Joint, Segment, Side, Site
from core.calibration.strap import Slip
from core.live.bias import BiasCorrection

if TYPE_CHECKING:
    from app.acquisition.memory_fetching import Lack

STRIDES_FOR_SPREAD = 10


def slip_message(slips: Sequence[Slip], began_s: float) -> Message:
    """Tell of the latest strap that slipped since the walk began."""
    since = [slip for slip in slips if slip.from_s > began_s]
    if not since:
        return NOTHING
    slip = since[-1]
    what = tr("The {site} strap slipped at {time}.").format(site=name_of(slip.site), time=clock(slip.from_s - began_s))
    left = tr("Strides after it are left out; tighten it and repeat free motion for the left leg.")
    right = tr("Strides after it are left out; tighten it and repeat free motion for the right leg.")
    return what, left if slip.site.side is Side.LEFT else right


def implausible_message(joints: Sequence[Joint]) -> Message:
    """Tell of angles that no joint has, and are not shown."""
    names = ", ".join(name_of(joint) for joint in joints)
    what = tr("{joints}: angle beyond \N{MINUS SIGN}40\N{DEGREE SIGN} to 160\N{DEGREE SIGN}, not shown.")
    return what.format(joints=capitalised(names)), tr("Check the sensor positions, then record the free motion again.")


def bias_message(corrections: Sequence[BiasCorrection]) -> Message:
    """Tell of the latest gyroscope whose bias from standing was wrong."""
    if not corrections:
        return NOTHING
    what = tr("The {site} sensor's gyroscope bias was wrong and is now corrected.")
    return what.format(site=name_of(corrections[-1].site)), tr(
        "The patient moved while standing: record standing again."
    )


def no_angles_message(worn: Collection[Site]) -> Message:
    """Say when the angles come that were not known when the walk began."""
    then = tr("They come after five strides of each leg.")
    if not any(site.segment is Segment.FOOT for site in worn):
        then = tr("They come once the walk is stopped.")  # nothing counts strides before
    return tr("Angles are not shown yet."), then


def no_foot_message(worn: Collection[Site]) -> Message:
    """Say why strides of a leg are not counted, nor its phases shown, while it walks."""
    blind = [
        side for side in Side if Site(f"{side}_{Segment.SHANK}") in worn and Site(f"{side}_{Segment.FOOT}") not in worn
    ]
    if not blind:
        return NOTHING
    what = tr("No foot sensors: strides are counted after the walk.")
    if blind == [Side.LEFT]:
        what = tr("No left foot sensor: left strides are counted after the walk.")
    elif blind == [Side.RIGHT]:
        what = tr("No right foot sensor: right strides are counted after the walk.")
    return what, tr("Steps come from the shank. It will be printed.")


def recovered_message(walk: str, seconds: float) -> Message:
    """Say how much of a walk the journal holds, and what the end of the program may have cost besides."""
    recovered = tr("{time} of {walk} was recovered, up to the last record on the disk.")
    said, look = recovered.format(time=clock(seconds), walk=walk), tr("Look at it, then keep or discard.")
    return tr("The program was closed while recording."), f"{said} {look} {recovery_costs()}"


def recovery_costs() -> str:
    """What the end of a program costs at most; the figures are those of T1 in the evidence."""
    return tr(
        "Ending the program costs 0.1 s at most in 99 of 100 cases, a power cut up to 0.5 s and what the disk still "
        "held back."
    )


def lacks_message(walk: str, lacks: "Sequence[Lack]") -> Message:
    """Say what could not be fetched of a walk from the sensors' memories; the gravest first."""
    early = max(lacks, key=lambda one: one.early_s, default=None)
    if early is not None and early.early_s > 0:
        what = tr("{sensor} ended {seconds} s before {walk} was stopped.").format(
            sensor=early.sensor, seconds=round(early.early_s), walk=walk
        )
        return what, tr("Its button was pressed, or its memory is full. Angles with it end there.")
    lost = [one for one in lacks if one.lost]
    if lost:
        said = ", ".join(f"{one.sensor} {one.lost}" for one in lost)
        what = tr("Samples of {walk} could not be fetched: {sensors}.").format(walk=walk, sensors=said)
        return what, tr("They are left out. The sensors keep the recording until their memories are erased.")
    if lacks:
        what = tr("{sensor} did not say where {walk} ends.").format(sensor=lacks[0].sensor, walk=walk)
        return what, tr("What it has sent is kept; its end may be missing.")
    return NOTHING


def loose_message(on_own_clocks: Sequence[str]) -> Message:
    """Say that sensors that stream are to be synchronised again; `on_own_clocks`: those without the common one."""
    what = tr("The sensors were synchronised half an hour ago: their clocks drift apart.")
    if on_own_clocks:
        what = tr("Not on the common clock: {sensors}.").format(sensors=", ".join(on_own_clocks))
    return what, tr("Synchronise again before the next walk, or go on: what both legs share is measured less well.")


def few_strides_message(counts: Mapping[Side, int]) -> Message:
    """Say what one condition's walks are short of a spread together; a side without a count is not asked for."""
    left, right = (counts.get(side, STRIDES_FOR_SPREAD) for side in Side)
    if min(left, right) >= STRIDES_FOR_SPREAD:
        return NOTHING
    said = tr("Only {left} left and {right} right strides, {wanted} make a spread.")
    if left >= STRIDES_FOR_SPREAD:
        said = tr("Only {right} right strides, {wanted} make a spread.")
    elif right >= STRIDES_FOR_SPREAD:
        said = tr("Only {left} left strides, {wanted} make a spread.")
    what = said.format(left=left, right=right, wanted=STRIDES_FOR_SPREAD)
    return what, tr("Walk once more, or go on without a spread.")
