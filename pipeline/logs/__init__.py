"""Logs as people have them: any format, read into named signals, and mapped to the columns of the contract."""
