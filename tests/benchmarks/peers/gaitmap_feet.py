"""Ask gaitmap, in the peers' own environment, for the events and strides of two feet."""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from core.body import Side
from core.samples import FloatArray, ImuBlock
from tests.benchmarks.foot_scoring import FoundEvents, FoundStrides, Stretch
from tests.benchmarks.peers.worker import PeerWorker


@dataclass(frozen=True, slots=True)
class GaitmapFound:
    """What gaitmap found, by what found it ("alignment|borders|detector or trajectory"), and each stage's CPU."""

    events: dict[str, dict[Side, FoundEvents]]
    strides: dict[str, dict[Side, FoundStrides]]
    cpu_s: dict[str, float]
    versions: dict[str, str]


class GaitmapFeet:
    """A running worker."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self._worker = PeerWorker("gaitmap_worker.py")

    def __enter__(self) -> "GaitmapFeet":
        return self

    def __exit__(self, *raised: object) -> None:
        self._worker.close()
        self._folder.cleanup()

    def find(
        self,
        feet: Mapping[Side, ImuBlock],
        alignments: Sequence[str],
        reported: Mapping[str, FloatArray] | None = None,
    ) -> GaitmapFound:
        """Everything it makes of both feet, which begin together at one rate.

        Parameters
        ----------
        feet
            Free of the gyroscope's bias. Turned into gaitmap's sensor frame for the alignment "gravity", in any
            mounting for "heading".
        reported
            "left_borders", "right_borders" (k, 3): number, start and end of each stride, in samples; "left_stances",
            "right_stances" (k, 7): number, start, end, initial contact, toe-off, stance, initial contact before.
        """
        begin_s = feet[Side.LEFT].time_s[0]
        rate_hz = (len(feet[Side.LEFT]) - 1) / float(np.ptp(feet[Side.LEFT].time_s))
        arrays: dict[str, Any] = {"rate_hz": rate_hz, **(reported or {})}
        for side, foot in feet.items():
            arrays |= {f"{side}_acc_m_s2": foot.acc_m_s2, f"{side}_gyr_rad_s": foot.gyr_rad_s}
        folder = Path(self._folder.name)
        np.savez(folder / "feet.npz", **arrays)
        question = {"archive": str(folder / "feet.npz"), "answer": str(folder / "found.npz"), "alignments": alignments}
        answer = self._worker.ask(question)
        events: dict[str, dict[Side, FoundEvents]] = {}
        strides: dict[str, dict[Side, FoundStrides]] = {}
        with np.load(folder / "found.npz") as archive:
            found = dict(archive)
        for kind, key, side in sorted({_parts(name) for name in found}):
            name = f"{kind}|{key}|{side}"
            if kind == "events":
                contact, off = (begin_s + found[name] / rate_hz).T
                events.setdefault(key, {})[side] = FoundEvents(toe_off_s=off, initial_contact_s=contact)
            else:
                strides.setdefault(key, {})[side] = FoundStrides(
                    initial_contact_s=begin_s + found[f"{name}|contact"] / rate_hz,
                    length_m=found[f"{name}|length_m"],
                    stretches=tuple(_stretches(found, name, begin_s, rate_hz)),
                )
        return GaitmapFound(events, strides, answer["cpu_s"], answer["versions"])


def _parts(name: str) -> tuple[str, str, Side]:
    kind, alignment, borders, method, side = name.split("|")[:5]
    return kind, f"{alignment}|{borders}|{method}", Side(side)


def _stretches(found: dict[str, FloatArray], name: str, begin_s: float, rate_hz: float) -> Iterator[Stretch]:
    """The orientations of each stride; gaitmap gives them from the start on, one sample apart."""
    counts = found[f"{name}|count"].astype(int)
    quaternions = np.split(found[f"{name}|q_xyzw"], np.cumsum(counts)[:-1])
    for start, q in zip(found[f"{name}|start"], quaternions, strict=True):
        yield Stretch(begin_s + (start + np.arange(len(q))) / rate_hz, Rotation.from_quat(q))
