"""Text on its way to people: strangers' text made harmless, HTML out of templates, and what commands say."""
