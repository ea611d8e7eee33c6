import assert from "node:assert/strict"
import {test} from "node:test"

import {withQuaternions} from "../../../../app/frontend/engine/dual_quaternions.js"
import {skinned, skinVertex} from "../../../../app/frontend/engine/skin.js"
import {cross, rotated, unit} from "../../../../app/frontend/common/vectors.js"

const X = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]

// A turn about an axis through the origin, then a move, of what a scale has stretched.
function matrix(axis, degrees, move = [0, 0, 0], scale = [1, 1, 1]) {
  const columns = X.map((x, i) => rotated(x, unit(axis), degrees / 180 * Math.PI)
    .map((c) => c * scale[i]))
  return [...[0, 1, 2].flatMap((r) => [...columns.map((c) => c[r]), move[r]]), 0, 0, 0, 1]
}
const near = (found, expected, told) => [...found].forEach((x, i) =>
  assert.ok(Math.abs(x - expected[i]) < 1e-5, `${told}: ${[...found]}, not ${expected}`))
const dual = (skin, rest, pose) => skinned(skin, rest, withQuaternions(pose), true)

test("the last row of a pose holds the quaternion of the nearest rotation", () => {
  for (const axis of [...X, [1, 2, 3], [-3, 1, 1]]) {
    for (const degrees of [0, 30, 90, 179, 180, 200]) {
      for (const scale of [[1, 1, 1], [2, 2, 2], [0.1, 0.1, 0.1]]) {
        const pose = Float32Array.from(matrix(axis, degrees, [4, 5, 6], scale))
        const [x, y, z, w] = withQuaternions(pose).slice(12)
        assert.ok(w > -1e-4)
        for (const [i, row] of X.entries()) {
          const c = cross([x, y, z], row).map((value, k) => value + w * row[k])
          const turned = cross([x, y, z], c).map((value, k) => row[k] + 2 * value)
          near(turned, rotated(row, unit(axis), degrees / 180 * Math.PI), `${axis} ${degrees} ${i}`)
        }
      }
    }
  }
})

test("of what mirrors, flattens or is nowhere, no rotation is taken", () => {
  for (const scale of [[-1, 1, 1], [1, 0, 1], [0, 0, 0]]) {
    const pose = Float32Array.from(matrix([1, 2, 3], 40, [0, 0, 0], scale))
    assert.deepEqual(withQuaternions(pose).slice(12), Float32Array.of(0, 0, 0, 1))
  }
})

test("one joint moves a point by its matrix, and no joint leaves it", () => {
  const rest = Float32Array.from([1, 2, 3, 1, 2, 3, 1, 2, 3])
  const pose = Float32Array.from([
    ...matrix([1, 1, 0], 70, [1, 2, 3], [1, 2, 0.5]),
    ...matrix([1, 0, 0], 0, [0, 0, 1], [-1, 1, 1]),
  ])
  const skin = {joints: [0, 1, 0], weights: [1, 1, 0], count: 1}
  near(dual(skin, rest, pose), skinned(skin, rest, pose), "as its matrix")
})

test("a half turn keeps the distance from the axis, where linear blending loses it", () => {
  const rest = Float32Array.from([1, 0, 5])
  const skin = {joints: [0, 1], weights: [0.5, 0.5], count: 2}
  const pose = Float32Array.from([...matrix([0, 0, 1], 0), ...matrix([0, 0, 1], 180)])
  near(skinned(skin, rest, pose), [0, 0, 5], "linear")
  near(dual(skin, rest, pose), [0, 1, 5], "dual quaternions")
})

test("scale without rotation is blended linearly", () => {
  const rest = Float32Array.from([1, 2, 3])
  const skin = {joints: [0, 1], weights: [0.7, 0.3], count: 2}
  const pose = Float32Array.from([...matrix(X[0], 0, [1, 0, 0], [2, 3, 4]), ...matrix(X[0], 0)])
  near(dual(skin, rest, pose), skinned(skin, rest, pose), "scaled")
})

test("the shader adds every influence in both ways", () => {
  const {declared} = skinVertex(2, 1)
  for (const add of ["addPose", "addDual"]) {
    assert.equal(declared.split(`${add}(skinJoints`).length - 1, 8)
    assert.equal(declared.split(`${add}(otherJoints`).length - 1, 4)
  }
})
