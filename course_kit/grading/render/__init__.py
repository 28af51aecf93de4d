"""A report as text and as HTML."""
