"""Floor 6: how good the diagnosis is, measured on cases whose answer is known; reads keys and diagnoses alone."""
