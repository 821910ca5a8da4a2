"""What a whole beating heart costs, and how close it comes: real, sliced, analytic, interrupted."""
