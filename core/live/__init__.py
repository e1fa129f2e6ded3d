"""What do the sensors tell while the patient stands, moves and walks? Blocks of samples in, states out."""
