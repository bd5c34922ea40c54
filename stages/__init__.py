"""What runs: one thin file per stage, in the order of dvc.yaml."""
