"""Floor 8: the benchmark of the diagnosis on cases with known answers; it reads answer keys and diagnoses only."""
