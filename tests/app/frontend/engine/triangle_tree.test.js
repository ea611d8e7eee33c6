import assert from "node:assert/strict"
import {test} from "node:test"

import {meet, TriangleTree} from "../../../../app/frontend/engine/triangle_tree.js"
import {bumpy, random, rays} from "./shapes.js"

// What the tree must find, by a look at every triangle.
function bruteForce(points, triangles, origin, direction, keeps = () => true) {
  let best = null
  for (let i = 0; i < triangles.length / 3; i++) {
    const hit = meet(points, triangles, i, origin, direction)
    if (!hit || (best && hit.far >= best.far)) { continue }
    const at = origin.map((x, k) => x + hit.far * direction[k])
    if (keeps(at)) { best = {far: hit.far, at, point: hit.corner, triangle: i} }
  }
  return best
}

function compare(points, triangles, tree, keeps) {
  let hits = 0
  for (const [origin, direction] of rays(400)) {
    const expected = bruteForce(points, triangles, origin, direction, keeps)
    assert.deepEqual(tree.firstHit(origin, direction, keeps), expected)
    hits += expected !== null
  }
  assert.ok(hits > 100, `only ${hits} rays meet anything`)
}

test("a ray meets what it meets first of all triangles", () => {
  const {points, triangles} = bumpy(60)
  const tree = new TriangleTree(points, triangles)
  tree.fit(points)
  compare(points, triangles, tree)
})

test("what a cut hides is not met", () => {
  const {points, triangles} = bumpy(40)
  const tree = new TriangleTree(points, triangles)
  tree.fit(points)
  compare(points, triangles, tree, ([x]) => x < 0.1)
})

test("the boxes follow points that move", () => {
  const {points, triangles} = bumpy(40)
  const tree = new TriangleTree(points, triangles)
  tree.fit(points)
  const bent = points.map((x, i) => i % 3 === 0 ? x + points[i + 1] ** 2 : x)
  tree.fit(bent)
  compare(bent, triangles, tree)
  tree.fit(points)
  compare(points, triangles, tree)
})

test("triangles that lie in one plane, twice, or in a point are met as before", () => {
  const next = random(3)
  const points = Float32Array.from({length: 900}, (_, i) => i % 3 === 2 ? 0 : 2 * next() - 1)
  const once = Uint32Array.from({length: 300}, () => Math.floor(300 * next()))
  const triangles = Uint32Array.from([...once, ...once, 5, 5, 5])
  const tree = new TriangleTree(points, triangles)
  tree.fit(points)
  compare(points, triangles, tree)
  // Along an axis, where a division by zero tells where boxes end.
  for (const origin of [[0, 0, 3], [points[0], points[1], 3], [-3, 0, 0]]) {
    for (const direction of [[0, 0, -1], [1, 0, 0]]) {
      const expected = bruteForce(points, triangles, origin, direction)
      assert.deepEqual(tree.firstHit(origin, direction), expected)
    }
  }
})

test("no triangle and one triangle are no trouble", () => {
  const points = Float32Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0])
  const none = new TriangleTree(points, new Uint32Array(0))
  none.fit(points)
  assert.equal(none.firstHit([0.2, 0.2, 1], [0, 0, -1]), null)
  const one = new TriangleTree(points, Uint32Array.from([0, 1, 2]))
  one.fit(points)
  const {far, point} = one.firstHit([0.2, 0.7, 1], [0, 0, -1])
  assert.equal(far, 1)
  assert.equal(point, 2)
})
