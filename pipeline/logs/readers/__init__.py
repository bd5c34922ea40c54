"""Readers: one file per format; each gives the signals as the file has them, in its own frames, names and units."""
