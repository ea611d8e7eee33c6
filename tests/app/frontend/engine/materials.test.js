import assert from "node:assert/strict"
import {test} from "node:test"

import {ImageLayers, MATERIAL_SHADER, Materials} from "../../../../app/frontend/engine/materials.js"
import {shaderSwaps} from "../../../../app/frontend/engine/shade.js"

// A graphics card that only notes what is put into its textures.
function card() {
  const [calls, puts] = [[], []]
  const note = (name) => (...given) => { calls.push([name, ...given]) }
  const gl = new Proxy({
    createTexture: () => ({}),
    texStorage3D: note("storage"), texSubImage3D: note("images"), generateMipmap: note("mipmap"),
    deleteTexture: note("delete"), activeTexture: note("unit"),
    texSubImage2D: (...given) =>
      puts.push({row: given[3], size: [given[4], given[5]], values: given[8]}),
  }, {get: (of, name) => of[name] ?? (/^[A-Z]/.test(name) ? name : () => {})})
  return {gl, calls, puts, of: (name) => calls.filter(([called]) => called === name)}
}

test("images become layers, with all smaller sizes; without any the shader has one", () => {
  const {gl, of} = card()
  const layers = new ImageLayers(gl)
  assert.deepEqual(of("storage").at(-1).slice(2), [1, "RGBA8", 1, 1, 1])
  assert.equal(of("mipmap").length, 0)
  layers.set({count: 3, side: 256, pixels: new Uint8Array(3 * 256 * 256 * 4)})
  assert.deepEqual(of("storage").at(-1).slice(2), [9, "RGBA8", 256, 256, 3])
  assert.deepEqual(of("images").at(-1).slice(2, 9), [0, 0, 0, 0, 256, 256, 3])
  assert.equal(of("mipmap").length, 1)
  assert.equal(of("delete").length, 1)
  layers.set(null)
  assert.equal(of("delete").length, 2)
})

test("each corner has a place and a tint", () => {
  const {gl, puts} = card()
  const corners = Float32Array.from({length: 6 * 4}, (_, i) => i)
  new Materials(gl).set({corners, tints: Uint8Array.from({length: 6 * 4}, (_, i) => i)})
  assert.deepEqual(puts.map(({size}) => size), [[6, 1], [6, 1]])
  assert.equal(puts[0].values.length, 24)
  assert.equal(puts[1].values.length, 24)
})

// GLSL's function, read as JavaScript: what the card works out for a place in the image.
function wrapped(at, how, edge) {
  const source = MATERIAL_SHADER.fragment[0][1]
  const body = source.slice(source.indexOf("{", source.indexOf("float wrapped")) + 1)
  const code = body.slice(0, body.indexOf("\n      }"))
  const clamp = (x, low, high) => Math.min(Math.max(x, low), high)
  const mod = (x, by) => x - by * Math.floor(x / by)
  const wrapped = new Function("at", "how", "edge", "clamp", "mod", "abs", code)
  return wrapped(at, how, edge, clamp, mod, Math.abs)
}

test("an image repeats, ends with its border, or turns back", () => {
  const edge = 1 / 256
  for (const at of [-1.3, -0.2, 0.4, 1.1, 2.6]) {
    assert.equal(wrapped(at, 0, edge), at)  // the card repeats it
    assert.equal(wrapped(at, 1, edge), Math.min(Math.max(at, edge), 1 - edge))
  }
  for (const [at, seen] of [[-0.2, 0.2], [0.4, 0.4], [1.1, 0.9], [2.6, 0.6], [-1.3, 0.7]]) {
    assert.ok(Math.abs(wrapped(at, 2, edge) - seen) < 1e-9, at)
  }
})

test("each of four by four pixels is drawn from another alpha on", () => {
  const source = MATERIAL_SHADER.fragment[0][1]
  const share = (x, y) => {
    [x, y] = [Math.floor(x), Math.floor(y)]
    return (0.5 * x + 0.75 * y * y) % 1
  }
  assert.ok(source.includes("fract(0.5 * pixel.x + 0.75 * pixel.y * pixel.y)"))
  assert.ok(source.includes("0.25 * share(0.5 * pixel) + share(pixel) + 0.03125"))
  const found = new Set()
  for (let x = 0; x < 4; x++) {
    for (let y = 0; y < 4; y++) { found.add(0.25 * share(x / 2, y / 2) + share(x, y) + 0.03125) }
  }
  const all = Array.from({length: 16}, (_, i) => (i + 0.5) / 16)
  assert.deepEqual([...found].sort((a, b) => a - b), all)
})

test("the shader of a surface in materials reads no colours of points", () => {
  const swaps = shaderSwaps({sets: 1, otherSets: 0, by: "materials"})
  const text = JSON.stringify(swaps)
  assert.ok(text.includes("sampler2DArray") && text.includes("skinJoints0MC"))
  assert.ok(!text.includes("colourTable") && !text.includes("pointIdMC"))
})
