"""Floor 5: where a simulator and a recording differ, which physics is missing, its model and its validation."""
