"""Videos of walks: kept, sealed and destroyed as samples are, each in a file of its own."""
