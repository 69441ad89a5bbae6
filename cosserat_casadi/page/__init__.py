"""A scene as one HTML file: the exported solver as WebAssembly, sliders, and the robot drawn as it deforms."""
