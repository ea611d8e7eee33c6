import assert from "node:assert/strict"
import {readdirSync, readFileSync} from "node:fs"
import {test} from "node:test"

import {Actor} from "../../../../app/frontend/engine/actor.js"

const ASSETS = new URL("../../../../assets/", import.meta.url)

// Stands for WebGL, and for those parts of vtk.js that only take what they are given.
const anything = () => new Proxy(() => {}, {
  get: (_, name) => name === Symbol.toPrimitive ? () => 0 : anything(),
  apply: anything,
})

class PolyData {
  constructor() { this.arrays = {} }
  getPoints() { return {setData: (points) => { this.points = points }} }
  getPolys() { return anything() }
  getBounds() { return [0, 1, 0, 1, 0, 1] }
  getPointData() {
    return {
      removeArray: (name) => { delete this.arrays[name] },
      addArray: (array) => { this.arrays[array.name] = array },
      setNormals: (array) => { this.arrays.normals = array },
    }
  }

  modified() {}
}

class Mapper {
  constructor() {
    this.attributes = []
    this.special = {}
  }

  setInputData() {}
  setCustomShaderAttributes(names) { this.attributes = names }
  getViewSpecificProperties() { return this.special }
  modified() {}
  removeAllClippingPlanes() {}
}

const made = (Class) => ({newInstance: () => new Class()})
const vtk = {
  Common: {
    DataModel: {vtkPolyData: made(PolyData)},
    Core: {vtkDataArray: {newInstance: (array) => array}},
  },
  Rendering: {Core: {vtkMapper: made(Mapper), vtkActor: {newInstance: anything}}},
}

const actor = () => new Actor({vtk, context: anything(), views: [], poseCount: 0, pose: null})

// How many vertices each demo has: its file begins with a description of all that is in it.
const counts = new Set(readdirSync(ASSETS).filter((name) => name.endsWith(".glb")).map((name) => {
  const file = readFileSync(new URL(name, ASSETS))
  const {meshes, accessors} = JSON.parse(file.subarray(20, 20 + file.readUInt32LE(12)))
  const parts = meshes.flatMap(({primitives}) => primitives)
  return parts.reduce((sum, {attributes}) => sum + accessors[attributes.POSITION].count, 0)
}))

const floats = (n) => new Float32Array(n)
const points = (n) =>
  ({points: floats(3 * n), normals: floats(3 * n), cells: Uint32Array.of(0, 1, 2)})
const skin = (n, count) =>
  ({joints: new Uint16Array(count * n), weights: floats(count * n), count})
const paint = {color: [1, 1, 1], coloured: true}
const looks = {
  colors: (n) => ({paint, colors: new Uint8Array(3 * n)}),
  values: (n) => ({paint, scalars: new Float32Array(n), table: new Uint8Array(30), limits: [0, 1]}),
  plain: () => ({paint: {...paint, coloured: false}}),
}

function check({data, mapper, rest}, n, said) {
  assert.equal(rest.length, 3 * n)
  for (const name of mapper.attributes) {
    const {values, numberOfComponents} = data.arrays[name]
    assert.equal(values.length / numberOfComponents, n, `${name}, ${said}`)
  }
}

test("whatever stood there before, all that a vertex has is there for each vertex", () => {
  assert.ok(counts.size > 4)
  for (const [look, coloured] of Object.entries(looks)) {
    for (const posed of [false, true]) {
      for (const before of counts) {
        for (const now of counts) {
          const said = `${before} then ${now} vertices, ${look}, posed ${posed}`
          const body = actor()
          const skins = {skin: skin(before, 4), apart: {...skin(before, 5), unit: 1}}
          body.update({kind: "surface", ...points(before), ...coloured(before), ...skins})
          check(body, before, said)
          body.update({...points(now), ...coloured(now), ...posed ? {skin: skin(now, 4)} : {}})
          check(body, now, said)
        }
      }
    }
  }
})

test("a skin of other points than those that are there is none", () => {
  const body = actor()
  body.update({kind: "surface", ...points(3), ...looks.plain(), skin: skin(3, 4)})
  body.update(points(5))
  body.renderer.pose = Float32Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
  assert.equal(body.posed(), body.rest)
  body.reskin({vertices: [4], ...skin(1, 4)})
  assert.equal(body.skin, null)
})
