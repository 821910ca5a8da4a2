"""`report.html`: one page with its scripts, figures and style inside."""
