"""What may go wrong with an emulated Movella DOT: on the air, while it is synchronised, and in its memory."""

from dataclasses import dataclass, field


@dataclass
class DotFaults:
    """What goes wrong. Shares are of notifications; counts are used up.

    `sync_results`: what each attempt of synchronising ends with; a good one after the last.
    `again`: whether it sends a file from the middle on, also while it sends nothing; while it sends it does in any
    case.
    """

    loss: float = 0.0
    doubles: float = 0.0
    cut: float = 0.0
    damaged: float = 0.0
    silent: float = 0.0
    sync_results: list[int] = field(default_factory=list)
    stale_s: float = 0.0  # so far its clock is off after synchronising, which it calls good
    has_26: bool = True  # whether its firmware knows that mode
    again: bool = True
    busy: int = 0
    stale_answers: int = 0
    """So many readings of an answer give what was answered before."""
    ends_after_s: float = 0.0
    """So long it writes what it holds, once asked to end a recording."""
    full_by_notice: bool = False
    """Whether only a notice states that its memory is full."""
    echoes: bool = False
    """Whether the result of synchronising is reported with what it answers: printed both ways."""
    drops_after: list[int] = field(default_factory=list)
    """After so many operations each the link is lost."""
    drops_export_after: list[int] = field(default_factory=list)
    """After so many samples of a file each the link is lost."""
    unreachable_until_ns: int = 0
    unreachable_after_drop_s: float = 0.0
    """So long it stays away once its link was lost while it sent a file."""
