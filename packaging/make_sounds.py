"""Make the sounds of the application again: `python packaging/make_sounds.py`.

They are our own, so that nobody's licence comes with them, and made here, so that one that is inaudible in a
practice can be mended. Each is a row of tones that rise and fall softly: a tone that begins at once begins with a
click.
"""

import wave
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "resources" / "sounds"

RATE_HZ = 48_000  # what sound cards run at: nothing has to be resampled
PEAK = 10 ** (-18 / 20)  # -18 dB of full scale: audible over steps on a wooden floor, no fright beside the machine
FULL_SCALE = 2**15 - 1


@dataclass(frozen=True, slots=True)
class Tone:
    """A tone or, at 0 Hz, silence. `overtones` are the shares of the second, third, ... multiple of `hz`."""

    hz: float
    lasts_s: float
    rises_s: float = 0.015
    falls_s: float = 0.04
    overtones: tuple[float, ...] = ()


PAUSE = Tone(0.0, 0.08)
# The speakers of a laptop hardly give 220 Hz; the ear infers it from its multiples.
LOW = Tone(220.0, 0.18, overtones=(0.6, 0.4))

SOUNDS: Mapping[str, tuple[Tone, ...]] = {
    "start": (Tone(660.0, 0.12), Tone(880.0, 0.18)),
    "stop": (Tone(880.0, 0.12), Tone(660.0, 0.18)),
    "count": (Tone(440.0, 0.10),),
    "ready": (Tone(990.0, 0.35, rises_s=0.06, falls_s=0.25),),
    "loss": (LOW, PAUSE, LOW),
    "reached": (Tone(880.0, 0.20, falls_s=0.12),),
    "tick": (Tone(660.0, 0.05, rises_s=0.005, falls_s=0.03),),
}


def samples(tones: tuple[Tone, ...]) -> NDArray[np.int16]:
    """Give the sound of `tones`, one after the other, as 16 bit samples (n,)."""
    wave_form = np.concatenate([_wave(tone) for tone in tones])
    return np.round(PEAK * FULL_SCALE * wave_form / np.abs(wave_form).max()).astype(np.int16)


def write(name: str, folder: Path = FOLDER) -> Path:
    """Write the sound `name`, one channel, into `folder`."""
    file = folder / f"{name}.wav"
    with wave.open(str(file), "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(RATE_HZ)
        out.writeframes(samples(SOUNDS[name]).astype("<i2").tobytes())
    return file


def _wave(tone: Tone) -> NDArray[np.float64]:
    count = round(tone.lasts_s * RATE_HZ)
    time_s = np.arange(count) / RATE_HZ
    if tone.hz == 0:
        return np.zeros(count)
    shares = (1.0, *tone.overtones)
    summed = sum(share * np.sin(2 * np.pi * (i + 1) * tone.hz * time_s) for i, share in enumerate(shares))
    # half a cosine on either side: neither value nor slope jumps
    rise = 0.5 - 0.5 * np.cos(np.pi * np.clip(time_s / tone.rises_s, 0, 1))
    fall = 0.5 - 0.5 * np.cos(np.pi * np.clip((time_s[-1] - time_s) / tone.falls_s, 0, 1))
    return np.asarray(summed * rise * fall)


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for one in SOUNDS:
        print(write(one).relative_to(ROOT))
