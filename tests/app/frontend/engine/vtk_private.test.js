import assert from "node:assert/strict"
import {readFileSync} from "node:fs"
import {test} from "node:test"
import vm from "node:vm"

import * as used from "../../../../app/frontend/engine/vtk_private.js"

const bundle = readFileSync(process.env.VTK_JS, "utf8")

// Stands for what a browser has: vtk.js asks for it as it is loaded.
const anything = () => new Proxy(() => {}, {
  get: (_, name) => name === Symbol.toPrimitive ? () => 0
    : name === Symbol.iterator ? function* () {} : anything(),
  apply: anything, construct: anything,
})
Object.assign(globalThis, {
  window: globalThis, self: globalThis, document: anything(), Image: class { style = {} },
  HTMLElement: class {},
  screen: {width: 1, height: 1}, location: {search: ""},
})
vm.runInThisContext(bundle)
const {Core, OpenGL} = globalThis.vtk.Rendering

test("the lines that are replaced are in the shaders of vtk.js", () => {
  const shaders = bundle.replaceAll("\\n", "\n")
  const lines = [...Object.values(used.VERTEX), ...Object.values(used.FRAGMENT)].flat()
  assert.equal(lines.length, 10)
  for (const line of lines.map((one) => one.trim())) {
    // vtk.js writes the number of a light, and its own newlines, as it makes the text.
    const parts = line.split(/(?<=VC)\d/)
    assert.ok(parts.every((part) => shaders.includes(part)), `vtk.js has no line ${line} any more`)
  }
})

test("vtk.js has the methods that are called", () => {
  const methods = [
    ["vtkMapper", Core.vtkMapper, "setResolveCoincidentTopologyToPolygonOffset"],
    ["a vtkMapper", Core.vtkMapper.newInstance(), "getViewSpecificProperties",
      "setCustomShaderAttributes", "setRelativeCoincidentTopologyPolygonOffsetParameters"],
    ["a vtkCamera", Core.vtkCamera.newInstance(), "getCompositeProjectionMatrix"],
    ["a vtkRenderWindow", OpenGL.vtkRenderWindow.newInstance(), "traverseAllPasses", "getCanvas"],
    ["a vtkHelper", OpenGL.vtkHelper.newInstance(), "getProgram", "getCABO"],
    ["a vtkCellArrayBufferObject", OpenGL.vtkCellArrayBufferObject.newInstance(),
      "getCoordShiftAndScaleEnabled", "getInverseShiftAndScaleMatrix"],
    ["a vtkShaderProgram", OpenGL.vtkShaderProgram.newInstance(), "isUniformUsed", "setUniformi",
      "setUniformf", "setUniform3fArray"],
  ]
  for (const [what, object, ...names] of methods) {
    for (const name of names) {
      assert.equal(typeof object[name], "function", `${what} has no ${name} any more`)
    }
  }
})

test("a mapper keeps what changes its shaders where vtk.js looks for it", () => {
  const mapper = Core.vtkMapper.newInstance()
  const calls = []
  used.changeShaders(mapper, used.replacements([["a", "b"]], []), ["extra"])
  used.beforeDrawing(mapper, (...given) => calls.push(given))
  const {OpenGL: {ShaderReplacements}, ShadersCallbacks} = mapper.getViewSpecificProperties()
  assert.equal(ShaderReplacements[0].originalValue, "a")
  assert.deepEqual(mapper.getCustomShaderAttributes(), ["extra"])
  ShadersCallbacks[0].callback(null, {getProgram: () => "program", getCABO: () => "buffer"})
  assert.deepEqual(calls, [["program", "buffer"]])
  for (const name of ["ShaderReplacements", "ShadersCallbacks", "CustomShaderAttributes"]) {
    assert.ok(bundle.includes(name), `vtk.js reads no ${name} any more`)
  }
})
