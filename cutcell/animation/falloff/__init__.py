"""The falloff "rig": from distances to weights as artists paint them."""
