"""What voices share that sample evenly from when they begin."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

Motion = Callable[[int], Sequence[float]]
"""Rate (3) and force (3), in deg/s and g where the voice states no other, of the sample of this number."""


class EvenVoice(ABC):
    """The `Voice` of a sensor, but for the bytes of a sample and the answers to commands."""

    def __init__(self, motion: Motion, now_ns: Callable[[], int]) -> None:
        self._motion, self._now_ns = motion, now_ns
        self._begin_ns, self._sent = now_ns(), 0

    @property
    @abstractmethod
    def rate_hz(self) -> float: ...

    @abstractmethod
    def sample(self, number: int) -> bytes:
        """What is sent of one sample."""

    def sampled_ns(self, number: int) -> float:
        """When the sample of this number is taken, by the host's clock."""
        return self._begin_ns + (number + 1) * 1e9 / self.rate_hz

    def say(self) -> bytes:
        due = int((self._now_ns() - self._begin_ns) / 1e9 * self.rate_hz)
        stated = b"".join(self.sample(number) for number in range(self._sent, due))
        self._sent = max(self._sent, due)
        return stated
