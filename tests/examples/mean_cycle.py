"""Plot the mean gait cycle of every joint with a band of one standard deviation over strides.

    python -m tests.examples.mean_cycle SESSION FIGURE.png

A cycle goes from initial contact to the next of the same foot, in percent. Printed is over how many strides each mean
is; a curve that is not reported is not drawn.
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

from core import analyse
from devices import read_session


def main(folder: Path, out: Path) -> None:
    cycles = analyse(read_session(folder)).to_dataframe("cycles").dropna(subset="value")
    absolute = cycles[~cycles["quantity"].str.endswith("_shape_deg")]
    quantities = sorted(absolute["quantity"].unique())
    figure = Figure(figsize=(4 * len(quantities), 3.5), layout="constrained")
    for axes, quantity in zip(figure.subplots(1, len(quantities), squeeze=False)[0], quantities, strict=True):
        for (recording, side), rows in absolute[absolute["quantity"] == quantity].groupby(["recording", "side"]):
            axes.plot(rows["percent"], rows["value"], label=f"{recording}, {side}")
            axes.fill_between(rows["percent"], rows["value"] - rows["sd"], rows["value"] + rows["sd"], alpha=0.25)
            print(f"{recording}, {side}, {quantity}: {rows['n'].iloc[0]} strides")
        axes.set(xlabel="gait cycle (%)", ylabel=quantity.replace("_deg", " (deg)"))
        axes.legend(fontsize="small")
    figure.savefig(out)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
