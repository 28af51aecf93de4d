"""Text on its way to people: makes untrusted text safe to show, HTML out of templates, and what commands say."""
