"""The blind procedure: from logs to parameters and a verdict, with nothing set."""
