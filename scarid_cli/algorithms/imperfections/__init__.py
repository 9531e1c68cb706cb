"""The imperfections of real cells that the simulator knows: what they are called and mean."""
