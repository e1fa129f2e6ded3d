"""Many sessions: analysed by one command (`batch`), and compared in one table (`study`). No screen."""
