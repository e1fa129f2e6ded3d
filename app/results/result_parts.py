"""The parts of the results, each made when it is needed or a little before, and what a page has room for."""

from dataclasses import dataclass
from functools import cached_property

from app.plots.stride_legs import StrideLegs
from app.results.compare_page import ComparePage
from app.results.cycle_page import CyclePage
from app.results.quality_page import QualityPage
from app.results.strides_page import StridesPage
from app.results.video_page import VideoPage
from app.results.whole_page import WholePage
from app.widgets import grid

COMPACT_BELOW = (940, 608)  # the charts and the rows beneath them need so much
NARROW_BELOW = 860  # what the tools need in one row
SPACIOUS_FROM = 1600  # what charts, differences and their table need side by side
TWO_TABLES_FROM = 980
TWO_CHARTS_FROM = 680


@dataclass(frozen=True, slots=True)
class PageRoom:
    """What a page of its size has room for."""

    is_compact: bool = False
    is_narrow: bool = False
    has_two_charts: bool = False
    has_two_tables: bool = False
    has_strides_beside: bool = False
    is_spacious: bool = False
    is_on_grid: bool = False

    @classmethod
    def of(cls, width: float, height: float) -> "PageRoom":
        """What so many px of the design have room for."""
        is_compact = width < COMPACT_BELOW[0] or height < COMPACT_BELOW[1]
        return cls(
            is_compact=is_compact,
            is_narrow=width < NARROW_BELOW,
            has_two_charts=width >= TWO_CHARTS_FROM,
            has_two_tables=width >= TWO_TABLES_FROM,
            has_strides_beside=width >= COMPACT_BELOW[0],
            is_spacious=not is_compact and width >= SPACIOUS_FROM,
            is_on_grid=width >= grid.NARROW_BELOW,
        )


class ResultParts:
    """The parts of a result page that take long to be made: one at a time before they are needed, or else then."""

    @cached_property
    def cycles(self) -> CyclePage:
        return CyclePage()

    @cached_property
    def strides(self) -> StridesPage:
        return StridesPage()

    @cached_property
    def compare(self) -> ComparePage:
        return ComparePage()

    @cached_property
    def whole(self) -> WholePage:
        return WholePage()

    @cached_property
    def legs(self) -> StrideLegs:
        return StrideLegs()

    @cached_property
    def quality(self) -> QualityPage:
        return QualityPage()

    @cached_property
    def video(self) -> VideoPage:
        return VideoPage()

    def make_next(self) -> bool:
        """Make one part; whether there was one left to be made."""
        names = ("cycles", "strides", "compare", "whole", "quality", "legs", "video")
        left = [name for name in names if name not in vars(self)]
        if left:
            getattr(self, left[0])
        return bool(left)
