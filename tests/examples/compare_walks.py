"""Compare the walks of a session, figure by figure.

    python -m tests.examples.compare_walks SESSION FIGURE.png

Strides that are not used (turns, starts, stops) and figures that are not reported are left out. The bars show the mean
of each walk with the standard deviation over strides. That spread is not the error of a difference between two walks,
which `gaitwright compare` states. Printed is each mean.
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

from core import analyse
from devices import read_session

FIGURES = ("speed_m_s", "stride_length_m", "stride_time_s", "knee_range_deg", "ankle_range_deg")


def main(folder: Path, out: Path) -> None:
    strides = analyse(read_session(folder)).to_dataframe("strides").dropna(subset="value")
    groups = strides[strides["used"]].groupby(["quantity", "recording", "side"])["value"]
    table = groups.agg(["mean", "std", "count"]).loc[list(FIGURES)]
    print(table.round(3).to_string())
    figure = Figure(figsize=(2.6 * len(FIGURES), 3.5), layout="constrained")
    for axes, name in zip(figure.subplots(1, len(FIGURES)), FIGURES, strict=True):
        of_one = table.loc[name].unstack("side")
        of_one["mean"].plot.bar(ax=axes, yerr=of_one["std"], capsize=3, title=name, xlabel="", rot=20, legend=False)
    axes.legend(of_one["mean"].columns, fontsize="small")
    figure.savefig(out)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
