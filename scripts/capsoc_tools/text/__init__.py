"""The English of pages, comments and messages."""
