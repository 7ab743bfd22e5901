"""Code that the verbs with a robot share."""
