"""Opening the library: first start, joining a clinic, logging in, the sheet with the recovery key."""
