"""What the program brings along: fonts, pictures and reference bands, each with its licence or source. No code."""
