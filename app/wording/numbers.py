"""Numbers as people read them: the minus sign, minutes and seconds."""

MINUS = "\N{MINUS SIGN}"


def clock(seconds: float, digits: int = 1) -> str:
    """Give a time in minutes, of `digits` at least, and whole seconds: "4:06", "04:06". No time is negative."""
    minutes, rest = divmod(max(0, int(seconds)), 60)
    return f"{minutes:0{digits}d}:{rest:02d}"
