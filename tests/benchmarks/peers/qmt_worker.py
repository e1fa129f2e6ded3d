"""Report which axes qmt finds. Run by the peers' Python: one path to an archive per line in, one line of JSON out.

`qmt.jointAxisEstHingeOlsson` (Olsson et al. 2020, doi 10.3390/s20123534) with its default settings, but without its
printing, which would cost it time.
"""

import json
import sys
import time

import numpy as np
import qmt

for line in sys.stdin:
    with np.load(line.strip()) as archive:
        acc1, acc2, gyr1, gyr2 = (np.asarray(archive[name]) for name in ("acc1", "acc2", "gyr1", "gyr2"))
    start_s = time.process_time()
    axis_1, axis_2 = qmt.jointAxisEstHingeOlsson(acc1, acc2, gyr1, gyr2, estSettings={"quiet": True})
    cpu_s = time.process_time() - start_s
    found = {"axis_1": axis_1.ravel().tolist(), "axis_2": axis_2.ravel().tolist(), "cpu_s": cpu_s}
    print(json.dumps(found), flush=True)
