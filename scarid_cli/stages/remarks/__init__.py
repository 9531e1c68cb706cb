"""What is told of a log beside the result."""
