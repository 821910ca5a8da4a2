"""What a request must be before anything is computed: limits and plausibility."""
