"""The machine in Python and as WebAssembly, and the trace of a run."""
