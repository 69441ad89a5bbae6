"""A scene as one HTML file: the exported solver as WebAssembly, sliders, and a drawing of the deformed robot."""
