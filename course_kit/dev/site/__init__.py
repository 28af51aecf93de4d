"""The site to read before installing: the course's own pages and notebooks, made into HTML by Sphinx."""
