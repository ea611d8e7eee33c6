// A tree of boxes around triangles: what a ray meets first is found without a look at each of them.
//
// Triangles are sorted along a space-filling curve through the points at rest, and every LEAF of
// them share a box; node k of the tree holds nodes 2k and 2k + 1. When the points move the order
// stays, and the boxes are fitted again.

const LEAF = 8
const CELLS = 1024  // of the curve, along each axis
const MOST = 2 ** 23  // triangles that a number can tell apart beside their place on the curve
const SLACK = 1e-6  // boxes are larger by this part: triangles are met with rounding errors

export class TriangleTree {
  constructor(points, triangles) {
    this.triangles = triangles
    this.order = alongCurve(points, triangles)
    this.first = 1  // of the nodes that hold triangles
    while (this.first * LEAF < this.order.length) { this.first *= 2 }
    this.boxes = new Float32Array(12 * this.first)
  }

  // Where the points are now; nothing if that is the same array as before.
  fit(points) {
    if (points === this.points) { return }
    this.points = points
    const {boxes, first, order, triangles} = this
    let size = 0
    for (let node = 2 * first - 1; node >= first; node--) {
      const at = 6 * node
      boxes.fill(Infinity, at, at + 3)
      boxes.fill(-Infinity, at + 3, at + 6)
      const end = Math.min((node - first + 1) * LEAF, order.length)
      for (let i = (node - first) * LEAF; i < end; i++) {
        for (let c = 0; c < 3; c++) {
          const p = 3 * triangles[3 * order[i] + c]
          for (let k = 0; k < 3; k++) {
            const x = points[p + k]
            if (x < boxes[at + k]) { boxes[at + k] = x }
            if (x > boxes[at + 3 + k]) { boxes[at + 3 + k] = x }
          }
        }
      }
    }
    for (let node = first - 1; node >= 1; node--) {
      for (let k = 0; k < 6; k++) {
        const a = boxes[12 * node + k], b = boxes[12 * node + 6 + k]
        boxes[6 * node + k] = (k < 3) === (a < b) ? a : b
      }
    }
    for (let k = 0; k < 3; k++) { size = Math.max(size, boxes[9 + k] - boxes[6 + k]) }
    const slack = SLACK * size
    for (let i = 6; i < boxes.length; i++) { boxes[i] += i % 6 < 3 ? -slack : slack }
  }

  // What a ray meets first of that which is kept: how far that is, where, and the nearest corner.
  /** @param {Vector} origin @param {Vector} direction @param {(at: Vector) => boolean} [keeps] */
  firstHit(origin, direction, keeps = () => true) {
    const {boxes, first, order, triangles, points} = this
    const inverse = direction.map((x) => 1 / x)
    const stack = [1]
    let best = null
    for (let node = stack.pop(); node !== undefined; node = stack.pop()) {
      if (enters(boxes, 6 * node, origin, inverse) > (best?.far ?? Infinity)) { continue }
      if (node < first) {
        const near = [2 * node, 2 * node + 1].map((k) => enters(boxes, 6 * k, origin, inverse))
        const [sooner, later] = near[0] <= near[1] ? [0, 1] : [1, 0]
        if (near[later] < Infinity) { stack.push(2 * node + later) }
        if (near[sooner] < Infinity) { stack.push(2 * node + sooner) }
        continue
      }
      const end = Math.min((node - first + 1) * LEAF, order.length)
      for (let i = (node - first) * LEAF; i < end; i++) {
        const hit = meet(points, triangles, order[i], origin, direction)
        if (!hit || (best && !isBefore(hit.far, order[i], best))) { continue }
        const at = origin.map((x, k) => x + hit.far * direction[k])
        if (keeps(at)) { best = {far: hit.far, at, point: hit.corner, triangle: order[i]} }
      }
    }
    return best
  }
}

// Of those that are equally far, the first of the file's comes first.
function isBefore(far, triangle, best) {
  return far < best.far || (far === best.far && triangle < best.triangle)
}

// How far along a ray a box begins; infinitely far if it is missed or empty.
function enters(boxes, at, origin, inverse) {
  let [enter, leave] = [0, Infinity]
  for (let k = 0; k < 3; k++) {
    if (boxes[at + k] > boxes[at + 3 + k]) { return Infinity }
    const a = (boxes[at + k] - origin[k]) * inverse[k]
    const b = (boxes[at + 3 + k] - origin[k]) * inverse[k]
    // A ray within the plane of a side (0 times infinity) is not parted from the box by it.
    if (Number.isNaN(a) || Number.isNaN(b)) { continue }
    enter = Math.max(enter, Math.min(a, b))
    leave = Math.min(leave, Math.max(a, b))
  }
  return enter <= leave ? enter : Infinity
}

// Where a ray meets a triangle, if it does, and the corner that is nearest there.
export function meet(p, triangles, triangle, origin, direction) {
  const [ox, oy, oz] = origin
  const [dx, dy, dz] = direction
  const i = 3 * triangle
  const a = 3 * triangles[i], b = 3 * triangles[i + 1], c = 3 * triangles[i + 2]
  const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2]
  const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2]
  const qx = dy * vz - dz * vy, qy = dz * vx - dx * vz, qz = dx * vy - dy * vx
  const det = ux * qx + uy * qy + uz * qz
  if (det === 0) { return null }
  const sx = ox - p[a], sy = oy - p[a + 1], sz = oz - p[a + 2]
  const g = (sx * qx + sy * qy + sz * qz) / det
  if (g < 0 || g > 1) { return null }
  const rx = sy * uz - sz * uy, ry = sz * ux - sx * uz, rz = sx * uy - sy * ux
  const h = (dx * rx + dy * ry + dz * rz) / det
  if (h < 0 || g + h > 1) { return null }
  const far = (vx * rx + vy * ry + vz * rz) / det
  if (far <= 0) { return null }
  const share = [1 - g - h, g, h]
  return {far, corner: triangles[i + share.indexOf(Math.max(...share))]}
}

// The triangles in the order in which a Z-order curve passes their middles.
function alongCurve(points, triangles) {
  const count = triangles.length / 3
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]]
  for (let i = 0; i < points.length; i++) {
    low[i % 3] = Math.min(low[i % 3], points[i])
    high[i % 3] = Math.max(high[i % 3], points[i])
  }
  const scale = low.map((x, k) => (CELLS - 1) / Math.max(high[k] - x, 1e-30))
  const keys = new Float64Array(count)
  for (let i = 0; i < count; i++) {
    const a = 3 * triangles[3 * i], b = 3 * triangles[3 * i + 1], c = 3 * triangles[3 * i + 2]
    let code = 0
    for (let k = 0; k < 3; k++) {
      const middle = (points[a + k] + points[b + k] + points[c + k]) / 3
      code |= spread((middle - low[k]) * scale[k]) << k
    }
    keys[i] = code * MOST + i
  }
  return Uint32Array.from(keys.sort(), (key) => key % MOST)
}

// Ten bits, two places apart.
function spread(x) {
  x = (x | (x << 16)) & 0x030000ff
  x = (x | (x << 8)) & 0x0300f00f
  x = (x | (x << 4)) & 0x030c30c3
  return (x | (x << 2)) & 0x09249249
}
