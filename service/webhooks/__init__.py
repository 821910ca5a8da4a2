"""Telling callers' own servers that a job has ended, by the Standard Webhooks scheme."""
