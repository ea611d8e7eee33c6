// Which bone lies under the pointer: the segment nearest on the screen, within reach.

import {transformed} from "../engine/skin.js"

export const REACH = 16
export const TOUCH = 6  // over the body, a bone must be met as well as it is drawn

export function pickBone(renderer, bones, pose, x, y, reach = REACH) {
  if (!bones) { return null }
  let best = null
  const project = renderer.projection(renderer.viewAt(x, y))
  for (const [i, joint] of bones.joint.entries()) {
    const [a, b] = boneEnds(project, bones, pose, i)
    if (!a || !b) { continue }
    const [distance, along] = toSegment(x, y, a, b)
    if (distance > reach) { continue }
    const depth = a[2] + along * (b[2] - a[2])
    // Near misses count less than depth only among bones that are hit about equally well.
    const score = distance + REACH * 0.25 * depth / renderer.camera.getDistance()
    if (!best || score < best.score) { best = {joint, score} }
  }
  return best && best.joint
}

export function boneEnds(project, bones, pose, i) {
  const at = (points) => transformed(points.slice(3 * i, 3 * i + 3), pose, bones.joint[i])
  return [project(at(bones.start)), project(at(bones.end))]
}

export function toSegment(x, y, a, b) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]]
  const length = dx * dx + dy * dy
  const along = length > 0 ? ((x - a[0]) * dx + (y - a[1]) * dy) / length : 0
  const t = Math.max(0, Math.min(1, along))
  return [Math.hypot(x - a[0] - t * dx, y - a[1] - t * dy), t]
}
