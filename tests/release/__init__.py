"""The rehearsal of a release: what it finds wrong, and that what is made is the same twice."""
