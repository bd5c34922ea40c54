"""The stages of the pipeline: one thin file per stage, in the order of dvc.yaml."""
