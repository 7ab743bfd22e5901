"""Every sentence of the command, in English and Spanish."""
