"""The `neuralmri` command."""
