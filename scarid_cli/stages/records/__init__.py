"""Logs in memory and as they stream: rows, segments, times, and the rates of sensors."""
