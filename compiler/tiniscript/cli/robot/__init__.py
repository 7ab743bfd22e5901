"""What verbs that talk to a robot share."""
