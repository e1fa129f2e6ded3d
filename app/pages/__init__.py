"""One page of the window each. A page is shown plain values and tells what was pressed; it knows nothing else."""
