"""What a careful colleague looks at in a log before it is identified."""
