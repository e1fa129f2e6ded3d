"""What is stated of a recording's journal and of what befell it, every fact from the counters of both."""

from collections.abc import Mapping

from app.acquisition.heartbeat import ProcessStall
from app.storage.journal.disk import REPORTED, Trouble
from app.storage.journal.writer import SLOW_S, JournalStatus, State
from app.wizard.losses import NOTHING, Message
from app.wording.numbers import clock
from app.wording.translation import tr, tr_n

ENDS = frozenset((Trouble.NO_ROOM, Trouble.DISK_FULL, Trouble.DISK_GONE))  # with these the journal has closed itself
STANDSTILL_REPORTED_S = 15.0
SETTLED_S = 1.0  # until what waited at the sources has been read, and what is missing is counted


def trouble_message(trouble: Trouble, status: JournalStatus, lost: int = 0) -> Message:
    """State what is wrong with the disk, what is still written, and what to do; `lost` counts all sensors."""
    what, remedy = (f"{tr(words)}." for words in REPORTED[trouble])
    if trouble is Trouble.DISK_SLOW and not status.dropped_records:
        return _late_message(status, lost, remedy)
    if trouble in (Trouble.DISK_SLOW, Trouble.DROPPED):
        what, remedy = (f"{tr(words)}." for words in REPORTED[Trouble.DROPPED])
        dropped = tr_n(
            "{count} data packet was lost so far and stays a gap.",
            "{count} data packets were lost so far and stay gaps.",
            status.dropped_records,
        )
        return what, f"{dropped.format(count=status.dropped_records)} {remedy}"
    if trouble in ENDS:
        return what, f"{_written(trouble, status)} {remedy}"
    return what, remedy


def _late_message(status: JournalStatus, lost: int, remedy: str) -> Message:
    """Nothing has been dropped: say so of all samples only where none was lost on its way here either."""
    nothing = (
        tr("No data lost so far.") if not lost else tr("Incoming data wait for the disk. None of them were discarded.")
    )
    if status.stuck_s > SLOW_S:
        return tr("The disk responds slowly."), f"{nothing} {remedy}"
    kept = tr("No data were lost because of this.") if not lost else tr("No data were discarded because of this.")
    return tr("The disk was slow and now responds again."), kept


def _written(trouble: Trouble, status: JournalStatus) -> str:
    """Up to where the recording is kept: on a disk that is gone only what it had confirmed."""
    if trouble is Trouble.DISK_GONE:
        return tr("The first {time} min of the recording are confirmed on the disk.").format(
            time=clock(status.synced_s)
        )
    if status.dropped_records:
        stated = tr("The first {time} min of the recording are written; everything after that is lost.")
    else:
        stated = tr("The first {time} min of the recording are written.")
    return stated.format(time=clock(status.written_s))


def is_written(status: JournalStatus) -> bool:
    """Whether a journal takes all that comes in: nothing of it waits for long, and nothing was dropped."""
    return status.state is State.RECORDING and not status.dropped_records and status.stuck_s <= SLOW_S


def unread_message(status: JournalStatus, *, is_tried_again: bool) -> str:
    """Say where a recording is that has been stopped and is not in the library yet."""
    if status.state is State.RECORDING and is_tried_again:
        return tr("The recording is still being written. It is loaded as soon as possible.")
    if status.state is State.RECORDING:
        return tr("The recording is still being written. When Gaitwright next starts, it finds what was written.")
    is_whole = status.state is State.CLOSED and not status.dropped_records
    if is_tried_again:
        whole = tr("The recording is safe on the disk. It is loaded as soon as possible.")
        part = tr("The first {time} min of the recording are on the disk. They are loaded as soon as possible.")
    else:
        whole = tr("The recording is safe on the disk. Gaitwright finds it when it next starts.")
        part = tr("The first {time} min of the recording are on the disk. Gaitwright finds them when it next starts.")
    return whole if is_whole else part.format(time=clock(status.synced_s))


def no_row_message(status: JournalStatus) -> Message:
    """Say of a recording that goes on where the library did not take its row."""
    what = tr("The library does not respond.")
    if status.dropped_records or status.state is not State.RECORDING:
        return what, tr("The recording is added once the library responds.")
    return what, tr("The recording is still written to the disk. It is added once the library responds.")


def standstill_message(
    standstill: ProcessStall,
    began_s: float,
    now_s: float,
    lost: Mapping[str, int],
    are_received: bool,
    are_counted: bool,
) -> Message:
    """State that the process stalled amid a recording and what was lost; empty once it is long past.

    `began_s` and `now_s` are on the acquisition's clock; `lost`: missing samples by sensor. `are_received`: all have
    sent since; `are_counted`: all report their rate.
    """
    if standstill.ended_s < began_s or now_s - standstill.ended_s > STANDSTILL_REPORTED_S:
        return NOTHING
    stated = tr("Gaitwright stalled for {seconds:.0f} s, {time} min into the recording.")
    if standstill.was_asleep:
        stated = tr("The computer was asleep for {seconds:.0f} s, {time} min into the recording.")
    what = stated.format(seconds=standstill.lasted_s, time=clock(standstill.began_s - began_s))
    if not are_received or now_s - standstill.ended_s < SETTLED_S:
        return what, tr("Missing samples are being counted.")
    if any(count > standstill.lost_before.get(name, 0) for name, count in lost.items()):
        # without a figure: live clocks are still settling, and were up to a tenth off the journal's own count
        return what, tr("Samples were lost and leave gaps. Missing samples are counted when the recording is loaded.")
    if not are_counted:
        return what, tr("Missing samples are counted when the recording is loaded.")
    return what, tr("No sample is missing: data sent in the meantime were read afterwards.")
