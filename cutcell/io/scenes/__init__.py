"""FBX and USD: a subprocess reads the scene, which becomes a glTF document."""
