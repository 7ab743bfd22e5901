# Ends what has the scope of this package, the browser's event loop, before other tests run.
