"""The pages of results and their controllers. Each page is shown plain values."""
