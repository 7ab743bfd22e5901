"""TiniScript Studio: the page for a browser, and what it needs from this package.

In the page, this package runs in Pyodide: `worker` is what the page calls. On this computer,
`serving` gives the page to a browser. The page's own sources are in `tools/studio/`.
"""
