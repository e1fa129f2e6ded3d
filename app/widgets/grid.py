"""Margin at which the content begins: the same for header, tiles, page and bar, so that their edges line up."""

from app.theme.theme import Theme

COMPACT_BELOW = (1180, 720)  # of the window, px of the design
WIDE_FROM = 1920
CONTENT = 1600  # wider lines are not read any better
LEAST = 336  # the same of a window of 800 at 200 %; narrower is only what has not been laid out yet
NARROW_BELOW = 964  # what the rail leaves of the least window that is not compact


def side_margin(width: int, theme: Theme) -> int:
    """Give the margin at either side of what lies right of the rail and is `width` wide, in pixels."""
    px = theme.px
    if width < px(NARROW_BELOW):
        return px(16)
    return max((width - px(CONTENT)) // 2, 0) + px(24)
