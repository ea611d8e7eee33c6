// All that the scripts use of vtk.js beyond its documented interface, and the lines of its shaders
// that they replace. tests/app/frontend/engine/vtk_private.test.js names what a new version lacks.

export const VERTEX = {
  main: "void main()\n{", seen: "MCVCMatrix * vertexMC", placed: "MCPCMatrix * vertexMC",
  normal: "normalMatrix * normalMC", cut: "dot(clipPlanes[planeNum], vertexMC)",
}
export const FRAGMENT = {
  main: "void main()\n{", ambient: "  ambientColor = ambientColorUniform;",
  diffuse: "  diffuseColor = diffuseColorUniform;",
  gleams: [0, 1].map((light) => `if (dot(normalVCVSOutput, lightDirectionVC${light}) < 0.0)`),
}

// Replaces lines of the shaders, in pairs of old and new ones.
export function replacements(vertex, fragment) {
  const swap = (shaderType) => ([originalValue, replacementValue]) =>
    ({shaderType, originalValue, replacementValue, replaceFirst: false, replaceAll: false})
  return [...vertex.map(swap("Vertex")), ...fragment.map(swap("Fragment"))]
}

// Lets a mapper draw by changed shaders, which read more arrays of the points by their names.
export function changeShaders(mapper, swaps, arrays) {
  mapper.setCustomShaderAttributes(arrays)
  mapper.getViewSpecificProperties().OpenGL = {ShaderReplacements: swaps}
  mapper.modified()
}

// Calls a function just before a mapper draws, with the program and where its points truly are.
export function beforeDrawing(mapper, act) {
  const callback = (_, primitive) => act(primitive.getProgram(), primitive.getCABO())
  mapper.getViewSpecificProperties().ShadersCallbacks = [{callback}]
}

// vtk.js shifts and scales points that are far from 1.
export function trueCoordinates(buffer) {
  if (!buffer.getCoordShiftAndScaleEnabled()) { return {scale: [1, 1, 1], shift: [0, 0, 0]} }
  const m = buffer.getInverseShiftAndScaleMatrix()
  return {scale: [m[0], m[5], m[10]], shift: [m[12], m[13], m[14]]}
}

// A window whose context is made before vtk.js asks for one, so that it does not smooth edges:
// that is chosen for each frame (smooth.js).
export function makeWindow(vtk) {
  // Lines in a surface are drawn over it. This is a global switch of vtk.js.
  vtk.Rendering.Core.vtkMapper.setResolveCoincidentTopologyToPolygonOffset()
  const gl = vtk.Rendering.OpenGL.vtkRenderWindow.newInstance()
  const context = gl.getCanvas().getContext("webgl2", {
    antialias: false, depth: true, alpha: true, powerPreference: "high-performance",
  })
  return {gl, context}
}

// Draws what is behind others in depth.
export function pushBack(mapper) {
  mapper.setRelativeCoincidentTopologyPolygonOffsetParameters(2, 30)
}

export function drawAll(gl) { gl.traverseAllPasses() }

export function projectionMatrix(camera, aspect) {
  return camera.getCompositeProjectionMatrix(aspect, -1, 1)
}
