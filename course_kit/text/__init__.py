"""Text on its way to people: what strangers wrote made harmless, and HTML out of templates."""
