"""The pages as a site and as a book."""
