"""Figures of the site's pages of methods, computed by the code that they explain: `site_figures.py INTO`.

Each script of `packaging/site/figures` has a function `draw`, which is given an empty figure. INTO gets it for the
light and for the dark theme, the same in every run.
"""

import runpy
import sys
from pathlib import Path
from typing import Any

import matplotlib
from cycler import cycler
from matplotlib.figure import Figure

SCRIPTS = Path(__file__).resolve().parent / "site" / "figures"
SIZE = (7.0, 3.2)
INKS = {"": ("#333333", ("#0072B2", "#B84A00", "#00724F")), "-dark": ("#DDDDDD", ("#6CC0F0", "#F2A65A", "#4FD1A5"))}


def main(into: Path) -> None:
    into.mkdir(parents=True, exist_ok=True)
    for script in sorted(SCRIPTS.glob("*.py")):
        draw = runpy.run_path(str(script))["draw"]
        for suffix, (ink, colours) in INKS.items():
            with matplotlib.rc_context(style(ink, colours)):
                figure = Figure(figsize=SIZE, layout="constrained")
                draw(figure)
                figure.savefig(into / f"{script.stem}{suffix}.svg", transparent=True, metadata={"Date": None})


def style(ink: str, colours: tuple[str, ...]) -> dict[Any, Any]:
    inked = ("text.color", "axes.edgecolor", "axes.labelcolor", "axes.titlecolor", "xtick.color", "ytick.color")
    return {
        **dict.fromkeys(inked, ink),
        "axes.prop_cycle": cycler(color=colours),
        "axes.spines.top": False,
        "axes.spines.right": False,
        "font.size": 10.0,
        "axes.titlesize": 10.0,
        "axes.titlelocation": "left",
        "legend.frameon": False,
        "lines.linewidth": 1.6,
        "svg.hashsalt": "gaitwright",
    }


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
