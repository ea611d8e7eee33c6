"""From a rig to a glTF document."""
