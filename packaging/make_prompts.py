"""Make the spoken prompts of the application again: `python packaging/make_prompts.py`.

espeak-ng speaks them, which has to be installed for this only (Debian's package of that name). It is under the GPL,
version 3; what it speaks is no part of it and under no licence. The phrases are our own.
"""

import subprocess
import tempfile
import wave
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import resample_poly

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "resources" / "sounds" / "spoken"

VOICES = {"en": "en-us", "de": "de"}
WORDS_PER_MINUTE = 155
SPOKEN_HZ, RATE_HZ = 22_050, 16_000  # as espeak-ng speaks, and as is kept: nothing in a voice of its own is above 8 kHz
PEAK = 10 ** (-9 / 20)
SILENT = 0.004  # of the loudest
FULL_SCALE = 2**15 - 1

PHRASES: Mapping[str, Mapping[str, str]] = {
    "circle-left_thigh": {"en": "Circle the left thigh.", "de": "Mit dem linken Oberschenkel kreisen."},
    "circle-left_shank": {"en": "Circle the left lower leg.", "de": "Mit dem linken Unterschenkel kreisen."},
    "circle-left_foot": {"en": "Circle the left foot.", "de": "Mit dem linken Fuß kreisen."},
    "circle-right_thigh": {"en": "Circle the right thigh.", "de": "Mit dem rechten Oberschenkel kreisen."},
    "circle-right_shank": {"en": "Circle the right lower leg.", "de": "Mit dem rechten Unterschenkel kreisen."},
    "circle-right_foot": {"en": "Circle the right foot.", "de": "Mit dem rechten Fuß kreisen."},
    "bend-left_thigh": {"en": "Bend the left hip.", "de": "Linke Hüfte beugen."},
    "bend-left_shank": {"en": "Bend the left knee.", "de": "Linkes Knie beugen."},
    "bend-left_foot": {"en": "Bend the left ankle.", "de": "Linkes Sprunggelenk beugen."},
    "bend-right_thigh": {"en": "Bend the right hip.", "de": "Rechte Hüfte beugen."},
    "bend-right_shank": {"en": "Bend the right knee.", "de": "Rechtes Knie beugen."},
    "bend-right_foot": {"en": "Bend the right ankle.", "de": "Rechtes Sprunggelenk beugen."},
    "move-either-leg": {"en": "Move either leg.", "de": "Ein beliebiges Bein bewegen."},
    "move-left-leg-first": {"en": "Move the left leg first.", "de": "Zuerst das linke Bein bewegen."},
    "walk-with-turn": {
        "en": "Walk for 15 seconds, with a turn.",
        "de": "15 Sekunden gehen, mit einer Wendung.",
    },
    "enough-movement": {"en": "Enough movement.", "de": "Genug Bewegung."},
    "loose-left_knee": {"en": "Left knee: not a hinge.", "de": "Knie links: kein Scharnier."},
    "loose-right_knee": {"en": "Right knee: not a hinge.", "de": "Knie rechts: kein Scharnier."},
    "loose-several": {"en": "Several joints are not hinges.", "de": "Mehrere Gelenke sind keine Scharniere."},
    "no-longer-falls": {"en": "Uncertainty no longer falls.", "de": "Unsicherheit sinkt nicht mehr."},
    "recorded": {"en": "Free motion recorded.", "de": "Freie Bewegung aufgenommen."},
    "stopped-early": {"en": "Stopped early.", "de": "Vorzeitig beendet."},
    "replay-ended": {"en": "The replay has ended.", "de": "Die Wiedergabe ist zu Ende."},
    "replay-without": {"en": "Replay has no free motion.", "de": "Wiedergabe ohne freie Bewegung."},
    "swapped": {
        "en": "Sensor positions look swapped. Check the screen.",
        "de": "Sensorpositionen scheinen vertauscht. Bildschirm prüfen.",
    },
    "stand-still": {
        "en": "The patient stands still. Start the countdown.",
        "de": "Die Person steht still. Countdown starten.",
    },
}


def file_of(name: str, language: str, folder: Path = FOLDER) -> Path:
    """Give where the phrase `name` is kept."""
    return folder / language / f"{name}.wav"


def write(name: str, language: str, folder: Path = FOLDER) -> Path:
    """Speak the phrase `name` into its file, one channel of 16 bit, without the silence round it."""
    with tempfile.TemporaryDirectory() as place:
        raw = Path(place) / "spoken.wav"
        pace = ["-v", VOICES[language], "-s", str(WORDS_PER_MINUTE), "-w", str(raw)]
        subprocess.run(["espeak-ng", *pace, PHRASES[name][language]], check=True)
        samples = _kept(raw)
    file = file_of(name, language, folder)
    file.parent.mkdir(parents=True, exist_ok=True)
    with wave.open(str(file), "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(RATE_HZ)
        out.writeframes(samples.astype("<i2").tobytes())
    return file


def _kept(raw: Path) -> NDArray[np.int16]:
    with wave.open(str(raw), "rb") as spoken:
        assert spoken.getframerate() == SPOKEN_HZ
        samples = np.frombuffer(spoken.readframes(spoken.getnframes()), "<i2").astype(float)
    audible = np.flatnonzero(np.abs(samples) > SILENT * np.abs(samples).max())
    around = round(0.02 * SPOKEN_HZ)
    spoken_part = samples[max(audible[0] - around, 0) : audible[-1] + around]
    kept = resample_poly(spoken_part, RATE_HZ, SPOKEN_HZ)
    return np.round(PEAK * FULL_SCALE * kept / np.abs(kept).max()).astype(np.int16)


if __name__ == "__main__":
    for one in PHRASES:
        for spoken_in in VOICES:
            print(write(one, spoken_in).relative_to(ROOT))
