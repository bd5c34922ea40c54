"""Floor 7: what a diagnosis says: where a simulator errs, what it lacks, and how well the mended one predicts."""
