"""The package and the pictures of the pages."""
