"""The job: its folder, which is the truth, and its live record in Redis."""
