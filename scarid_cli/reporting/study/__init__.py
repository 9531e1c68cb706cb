"""The page of one study: what to believe first, then each result with its uncertainty."""
