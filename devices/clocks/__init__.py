"""Times of samples, from what a sensor counts, what the computer reads at arrival, or one clock for several sensors."""
