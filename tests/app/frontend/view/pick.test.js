import assert from "node:assert/strict"
import {test} from "node:test"

import {pickBone, REACH, toSegment, TOUCH} from "../../../../app/frontend/view/pick.js"
import {hitLine, valueAt} from "../../../../app/frontend/view/surface.js"

// A renderer whose canvas has the scene's own x and y as pixels; what is behind z = 0 is not seen.
const renderer = {
  viewAt: () => 0,
  projection: () => ([x, y, z]) => z < 0 ? null : [x, y, z],
  camera: {getDistance: () => 10},
}
const bones = {
  joint: [4, 7, 9],
  start: [0, 0, 1, 0, 40, 1, 0, 3, -1], end: [100, 0, 1, 100, 40, 1, 100, 3, -1],
}

test("the distance to a segment, and how far along it that is", () => {
  assert.deepEqual(toSegment(5, 3, [0, 0], [10, 0]), [3, 0.5])
  assert.deepEqual(toSegment(-3, 4, [0, 0], [10, 0]), [5, 0])
  assert.deepEqual(toSegment(14, 3, [0, 0], [10, 0]), [5, 1])
  assert.deepEqual(toSegment(3, 4, [0, 0], [0, 0]), [5, 0])
})

test("the nearest bone is picked, within reach and before the eye", () => {
  assert.equal(pickBone(renderer, bones, null, 50, 3), 4)
  assert.equal(pickBone(renderer, bones, null, 50, 30), 7)
  assert.equal(pickBone(renderer, bones, null, 50, -REACH - 1), null)
  assert.equal(pickBone(renderer, bones, null, 50, TOUCH + 1, TOUCH), null)
  assert.equal(pickBone(renderer, null, null, 50, 0), null)
})

test("of bones in one place the one in front is picked", () => {
  const twice = {joint: [1, 2], start: [0, 0, 8, 0, 0, 2], end: [100, 0, 8, 100, 0, 2]}
  assert.equal(pickBone(renderer, twice, null, 50, 1), 2)
})

test("bones are picked where the pose has them", () => {
  const lifted = [1, 0, 0, 0, 0, 1, 0, 200, 0, 0, 1, 0, 0, 0, 0, 1]
  const pose = Float32Array.from([...Array(10)].flatMap(() => lifted))
  assert.equal(pickBone(renderer, bones, pose, 50, 0), null)
  assert.equal(pickBone(renderer, bones, pose, 50, 200), 4)
})

test("the nearest line is found", () => {
  const rays = {
    visible: true, kind: "lines", pairs: [0, 1, 2, 3], rest: [0, 0, 0, 9, 0, 0, 0, 5, 0, 9, 5, 0],
  }
  assert.equal(hitLine(renderer, rays, 4, 4, TOUCH), 1)
  assert.equal(hitLine(renderer, rays, 4, 40, TOUCH), null)
  assert.equal(hitLine(renderer, {...rays, visible: false}, 4, 4, TOUCH), null)
})

test("what is read under the pointer is a name, a number or a part", () => {
  const at = (reading, values) => valueAt({reading: {text: "it is ", ...reading}, values}, 1)
  assert.equal(at({unit: 2}, [0, 0.25]), "it is 0.5")
  assert.equal(at({unit: 1}, [0, 3]), "it is 3")
  assert.equal(at({names: ["arm", "leg"]}, [0, 1]), "it is leg")
  assert.equal(at({percent: true}, [0, 0.5]), "it is 50%")
  assert.equal(at({}, [0, NaN]), null)
})
