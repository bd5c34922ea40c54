"""The concealed joint: one axis whose friction, gears, motor and supply are richer than the catalogue."""
