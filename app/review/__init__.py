"""Looking at a session again in Rerun. `rerun_log` is the only file that imports it."""
