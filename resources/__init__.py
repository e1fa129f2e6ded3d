"""What the program brings along: fonts and pictures, each with its licence. No code."""
