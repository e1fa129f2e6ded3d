"""What is to be shown about a walk, while it goes on and once it has stopped, apart from sensors that fall silent."""

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

from app.wizard.losses import NOTHING, Message
from app.wording.body import name_of
from app.wording.numbers import clock
from app.wording.received import lossy_sentence
from app.wording.translation import capitalised, tr
from core.body import Joint, Segment, Side, Site
from core.calibration.strap import Slip
from core.live.bias import BiasCorrection

if TYPE_CHECKING:
    from app.acquisition.memory_fetching import Lack
    from core.signal.received import SamplesReceived

STRIDES_FOR_SPREAD = 10


def slip_message(slips: Sequence[Slip], began_s: float) -> Message:
    """Report the latest strap that slipped since the walk began."""
    since = [slip for slip in slips if slip.from_s > began_s]
    if not since:
        return NOTHING
    slip = since[-1]
    what = tr("Strap moved: {site}, at {time}.").format(site=name_of(slip.site), time=clock(slip.from_s - began_s))
    left = tr("Later strides are excluded. Tighten the strap and repeat free motion for the left leg.")
    right = tr("Later strides are excluded. Tighten the strap and repeat free motion for the right leg.")
    return what, left if slip.site.side is Side.LEFT else right


def implausible_message(joints: Sequence[Joint]) -> Message:
    """Report angles that no joint has, and are not shown."""
    names = ", ".join(name_of(joint) for joint in joints)
    what = tr("{joints}: angle outside −40° to 160°, not shown.")
    return what.format(joints=capitalised(names)), tr("Check the sensor positions, then record the free motion again.")


def bias_message(corrections: Sequence[BiasCorrection]) -> Message:
    """Report the latest gyroscope whose bias from standing was wrong."""
    if not corrections:
        return NOTHING
    what = tr("The gyroscope offset of the {site} sensor was wrong and is now corrected.")
    return what.format(site=name_of(corrections[-1].site)), tr(
        "The patient moved while standing: record standing again."
    )


def no_angles_message(worn: Collection[Site]) -> Message:
    """Say when the angles come that were not known when the walk began."""
    then = tr("The angles appear after five strides of each leg.")
    if not any(site.segment is Segment.FOOT for site in worn):
        then = tr("The angles appear when the walk has been stopped.")  # nothing counts strides before
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
    return what, tr("Steps are detected from the shank. The report states this.")


def recovered_message(walk: str, seconds: float) -> Message:
    """Say how much of a walk the journal holds, and what the end of the program may have cost besides."""
    recovered = tr("{time} of {walk} was recovered, up to the last data on disk.")
    stated, look = (
        recovered.format(time=clock(seconds), walk=walk),
        tr("Review the recording, then include or exclude it."),
    )
    return tr("The program closed during recording."), f"{stated} {look} {recovery_costs()}"


def recovery_costs() -> str:
    """What the end of a program costs at most; the figures are those of T1 in the evidence."""
    return tr(
        "In 99 of 100 cases, ending the program loses at most 0.1 s of recording. A power cut loses "
        "up to 0.5 s and any data not yet on disk."
    )


def lacks_message(walk: str, lacks: "Sequence[Lack]") -> Message:
    """Say what could not be fetched of a walk from the sensors' memories; the gravest first."""
    early = max(lacks, key=lambda one: one.early_s, default=None)
    if early is not None and early.early_s > 0:
        what = tr("{sensor} stopped {seconds} s before the end of {walk}.").format(
            sensor=early.sensor, seconds=round(early.early_s), walk=walk
        )
        return what, tr("The sensor's button was pressed or its memory is full. Angles from this sensor end there.")
    lost = [one for one in lacks if one.lost]
    if lost:
        stated = ", ".join(f"{one.sensor} {one.lost}" for one in lost)
        what = tr("Samples of {walk} could not be fetched: {sensors}.").format(walk=walk, sensors=stated)
        return what, tr("These samples are missing here. The sensors keep the recording until their memory is erased.")
    if lacks:
        what = tr("{sensor} did not report the end of {walk}.").format(sensor=lacks[0].sensor, walk=walk)
        return what, tr("Received data are saved; the end of the walk may be missing.")
    return NOTHING


def lossy_message(counts: "Mapping[Site, SamplesReceived]") -> Message:
    """Say which sensors lose samples while they are recorded."""
    if not (what := lossy_sentence(counts)):
        return NOTHING
    return what, tr("Recording continues. Move the receiver closer to the patient, and keep it in sight.")


def loose_message(on_own_clocks: Sequence[str]) -> Message:
    """Say that sensors that stream are to be synchronised again; `on_own_clocks`: those without the common one."""
    what = tr("The sensors were last synchronised half an hour ago. Their clocks drift apart.")
    if on_own_clocks:
        what = tr("Not synchronised: {sensors}.").format(sensors=", ".join(on_own_clocks))
    return what, tr(
        "Synchronise the sensors again before the next walk. Otherwise measures that combine both "
        "legs are less accurate."
    )


def few_strides_message(counts: Mapping[Side, int]) -> Message:
    """Say what one condition's walks are short of a spread together; a side without a count is not asked for."""
    left, right = (counts.get(side, STRIDES_FOR_SPREAD) for side in Side)
    if min(left, right) >= STRIDES_FOR_SPREAD:
        return NOTHING
    stated = tr("Only {left} left and {right} right strides; a standard deviation needs {required} per leg.")
    if left >= STRIDES_FOR_SPREAD:
        stated = tr("Only {right} right strides; a standard deviation needs {required}.")
    elif right >= STRIDES_FOR_SPREAD:
        stated = tr("Only {left} left strides; a standard deviation needs {required}.")
    what = stated.format(left=left, right=right, required=STRIDES_FOR_SPREAD)
    return what, tr("Record another walk, or continue without a standard deviation.")
