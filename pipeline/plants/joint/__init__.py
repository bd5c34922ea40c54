"""Concealed joint: one axis with richer friction, gears, motor and supply than the catalogue."""
