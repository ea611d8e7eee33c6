import assert from "node:assert/strict"
import {test} from "node:test"

import {Colours, colourShader, pointIds} from "../../../../app/frontend/engine/colour.js"
import {shaderSwaps} from "../../../../app/frontend/engine/shade.js"

// A graphics card that only notes what is put into its textures.
function card() {
  const puts = []
  const gl = new Proxy({
    createTexture: () => ({}),
    texSubImage2D: (...given) =>
      puts.push({row: given[3], size: [given[4], given[5]], values: given[8]}),
  }, {get: (of, name) => of[name] ?? (/^[A-Z]/.test(name) ? name : () => {})})
  return {gl, puts}
}

test("values fill rows of the texture, the last one in part", () => {
  const {gl, puts} = card()
  const colours = new Colours(gl)
  const values = Float32Array.from({length: 2 * 2048 + 5}, (_, i) => i)
  colours.setValues(values, new Uint8Array(3 * 16), [0, 1])
  const [whole, rest, table] = puts
  assert.deepEqual([whole.row, whole.size], [0, [2048, 2]])
  assert.deepEqual([rest.row, rest.size], [2, [5, 1]])
  assert.deepEqual([...rest.values], [4096, 4097, 4098, 4099, 4100])
  assert.deepEqual(table.size, [16, 1])
})

test("new values of as many points are put into the same texture", () => {
  const colours = new Colours(card().gl)
  const table = new Uint8Array(3 * 16)
  colours.setValues(new Float32Array(10), table, [0, 1])
  const {data} = colours.points
  colours.setValues(new Float32Array(10), table, [0, 2])
  assert.equal(colours.points.data, data)
  colours.setColors(new Uint8Array(30))
  assert.notEqual(colours.points.data, data)
})

test("of a few points only the rows of the texture that have them are put again", () => {
  const {gl, puts} = card()
  const colours = new Colours(gl)
  colours.setValues(new Float32Array(3 * 2048 + 5), new Uint8Array(3 * 16), [0, 1])
  puts.length = 0
  const vertices = Uint32Array.of(2048, 2050, 3 * 2048 + 4)
  colours.repaint({vertices, scalars: Float32Array.of(0.25, 0.5, 0.75)})
  assert.deepEqual(puts.map(({row, size}) => [row, size]), [[1, [2048, 1]], [3, [5, 1]]])
  assert.deepEqual([...puts[0].values.subarray(0, 3)], [0.25, 0, 0.5])
  assert.equal(colours.values[3 * 2048 + 4], 0.75)
  puts.length = 0
  colours.repaint({vertices, colors: new Uint8Array(9)})
  assert.equal(puts.length, 0, "values are shown, not colours")
})

test("corners know their points", () => {
  assert.deepEqual([...pointIds(4)], [0, 1, 2, 3])
})

test("shaders take what is needed, and no more", () => {
  assert.deepEqual(colourShader("", false).fragment, [])
  const text = (by, apart) => JSON.stringify(colourShader(by, apart))
  assert.ok(text("values", false).includes("colourTable"))
  assert.ok(!text("colors", false).includes("texture2D"))
  assert.ok(!text("values", true).includes("texelFetch"))
  const swaps = shaderSwaps({sets: 1, otherSets: 0, by: "values"})
  assert.ok(swaps.some(({shaderType, replacementValue}) =>
    shaderType === "Vertex" && replacementValue.includes("skinJoints0MC")))
})
