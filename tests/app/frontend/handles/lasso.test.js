import assert from "node:assert/strict"
import {test} from "node:test"

import {inside} from "../../../../app/frontend/handles/lasso.js"

const flat = ([x, y, z]) => [x, y, z]
const square = [[0, 0], [10, 0], [10, 10], [0, 10]]

test("the points inside a line are those, also of one that is not convex", () => {
  const points = Float32Array.from([5, 5, 1, 15, 5, 1, 1, 9, 1, -1, 5, 1])
  assert.deepEqual(inside(square, points, flat, null), [0, 2])
  const arrow = [[0, 0], [10, 5], [0, 10], [4, 5]]
  const few = Float32Array.from([2, 5, 1, 6, 5, 1, 1, 1, 1])
  assert.deepEqual(inside(arrow, few, flat, null), [1, 2])
})

test("points behind the eye are in no line", () => {
  const points = Float32Array.from([5, 5, 1, 5, 5, -1])
  const project = ([x, y, z]) => z > 0 ? [x, y, z] : null
  assert.deepEqual(inside(square, points, project, Uint32Array.from([0, 1, 0])), [0])
})

test("points that a triangle hides are left out, those of its own and beside it are not", () => {
  const points = Float32Array.from([
    2, 2, 1, 8, 2, 1, 2, 8, 1,  // a triangle
    3, 3, 2,  // behind it
    8, 8, 2,  // beside it
    3, 3, 0.5,  // before it
  ])
  const triangles = Uint32Array.from([0, 1, 2])
  assert.deepEqual(inside(square, points, flat, triangles), [0, 1, 2, 4, 5])
  assert.deepEqual(inside(square, points, flat, null), [0, 1, 2, 3, 4, 5])
})

test("no vertex of a steep surface hides another", () => {
  const side = 12
  const points = new Float32Array(3 * (side + 1) ** 2)
  const triangles = []
  for (let i = 0; i <= side; i++) {
    for (let j = 0; j <= side; j++) {
      const at = i * (side + 1) + j
      points.set([10 * i / side, 10 * j / side, 5 + 20 * i / side], 3 * at)
      if (i < side && j < side) {
        triangles.push(at, at + 1, at + side + 1, at + 1, at + side + 2, at + side + 1)
      }
    }
  }
  const around = [[-1, -1], [11, -1], [11, 11], [-1, 11]]
  const all = inside(around, points, flat, Uint32Array.from(triangles))
  assert.equal(all.length, (side + 1) ** 2)
})
