"""What `convert` makes of logs as people have them: names, units, clocks, cells."""
