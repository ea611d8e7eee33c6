import assert from "node:assert"
import {test} from "node:test"
import {rotated, spanned} from "../../../../app/frontend/common/vectors.js"

const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0)
const near = (a, b) =>
  assert.ok(a.every((x, i) => Math.abs(x - b[i]) < 1e-12), `${a} is not ${b}`)

test("a plane is spanned by two directions at right angles", () => {
  for (const normal of [[1, 0, 0], [0, 1, 0], [0, 0, -1], [0.36, 0.48, 0.8]]) {
    const [u, v] = spanned(normal)
    near([dot(u, u), dot(v, v), dot(u, v), dot(u, normal), dot(v, normal)], [1, 1, 0, 0, 0])
  }
})

test("a direction turns about an axis", () => {
  near(rotated([1, 0, 0], [0, 0, 1], Math.PI / 2), [0, 1, 0])
  near(rotated([0.36, 0.48, 0.8], [0.36, 0.48, 0.8], 1.3), [0.36, 0.48, 0.8])
})
