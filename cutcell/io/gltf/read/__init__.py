"""From a glTF document to a rig."""
