"""Check of a recording against itself and the platform, before anything is named."""
