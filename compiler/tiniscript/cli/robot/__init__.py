"""Code shared by the verbs that talk to a robot."""
