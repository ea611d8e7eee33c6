// Dual quaternion skinning (Kavan et al. 2008), as in cutcell/pose/dual_quaternions.py: on the
// graphics card, and on the processor. Quaternions are (x, y, z, w).

import {cross, dot} from "../common/vectors.js"

const FLAT = 1e-6  // a determinant, relative to the cube of the norm: no rotation is near
const TIE = 1e-4  // rounding must not choose a sign
const STEPS = 40
const CLOSE = 1e-12

// A pose with the quaternion of each matrix's rotation as its last row, (0, 0, 0, 1) at rest.
export function withQuaternions(pose) {
  const made = pose.slice()
  for (let at = 0; at < pose.length; at += 16) { made.set(quaternion(pose, at), at + 12) }
  return made
}

function quaternion(pose, at) {
  const r = nearestRotation([0, 4, 8].map((row) => [...pose.subarray(at + row, at + row + 3)]))
  if (!r) { return [0, 0, 0, 1] }
  const q = [0, 0, 0, 0]
  const trace = r[0][0] + r[1][1] + r[2][2]
  const diagonal = [r[0][0], r[1][1], r[2][2], trace]
  const i = diagonal.indexOf(Math.max(...diagonal))
  if (i === 3) {
    q.splice(0, 4, r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1], 1 + trace)
  } else {
    const [j, k] = [(i + 1) % 3, (i + 2) % 3]
    q[i] = 1 + r[i][i] - r[j][j] - r[k][k]
    q[j] = r[j][i] + r[i][j]
    q[k] = r[k][i] + r[i][k]
    q[3] = r[k][j] - r[j][k]
  }
  const [x, y, z, w] = q
  const length = Math.hypot(...q) * Math.sign([w, x, y, z].find((c) =>
    Math.abs(c) > TIE * Math.hypot(...q)) ?? 1)
  return q.map((c) => c / length)
}

// Of the rows of a matrix; null where it mirrors or flattens. Newton's iteration of Higham.
function nearestRotation(rows) {
  const norm = Math.hypot(...rows.flat())
  for (let step = 0; step < STEPS; step++) {
    const [a, b, c] = rows
    const cofactors = [cross(b, c), cross(c, a), cross(a, b)]
    const det = dot(a, cofactors[0])
    if (step === 0 && !(det > FLAT * norm ** 3)) { return null }
    const size = Math.cbrt(det)
    const next = rows.map((row, i) => row.map((x, j) =>
      (x / size + cofactors[i][j] * size / det) / 2))
    const change = next.flatMap((row, i) => row.map((x, j) => Math.abs(x - rows[i][j])))
    rows = next
    if (Math.max(...change) < CLOSE) { break }
  }
  return rows
}

// Where a skin moves all points, in a pose with quaternions.
export function dualSkinned({joints, weights, count}, rest, pose) {
  const out = rest.slice()
  const sums = new Float64Array(8)
  for (let i = 0, n = rest.length / 3; i < n; i++) {
    sums.fill(0)
    const point = rest.subarray(3 * i, 3 * i + 3)
    let first = -1
    for (let k = i * count; k < (i + 1) * count; k++) {
      if (weights[k] === 0) { continue }
      const at = 16 * joints[k]
      if (first < 0) { first = at }
      add(sums, point, pose, at, first, weights[k])
    }
    if (first >= 0) { place(out, 3 * i, sums) }
  }
  return out
}

// Adds a joint to a sum of dual quaternions; the second half of each is doubled.
function add(sums, [px, py, pz], m, at, first, weight) {
  const [x, y, z, w] = [m[at + 12], m[at + 13], m[at + 14], m[at + 15]]
  const along = x * m[first + 12] + y * m[first + 13] + z * m[first + 14] + w * m[first + 15]
  const s = along < -TIE ? -weight : weight
  const cx = y * pz - z * py + w * px
  const cy = z * px - x * pz + w * py
  const cz = x * py - y * px + w * pz
  // How far the joint moves the point beyond turning it about the origin.
  const tx = m[at] * px + m[at + 1] * py + m[at + 2] * pz + m[at + 3]
    - px - 2 * (y * cz - z * cy)
  const ty = m[at + 4] * px + m[at + 5] * py + m[at + 6] * pz + m[at + 7]
    - py - 2 * (z * cx - x * cz)
  const tz = m[at + 8] * px + m[at + 9] * py + m[at + 10] * pz + m[at + 11]
    - pz - 2 * (x * cy - y * cx)
  sums[0] += s * x
  sums[1] += s * y
  sums[2] += s * z
  sums[3] += s * w
  sums[4] += s * (w * tx + ty * z - tz * y)
  sums[5] += s * (w * ty + tz * x - tx * z)
  sums[6] += s * (w * tz + tx * y - ty * x)
  sums[7] -= s * (tx * x + ty * y + tz * z)
}

/** Moves a point by a sum of dual quaternions. @param {number} at @param {Iterable<number>} sum */
function place(points, at, sum) {
  const [x, y, z, w, dx, dy, dz, dw] = sum
  const [px, py, pz] = [points[at], points[at + 1], points[at + 2]]
  const f = 1 / (x * x + y * y + z * z + w * w)
  const cx = y * pz - z * py + w * px
  const cy = z * px - x * pz + w * py
  const cz = x * py - y * px + w * pz
  points[at] = px + f * (2 * (y * cz - z * cy) + w * dx - dw * x + y * dz - z * dy)
  points[at + 1] = py + f * (2 * (z * cx - x * cz) + w * dy - dw * y + z * dx - x * dz)
  points[at + 2] = pz + f * (2 * (x * cy - y * cx) + w * dz - dw * z + x * dy - y * dx)
}

// The same for the vertex shader: `addDual` adds a joint, `dualRows` turns the sum into a matrix.
export const DUAL_SHADER = `
  vec3 turnedBy(vec4 q, vec3 point) {
    return point + 2.0 * cross(q.xyz, cross(q.xyz, point) + q.w * point);
  }
  void addDual(float joint, float w, vec4 point, inout vec4 first, inout vec4 real,
               inout vec4 dual, inout float held) {
    if (w == 0.0) { return; }
    int row = int(joint + 0.5);
    vec4 q = texelFetch(poses, ivec2(3, row), 0);
    if (held == 0.0) { first = q; }
    float s = dot(q, first) < ${-TIE} ? -w : w;
    vec3 target = vec3(dot(texelFetch(poses, ivec2(0, row), 0), point),
      dot(texelFetch(poses, ivec2(1, row), 0), point),
      dot(texelFetch(poses, ivec2(2, row), 0), point));
    vec3 shift = target - turnedBy(q, point.xyz);
    real += s * q;
    dual += s * vec4(q.w * shift + cross(shift, q.xyz), -dot(shift, q.xyz));
    held += w;
  }
  void dualRows(vec4 real, vec4 dual, out vec4 a, out vec4 b, out vec4 c) {
    vec4 q = real / length(real);
    vec4 d = dual / length(real);
    vec3 move = q.w * d.xyz - d.w * q.xyz + cross(q.xyz, d.xyz);
    vec3 x = turnedBy(q, vec3(1, 0, 0));
    vec3 y = turnedBy(q, vec3(0, 1, 0));
    vec3 z = turnedBy(q, vec3(0, 0, 1));
    a = vec4(x.x, y.x, z.x, move.x);
    b = vec4(x.y, y.y, z.y, move.y);
    c = vec4(x.z, y.z, z.z, move.z);
  }`
