"""Layouts: which signal of a well-known software is which column, with frames and units; one file a software."""
