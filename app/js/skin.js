// Linear blend skinning in the browser: weights come once, then sixteen numbers a joint.

// Moves points and normals by `pose`, a Float32Array of row-major 4 by 4 matrices.
function skinInto(skin, rest, restNormals, pose, points, normals) {
  const {joints, weights, count} = skin
  const m = new Float32Array(12)
  for (let i = 0, n = rest.length / 3; i < n; i++) {
    m.fill(0)
    let held = 0
    for (let k = i * count; k < (i + 1) * count; k++) {
      const w = weights[k]
      if (w === 0) { continue }
      held += w
      const at = joints[k] * 16
      for (let c = 0; c < 12; c++) { m[c] += w * pose[at + c] }
    }
    const o = 3 * i
    const [x, y, z] = [rest[o], rest[o + 1], rest[o + 2]]
    if (held === 0) { m[0] = m[5] = m[10] = 1 }
    points[o] = m[0] * x + m[1] * y + m[2] * z + m[3]
    points[o + 1] = m[4] * x + m[5] * y + m[6] * z + m[7]
    points[o + 2] = m[8] * x + m[9] * y + m[10] * z + m[11]
    if (normals) {
      const [a, b, c] = [restNormals[o], restNormals[o + 1], restNormals[o + 2]]
      const u = m[0] * a + m[1] * b + m[2] * c
      const v = m[4] * a + m[5] * b + m[6] * c
      const w = m[8] * a + m[9] * b + m[10] * c
      const s = 1 / (Math.sqrt(u * u + v * v + w * w) || 1)
      normals[o] = u * s
      normals[o + 1] = v * s
      normals[o + 2] = w * s
    }
  }
}

function transformed(point, pose, joint) {
  if (!pose) { return point }
  const m = pose.subarray(joint * 16, joint * 16 + 12)
  const [x, y, z] = point
  return [0, 4, 8].map((r) => m[r] * x + m[r + 1] * y + m[r + 2] * z + m[r + 3])
}

// A motion that came as frames, read at any time.
class Clip {
  constructor({times, matrices}) {
    this.times = plain(times)
    this.matrices = plain(matrices)
    this.size = this.matrices.length / this.times.length
    this.pose = new Float32Array(this.size)
  }

  get duration() {
    return this.times[this.times.length - 1] || 1
  }

  at(time) {
    const {times, size, matrices, pose} = this
    const t = time % this.duration
    let next = times.findIndex((x) => x > t)
    if (next < 1) { next = next < 0 ? times.length - 1 : Math.min(1, times.length - 1) }
    const last = Math.max(next - 1, 0)
    const span = times[next] - times[last]
    const f = span > 0 ? (t - times[last]) / span : 0
    for (let i = 0; i < size; i++) {
      pose[i] = (1 - f) * matrices[last * size + i] + f * matrices[next * size + i]
    }
    return pose
  }
}
