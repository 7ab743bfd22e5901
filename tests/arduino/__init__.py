"""The library for sketches of others: it builds, runs and keeps the rules of the registries."""
