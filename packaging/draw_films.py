"""Draw the manual's films for the site: `python packaging/draw_films.py INTO --lang de`, without a screen.

Of each film and theme INTO gets the film as an animated WebP that plays once, and its scenes side by side as PNG. In
the application nothing of this is needed: there they are drawn as they play.
"""

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from PIL.Image import Image

    from app.films.film import Film
    from app.theme.theme import Theme

FRAMES_PER_S = 12.5
WIDTH = 640


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("into", metavar="INTO", type=Path, help="the folder for films and stills")
    parser.add_argument("--lang", default="en", help="in which language their words are, as de")
    required = parser.parse_args(arguments)
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
    from PySide6.QtWidgets import QApplication

    from app.films.film import Film
    from app.theme.current import current_theme, load_fonts, set_dark
    from app.wording.translation import use_language

    _application = QApplication([])
    load_fonts()
    use_language(required.lang)
    required.into.mkdir(parents=True, exist_ok=True)
    for is_dark, suffix in ((False, ""), (True, "-dark")):
        set_dark(is_dark)
        for film in Film:
            _drawn(current_theme(), film, None).save(required.into / f"{film}{suffix}-stills.png")
            _save_film(current_theme(), film, required.into / f"{film}{suffix}.webp")


def _save_film(theme: "Theme", film: "Film", file: Path) -> None:
    from app.films.film import duration_s

    count = round(duration_s(film) * FRAMES_PER_S)
    first, *others = (_drawn(theme, film, k / FRAMES_PER_S) for k in range(count + 1))
    duration_ms = round(1000 / FRAMES_PER_S)
    first.save(file, save_all=True, append_images=others, duration=duration_ms, loop=1, quality=60, minimize_size=True)
    print(f"{file.name}: {count + 1} frames, {file.stat().st_size // 1024} kB")


def _drawn(theme: "Theme", film: "Film", time_s: float | None) -> "Image":
    """One frame, or, without a time, all scenes side by side."""
    from PIL.Image import frombytes
    from PySide6.QtCore import QRectF
    from PySide6.QtGui import QColor, QImage, QPainter

    from app.films.film import film_height, paint_frame, paint_stills

    rect = QRectF(0, 0, WIDTH, film_height(WIDTH, is_moving=time_s is not None))
    image = QImage(rect.size().toSize(), QImage.Format.Format_RGBA8888)
    image.fill(QColor(theme.colours.ground))
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    if time_s is None:
        paint_stills(painter, rect, theme, film)
    else:
        paint_frame(painter, rect, theme, film, time_s)
    painter.end()
    return frombytes("RGBA", (image.width(), image.height()), bytes(image.constBits())).convert("RGB")


if __name__ == "__main__":
    main(sys.argv[1:])
