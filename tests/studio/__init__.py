# Ends the objects of package scope, such as the browser's event loop, before other tests run.
