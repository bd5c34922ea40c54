"""Floor 9: what a person's own program calls; `simgap` exports it, and the stages call the same functions."""
