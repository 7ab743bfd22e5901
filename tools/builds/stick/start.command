#!/bin/sh
# What a double click in the Finder runs.
exec sh "$(dirname "$0")/start.sh" "$@"
