import assert from "node:assert"
import {test} from "node:test"
import {strokeProgram} from "../../../../app/frontend/engine/stroke_shaders.js"

// What a card is given to compile: the texts of both shaders.
function shaders(kind, how) {
  const texts = []
  const gl = {
    createProgram: () => ({}), createShader: () => ({}), compileShader() {}, attachShader() {},
    deleteShader() {}, linkProgram() {}, getProgramParameter: () => true,
    shaderSource: (_, text) => texts.push(text),
  }
  strokeProgram(gl, kind, {by: "", opened: false, dashed: false, form: "round", ...how})
  return texts
}

test("only what must throws pixels away: all else is not drawn where something hides it", () => {
  const discards = (kind, how) => shaders(kind, how)[1].includes("discard")
  for (const kind of ["lines", "plain"]) {
    assert.ok(!discards(kind, {}))
    assert.ok(discards(kind, {opened: true}))
  }
  assert.ok(discards("lines", {dashed: true}))
  assert.ok(!discards("plain", {dashed: true}))
  assert.ok(!discards("points", {form: "square"}))
  assert.ok(discards("points", {form: "triangle"}))
})

test("each kind passes on what its pixels are painted from", () => {
  for (const kind of ["lines", "plain", "points"]) {
    for (const by of ["", "colors", "values"]) {
      const [vertex, fragment] = shaders(kind, {by})
      const names = (text, way) => [...text.matchAll(new RegExp(`^ *(?:.*; )?${way} .*$`, "gm"))]
        .flatMap(([line]) => [...line.matchAll(new RegExp(`\\b${way} \\w+ ([^;]*);`, "g"))])
        .flatMap(([, list]) => list.split(", ")).filter((name) => /^\w+$/.test(name)).sort()
      const given = new Set(names(vertex, "out"))
      const lacking = names(fragment, "in").filter((name) => !given.has(name))
      assert.deepEqual(lacking, [], kind)
    }
  }
})
