"""What the build and the tests generate from descriptions."""
