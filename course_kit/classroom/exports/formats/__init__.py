"""One module for each format: `files(book)` yields path, relative to the output folder, and text of each file."""
