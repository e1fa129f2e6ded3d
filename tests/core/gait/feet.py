"""A foot's or shank's samples with their orientation, as the events are found in."""

from core.samples import FloatArray, ImuBlock, RateKind
from core.signal.orientation import oriented
from core.signal.pair import OrientedTrack
from core.signal.tracks import even_tracks


def foot_of(block: ImuBlock, bias_rad_s: FloatArray) -> OrientedTrack:
    (track,) = even_tracks(block)
    return oriented(track, RateKind.INSTANTANEOUS, bias_rad_s)
