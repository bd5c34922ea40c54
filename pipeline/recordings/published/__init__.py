"""The published recordings: one YAML file per dataset with its address, licence, citation and hashes."""
