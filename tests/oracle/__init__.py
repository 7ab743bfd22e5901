"""A second, independent TiniScript: a slow and plain interpreter that judges the fast one."""
